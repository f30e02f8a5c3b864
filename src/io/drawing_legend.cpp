#include "openclose/io/drawing_legend.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "openclose/io/drawing_colours.h"

namespace openclose {
namespace {

constexpr double row_height = 22.0;  ///< [px]

}  // namespace

std::string colour_at(double part) {
  const double place = std::clamp(part, 0.0, 1.0) * static_cast<double>(drawing_colour::gradient.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), drawing_colour::gradient.size() - 2);
  const double share = place - static_cast<double>(i);
  std::array<int, 3> c;
  for (std::size_t k = 0; k < 3; ++k)
    c[k] = static_cast<int>(std::lround((1.0 - share) * drawing_colour::gradient[i][k] + share * drawing_colour::gradient[i + 1][k]));
  return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

/// The left end of the next entry, which is this wide.
double Legend::next_entry(double width) {
  if (x_ > left_ && x_ + width > right_) {
    x_ = left_;
    y_ += 1.5 * row_height + extra_;
    extra_ = 0.0;
  }
  const double x = x_;
  x_ += width + 22.0;
  return x;
}

void Legend::add_swatch(const std::string& fill, const std::string& text, const char* over) {
  const double x = next_entry(36.0 + width_of(text, 14.0));
  for (const std::string& colour : {fill, std::string(over ? over : "")}) {
    if (!colour.empty())
      page_.print("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"28\" height=\"16\" fill=\"{}\" stroke=\"#333\" stroke-width=\"0.6\"/>\n", x, y_ - 13.0,
                  colour);
  }
  page_.write(x + 36.0, y_, text);
}

void Legend::add_line(const char* name, const std::string& colour, double width, const std::string& text, double opacity, const std::string& dashes) {
  const double x = next_entry(42.0 + width_of(text, 14.0));
  page_.line({x, y_ - 5.0}, {x + 34.0, y_ - 5.0},
             fmt::format("class=\"{}\" stroke=\"{}\" stroke-width=\"{:.3f}\" stroke-opacity=\"{:g}\"{}", name, colour, width, opacity, dashes));
  page_.write(x + 42.0, y_, text);
}

void Legend::add_colour_bar(const Picture::Scale& scale) {
  constexpr double length = 240.0;
  const double text = width_of(scale.quantity, 14.0), x = next_entry(text + 12.0 + length + 20.0) + text + 12.0;
  page_.write(x - text - 12.0, y_, scale.quantity);
  page_.print("<defs><linearGradient id=\"colours\">");
  for (std::size_t i = 0; i < drawing_colour::gradient.size(); ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(drawing_colour::gradient.size() - 1);
    page_.print("<stop offset=\"{:.4f}\" stop-color=\"{}\"/>", part, colour_at(part));
  }
  page_.print(
      "</linearGradient></defs>\n<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:g}\" height=\"14\" fill=\"url(#colours)\" stroke=\"#333\" "
      "stroke-width=\"0.6\"/>\n",
      x, y_ - 12.0, length);
  for (const double part : {0.0, 0.5, 1.0})
    page_.write(x + part * length, y_ + 16.0, fmt::format("{:.3g}", part * scale.largest), 12.0, " text-anchor=\"middle\"");
  extra_ = 12.0;
}

void Legend::add_scale_bar(double length, const std::string& text) {
  const double x = next_entry(length + 60.0);
  page_.print("<path class=\"scale\" d=\"M{:.2f},{:.2f} v8 H{:.2f} v-8\" fill=\"none\" stroke=\"black\" stroke-width=\"1.4\"/>\n", x, y_ - 10.0,
              x + length);
  page_.write(x + length + 8.0, y_, text);
}

Vec2 Legend::add_symbol(double width, const std::string& text) {
  const double x = next_entry(width + 8.0 + width_of(text, 14.0));
  page_.write(x + width + 8.0, y_, text);
  return {x, y_ - 5.0};
}

}  // namespace openclose
