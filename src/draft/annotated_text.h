// A scene file with a comment on every key. What a key does is taken from the tables of keys (scene/keys.h), so that comments are never out of date.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "openclose/geometry/polygon.h"
#include "openclose/scene/toml_text.h"

namespace openclose {

class AnnotatedText {
 public:
  /// Lines of the author's own, wrapped.
  void comment(const std::string& words);
  void blank_line() { text_ += '\n'; }
  /// [name] or [[name]] as the table of keys has it; the first of its name with what the table is for. \param words  what the author adds
  void table(const std::string& name, const std::string& words = {});
  /// A key of the present table; the first of its name in such tables with what it does.
  template <typename T>
  void key(const std::string& name, const T& value) {
    line(name, written(value), false);
  }
  void points(const std::string& name, const Polygon& points) { key(name, rounded(points)); }
  /// The same, as a comment: what may be put in.
  template <typename T>
  void left_out_key(const std::string& name, const T& value) {
    line(name, written(value), true);
  }
  void left_out_table(const std::string& name);

  const std::string& text() const { return text_; }

 private:
  void line(const std::string& name, const std::string& value, bool is_left_out);
  template <typename T>
  static std::string written(const T& value) {
    return toml(value);
  }
  /// 1e10, not 10000000000, where that is the same number.
  static std::string written(double number);
  /// To a nanometre, so that a line can be read.
  static Polygon rounded(Polygon points);

  std::string text_;
  std::string table_;
  std::set<std::string> explained_;
};

}  // namespace openclose
