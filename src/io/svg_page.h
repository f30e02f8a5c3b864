// The page that a drawing is written on: figures, texts and paths in pixels, x to the right and y downwards.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "openclose/core/vector.h"
#include "openclose/geometry/polygon.h"

namespace openclose {

inline std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '&':
        result += "&amp;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// [px] A sans-serif text is about this wide, a little more than on average.
inline double width_of(const std::string& text, double size) {
  return 0.56 * size * static_cast<double>(text.size());
}

/// The data of one path of many pieces, in hundredths of a pixel and relative to the point before: that takes the fewest characters.
class PathData {
 public:
  void polygon(const Polygon& points) {
    move(points.front());
    for (std::size_t i = 1; i < points.size(); ++i) line(points[i]);
    data_ += 'z';
    at_x_ = start_x_, at_y_ = start_y_;
  }
  void segment(const Vec2& from, const Vec2& to) {
    move(from);
    line(to);
  }
  /// With round ends a line of no length is a dot.
  void dot(const Vec2& point) {
    move(point);
    data_ += "h0";
  }
  bool empty() const { return data_.empty(); }
  const std::string& data() const { return data_; }

 private:
  static long hundredths(double pixels) { return std::lround(100.0 * pixels); }
  void step(char command, const Vec2& point) {
    const long x = hundredths(point.x()), y = hundredths(point.y());
    fmt::format_to(std::back_inserter(data_), "{}{} {}", command, x - at_x_, y - at_y_);
    at_x_ = x, at_y_ = y;
  }
  void move(const Vec2& point) {
    step('m', point);
    start_x_ = at_x_, start_y_ = at_y_;
  }
  void line(const Vec2& point) { step('l', point); }

  std::string data_;
  long at_x_ = 0, at_y_ = 0, start_x_ = 0, start_y_ = 0;
};

class SvgPage {
 public:
  template <typename... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  void write(double x, double y, const std::string& text, double size = 14.0, const char* attributes = "") {
    if (!text.empty()) print("<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:g}\"{}>{}</text>\n", x, y, size, attributes, escaped(text));
  }
  void line(const Vec2& from, const Vec2& to, const std::string& attributes) {
    print("<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" {}/>\n", from.x(), from.y(), to.x(), to.y(), attributes);
  }
  /// \param width  [px] of its lines; the path is scaled, so that its lines have to be wider
  void path(const PathData& data, const std::string& attributes, double width) {
    if (data.empty()) return;
    print("<path transform=\"scale(.01)\" {} stroke-width=\"{:.4g}\" d=\"{}\"/>\n", attributes, 100.0 * width, data.data());
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace openclose
