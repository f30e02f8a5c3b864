#include "openclose/scene/key_depth.h"

#include <algorithm>
#include <cctype>

namespace openclose {
namespace {

/// Goes through the tokens of TOML that matter to keys. What it does not understand ends a key, and the parser refuses it later.
class KeyDepths {
 public:
  explicit KeyDepths(std::string_view text) : text_(text) {}

  std::optional<int> first_beyond(int most) {
    while (at_ < text_.size()) {
      step();
      if (parts_ > most) return line_;
    }
    return std::nullopt;
  }

 private:
  enum class Last { part, dot, other };

  void step() {
    const char c = text_[at_];
    if (c == '"' || c == '\'') {
      skip_string(c);
      add_part();
    } else if (is_bare(c)) {
      while (at_ < text_.size() && is_bare(text_[at_])) ++at_;
      add_part();
    } else {
      if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size() - 1);
      if (c == '.' && last_ == Last::part) {
        last_ = Last::dot;
      } else if (c != ' ' && c != '\t') {
        end_key();
      }
      if (text_[at_] == '\n') ++line_;
      ++at_;
    }
  }

  static bool is_bare(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return std::isalnum(byte) != 0 || c == '_' || c == '-' || byte >= 0x80;
  }

  void add_part() {
    parts_ = last_ == Last::dot ? parts_ + 1 : 1;
    last_ = Last::part;
  }

  void end_key() {
    parts_ = 0;
    last_ = Last::other;
  }

  /// Texts within double quotes have escapes; those within three quotes may have several lines.
  void skip_string(char quote) {
    const std::string_view rest = text_.substr(at_);
    const std::size_t length = rest.size() >= 3 && rest[1] == quote && rest[2] == quote ? 3 : 1;
    const std::string_view end = rest.substr(0, length);
    at_ += length;
    while (at_ < text_.size() && text_.substr(at_, length) != end) {
      if (quote == '"' && text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      if (text_[at_] == '\n') {
        if (length == 1) return;  // it is not closed
        ++line_;
      }
      ++at_;
    }
    at_ = std::min(at_ + length, text_.size());
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1, parts_ = 0;
  Last last_ = Last::other;
};

}  // namespace

std::optional<int> line_of_deep_key(std::string_view text) {
  return KeyDepths(text).first_beyond(most_key_parts);
}

}  // namespace openclose
