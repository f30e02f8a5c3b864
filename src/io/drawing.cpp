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
constexpr double title_room = 30.0;
constexpr double line_height = 22.0;

constexpr std::array fills = {"#e8dcc3", "#c9d8c5", "#c7d3e3", "#e3c9c5", "#d9cde3", "#e0e0d0"};
constexpr const char* fixed_fill = "#a5a096";

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
    top_ = margin + title_room;
    const double legend = line_height * static_cast<double>(scene.materials.size() + 1);
    const Vec2 page = scale_ * size + Vec2(2.0 * margin, top_ + scale_room + legend + margin);
    print("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\">\n", page.x(), page.y());
    print(
        "<defs><pattern id=\"fixed\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\">"
        "<circle cx=\"3.5\" cy=\"3.5\" r=\"1.1\" fill=\"#444\"/></pattern></defs>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
    write(margin, margin + 0.4 * title_room, fmt::format("{} ({} blocks)", scene.title.empty() ? "Blocks" : scene.title, scene.blocks.size()));
  }

  void add(const BlockInput& block) {
    std::string points;
    for (const Vec2& vertex : block.vertices) {
      fmt::format_to(std::back_inserter(points), "{:.2f},{:.2f} ", margin + scale_ * (vertex.x() - box_.low.x()),
                     top_ + scale_ * (box_.high.y() - vertex.y()));
    }
    points.pop_back();
    const char* fill = fills[block.material % fills.size()];
    print("<polygon points=\"{}\" fill=\"{}\" stroke=\"#333\" stroke-width=\"0.6\"{}><title>{}</title></polygon>\n", points,
          block.fixed ? fixed_fill : fill, " stroke-linejoin=\"round\"", escaped(block.name));
    if (block.fixed) print("<polygon points=\"{}\" fill=\"url(#fixed)\" pointer-events=\"none\"/>\n", points);
  }

  std::string finish(const Scene& scene) {
    const double length = round_length(0.25 * (box_.high.x() - box_.low.x()));
    double y = top_ + scale_ * (box_.high.y() - box_.low.y()) + 0.5 * scale_room;
    print("<path d=\"M{0:.2f},{2:.2f} v8 H{1:.2f} v-8\" fill=\"none\" stroke=\"black\"/>\n", margin, margin + scale_ * length, y);
    write(margin + scale_ * length + 8.0, y + 9.0, fmt::format("{:g} m", length));
    y += 0.5 * scale_room;
    for (std::size_t m = 0; m < scene.materials.size(); ++m, y += line_height) add_swatch(y, fills[m % fills.size()], scene.materials[m].name);
    const bool any_fixed = std::any_of(scene.blocks.begin(), scene.blocks.end(), [](const BlockInput& block) { return block.fixed; });
    if (any_fixed) {
      add_swatch(y, fixed_fill, "fixed");
      add_swatch(y, "url(#fixed)", "");
    }
    text_ += "</svg>\n";
    return std::move(text_);
  }

 private:
  void add_swatch(double y, const char* fill, const std::string& text) {
    print("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"28\" height=\"16\" fill=\"{}\" stroke=\"#333\" stroke-width=\"0.6\"/>\n", margin, y, fill);
    write(margin + 36.0, y + 13.0, text);
  }

  void write(double x, double y, const std::string& text) {
    if (text.empty()) return;
    print("<text x=\"{:.2f}\" y=\"{:.2f}\" font-family=\"sans-serif\" font-size=\"14\">{}</text>\n", x, y, escaped(text));
  }

  template <typename... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  Box box_;
  double scale_ = 1.0;  ///< [px/m]
  double top_ = 0.0;    ///< [px]
  std::string text_;
};

}  // namespace

std::string svg_drawing(const Scene& scene) {
  Drawing drawing(scene);
  for (const BlockInput& block : scene.blocks) drawing.add(block);
  return drawing.finish(scene);
}

}  // namespace openclose
