// State to bytes and back, bit for bit. One function serves both directions, so that what is written and what is read cannot differ:
//
//   void exchange(Archive& archive) { archive(first_, second_); }
//
// A struct whose members are all public binds each of them by name there (auto& [a, b] = *this): a member that is added later then does not compile
// until it is in the archive too. One that has numbers of one type only may say which instead, and goes in as it is:
//
//   using Numbers = double;
//
// The bytes are those of this processor; io/checkpoint.h makes a file of them that says so.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace openclose {

/// What is read cannot be a state that was written.
class DamagedState : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Archive {
 public:
  /// Collects what it is given.
  Archive() = default;
  /// Gives back what another one has collected. Throws DamagedState, then or while it is read, if there is less than is asked for.
  explicit Archive(std::string bytes) : reading_(true), bytes_(std::move(bytes)) {}

  bool reading() const { return reading_; }
  const std::string& bytes() const { return bytes_; }
  /// The same, which this archive then no longer has.
  std::string take() { return std::move(bytes_); }
  /// Throws DamagedState for something that no state has which was written; what is read may be anything.
  void require(bool sound, const char* what) const {
    if (reading_ && !sound) throw DamagedState(what);
  }
  bool at_end() const { return at_ == bytes_.size(); }

  template <class... T>
  void operator()(T&... values) {
    (exchange(values), ...);
  }

 private:
  /// Whether its bytes say all.
  template <class T>
  static constexpr bool is_plain() {
    if constexpr (requires { typename T::Numbers; }) {
      static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(typename T::Numbers) == 0);
      return true;
    } else {
      return std::is_arithmetic_v<T> || std::is_enum_v<T>;
    }
  }

  void raw(void* data, std::size_t size) {
    if (size == 0) return;  // what is empty may have no address
    if (!reading_) {
      bytes_.append(static_cast<const char*>(data), size);
      return;
    }
    if (size > bytes_.size() - at_) throw DamagedState("the saved state is shorter than what it should hold");
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  /// Number of elements; each takes a byte at least, so that a wrong one cannot ask for more memory than there is.
  std::size_t length(std::size_t of_written) {
    std::uint64_t n = of_written;
    raw(&n, sizeof n);
    if (reading_ && n > bytes_.size() - at_) throw DamagedState("the saved state is shorter than what it should hold");
    return static_cast<std::size_t>(n);
  }

  template <class T>
  void exchange(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      unsigned char byte = value ? 1 : 0;  // others are no bool, and reading one as such is undefined
      raw(&byte, sizeof byte);
      require(byte <= 1, "the saved state has a switch that is neither on nor off");
      value = byte == 1;
    } else if constexpr (is_plain<T>()) {
      raw(&value, sizeof value);
    } else if constexpr (requires {
                           typename T::Scalar;
                           value.derived();
                         }) {  // matrices and vectors of Eigen
      if constexpr (T::SizeAtCompileTime < 0) value.resize(static_cast<Eigen::Index>(length(value.size())));
      raw(value.data(), sizeof(typename T::Scalar) * value.size());
    } else {
      value.exchange(*this);
    }
  }

  void exchange(std::string& text) {
    text.resize(length(text.size()));
    raw(text.data(), text.size());
  }

  template <class T, class A>
  void exchange(std::vector<T, A>& list) {
    list.resize(length(list.size()));
    if constexpr (is_plain<T>()) {
      raw(list.data(), sizeof(T) * list.size());
    } else {
      for (T& value : list) exchange(value);
    }
  }

  template <class A, class B>
  void exchange(std::pair<A, B>& pair) {
    exchange(pair.first);
    exchange(pair.second);
  }

  template <class T>
  void exchange(std::optional<T>& value) {
    bool there = value.has_value();
    exchange(there);
    if (reading_) value = there ? std::optional<T>(T()) : std::nullopt;
    if (there) exchange(*value);
  }

  bool reading_ = false;
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace openclose
