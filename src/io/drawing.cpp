#include "openclose/io/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "openclose/geometry/box.h"

namespace openclose {
namespace {

/// [px] of the longer side of the drawing, and around it.
constexpr double longer_side = 1200.0;
constexpr double margin = 30.0;
constexpr double scale_room = 50.0;

constexpr std::array fills = {"#e8dcc3", "#c9d8c5", "#c7d3e3", "#e3c9c5", "#d9cde3", "#e0e0d0"};

std::string escaped(const std::string& text) {
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

/// 1, 2 or 5 times a power of ten, not above the value.
double round_length(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= value) return digit * power;
  }
  return power;
}

class Drawing {
 public:
  explicit Drawing(const Scene& scene) {
    box_ = Box::around(scene.blocks.front().vertices);
    for (const BlockInput& block : scene.blocks) {
      const Box other = Box::around(block.vertices);
      box_ = {box_.low.cwiseMin(other.low), box_.high.cwiseMax(other.high)};
    }
    const Vec2 size = box_.high - box_.low;
    scale_ = (longer_side - 2.0 * margin) / size.maxCoeff();
    const Vec2 page = scale_ * size + Vec2(2.0 * margin, 2.0 * margin + scale_room);
    print("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\">\n", page.x(), page.y());
    print(
        "<defs><pattern id=\"fixed\" width=\"8\" height=\"8\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">"
        "<line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"8\" stroke=\"#555\" stroke-width=\"1.2\"/></pattern></defs>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
  }

  void add(const BlockInput& block) {
    std::string points;
    for (const Vec2& vertex : block.vertices) {
      fmt::format_to(std::back_inserter(points), "{:.2f},{:.2f} ", margin + scale_ * (vertex.x() - box_.low.x()),
                     margin + scale_ * (box_.high.y() - vertex.y()));
    }
    points.pop_back();
    const char* fill = fills[block.material % fills.size()];
    print("<polygon points=\"{}\" fill=\"{}\" stroke=\"#333\" stroke-width=\"0.6\"{}><title>{}</title></polygon>\n", points,
          block.fixed ? "#b5b0a6" : fill, " stroke-linejoin=\"round\"", escaped(block.name));
    if (block.fixed) print("<polygon points=\"{}\" fill=\"url(#fixed)\" pointer-events=\"none\"/>\n", points);
  }

  std::string finish() {
    const double length = round_length(0.25 * (box_.high.x() - box_.low.x()));
    const double y = margin + scale_ * (box_.high.y() - box_.low.y()) + 0.5 * scale_room;
    print("<path d=\"M{0:.2f},{2:.2f} v8 H{1:.2f} v-8\" fill=\"none\" stroke=\"black\"/>\n", margin, margin + scale_ * length, y);
    print("<text x=\"{:.2f}\" y=\"{:.2f}\" font-family=\"sans-serif\" font-size=\"14\">{:g} m</text>\n", margin + scale_ * length + 8.0, y + 9.0,
          length);
    text_ += "</svg>\n";
    return std::move(text_);
  }

 private:
  template <typename... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  Box box_;
  double scale_ = 1.0;  ///< [px/m]
  std::string text_;
};

}  // namespace

std::string svg_drawing(const Scene& scene) {
  Drawing drawing(scene);
  for (const BlockInput& block : scene.blocks) drawing.add(block);
  return drawing.finish();
}

}  // namespace openclose
