// What the libraries of emscripten 3.1.6 lack, as far as the program uses it: of C++20 in libc++ 13, and of POSIX in programs of one thread.
// Included before every source by cmake/wasm.cmake.
#pragma once

#include <version>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000

#include <pthread.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iterator>
#include <ranges>
#include <string>
#include <type_traits>
#include <utility>

/// Declared there and never defined: without threads there is none whose time could be asked for.
extern "C" inline int pthread_getcpuclockid(pthread_t, clockid_t*) {
  return ENOSYS;
}

_LIBCPP_BEGIN_NAMESPACE_STD

namespace ranges {

template <class Test, class Part>
auto tests_part(Test& test, Part& part) {
  return [&](auto&& element) -> bool { return std::invoke(test, std::invoke(part, element)); };
}

template <class Compare, class Part>
auto compares_parts(Compare& compare, Part& part) {
  return [&](auto&& a, auto&& b) -> bool { return std::invoke(compare, std::invoke(part, a), std::invoke(part, b)); };
}

template <class Range, class Test, class Part = identity>
auto find_if(Range&& range, Test test, Part part = {}) {
  return std::find_if(std::begin(range), std::end(range), tests_part(test, part));
}

template <class Range, class Test, class Part = identity>
bool any_of(Range&& range, Test test, Part part = {}) {
  return std::any_of(std::begin(range), std::end(range), tests_part(test, part));
}

template <class Range, class Test, class Part = identity>
bool all_of(Range&& range, Test test, Part part = {}) {
  return std::all_of(std::begin(range), std::end(range), tests_part(test, part));
}

template <class Range, class Test, class Part = identity>
bool none_of(Range&& range, Test test, Part part = {}) {
  return std::none_of(std::begin(range), std::end(range), tests_part(test, part));
}

template <class Range, class Test, class Part = identity>
auto count_if(Range&& range, Test test, Part part = {}) {
  return std::count_if(std::begin(range), std::end(range), tests_part(test, part));
}

template <class Range, class Value, class Part = identity>
auto find(Range&& range, const Value& value, Part part = {}) {
  return ranges::find_if(
      range, [&](const auto& element) { return element == value; }, part);
}

template <class Range, class Value, class Part = identity>
auto count(Range&& range, const Value& value, Part part = {}) {
  return ranges::count_if(
      range, [&](const auto& element) { return element == value; }, part);
}

template <class Range, class Action>
void for_each(Range&& range, Action action) {
  std::for_each(std::begin(range), std::end(range), std::move(action));
}

template <class Range, class Output, class Action>
void transform(Range&& range, Output output, Action action) {
  std::transform(std::begin(range), std::end(range), output, std::move(action));
}

template <class Range>
auto reverse(Range&& range) {
  std::reverse(std::begin(range), std::end(range));
}

template <class Range, class Value>
auto fill(Range&& range, const Value& value) {
  std::fill(std::begin(range), std::end(range), value);
}

template <class Range, class Test = equal_to>
auto adjacent_find(Range&& range, Test test = {}) {
  return std::adjacent_find(std::begin(range), std::end(range), test);
}

template <class Range, class Compare = less, class Part = identity>
auto min_element(Range&& range, Compare compare = {}, Part part = {}) {
  return std::min_element(std::begin(range), std::end(range), compares_parts(compare, part));
}

template <class Range, class Compare = less, class Part = identity>
auto max_element(Range&& range, Compare compare = {}, Part part = {}) {
  return std::max_element(std::begin(range), std::end(range), compares_parts(compare, part));
}

template <class Range, class Compare = less, class Part = identity>
auto min(Range&& range, Compare compare = {}, Part part = {}) {
  return *ranges::min_element(range, compare, part);
}

template <class Range, class Compare = less, class Part = identity>
auto max(Range&& range, Compare compare = {}, Part part = {}) {
  return *ranges::max_element(range, compare, part);
}

template <class Range, class Value, class Compare = less, class Part = identity>
auto lower_bound(Range&& range, const Value& value, Compare compare = {}, Part part = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value,
                          [&](const auto& element, const Value& sought) -> bool { return std::invoke(compare, std::invoke(part, element), sought); });
}

template <class Range, class Value>
bool binary_search(Range&& range, const Value& value) {
  return std::binary_search(std::begin(range), std::end(range), value);
}

template <class Range>
bool is_sorted(Range&& range) {
  return std::is_sorted(std::begin(range), std::end(range));
}

template <class Range, class Value>
void replace(Range&& range, const Value& before, const Value& after) {
  std::replace(std::begin(range), std::end(range), before, after);
}

template <class Range, class Output, class Test>
void copy_if(Range&& range, Output output, Test test) {
  std::copy_if(std::begin(range), std::end(range), output, std::move(test));
}

template <class Range, class Compare = less, class Part = identity>
void sort(Range&& range, Compare compare = {}, Part part = {}) {
  std::sort(std::begin(range), std::end(range), compares_parts(compare, part));
}

template <class Range, class Compare = less, class Part = identity>
void stable_sort(Range&& range, Compare compare = {}, Part part = {}) {
  std::stable_sort(std::begin(range), std::end(range), compares_parts(compare, part));
}

template <class Range, class Place>
void nth_element(Range&& range, Place place) {
  std::nth_element(std::begin(range), place, std::end(range));
}

/// The whole numbers from `first` to the one before `last`.
class WholeNumbers {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = int;
    using difference_type = int;
    using pointer = const int*;
    using reference = int;

    Iterator() = default;
    explicit Iterator(int number) : number_(number) {}
    int operator*() const { return number_; }
    Iterator& operator++() {
      ++number_;
      return *this;
    }
    Iterator operator++(int) { return Iterator(number_++); }
    bool operator==(const Iterator&) const = default;

   private:
    int number_ = 0;
  };

  WholeNumbers(int first, int last) : first_(first), last_(last) {}
  Iterator begin() const { return Iterator(first_); }
  Iterator end() const { return Iterator(last_); }

 private:
  int first_, last_;
};

}  // namespace ranges

namespace views {

inline ranges::WholeNumbers iota(int first, int last) {
  return {first, last};
}

}  // namespace views

template <class To, class From>
To bit_cast(const From& from) {
  static_assert(sizeof(To) == sizeof(From) && is_trivially_copyable_v<From> && is_trivially_copyable_v<To>);
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}

/// As the standard has it: no space or plus in front, no hexadecimal digits.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const string text(first, std::find_if(first, last, [](char c) { return c == 'x' || c == 'X'; }));
  if (text.empty() || text[0] == '+' || std::isspace(static_cast<unsigned char>(text[0]))) return {first, errc::invalid_argument};
  char* end = nullptr;
  errno = 0;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* place = first + (end - text.c_str());
  if (errno == ERANGE) return {place, errc::result_out_of_range};
  value = number;
  return {place, errc()};
}

_LIBCPP_END_NAMESPACE_STD

#endif
