#include "openclose/study/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "openclose/io/svg_page.h"

namespace openclose {
namespace {

/// [px] Of one plot, its frame within, and of the text above.
constexpr double plot_width = 560.0, plot_height = 420.0, left = 84.0, right = 20.0, top = 34.0, bottom = 56.0, line_height = 20.0, key_line = 18.0;
/// [-] Of the range, beside the outermost points.
constexpr double room = 0.05;

/// Told apart by people who do not tell red from green, too (M. Okabe, K. Ito, Color universal design).
constexpr std::array colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7a5230"};

/// One axis: from values to a share of its length.
class Axis {
 public:
  explicit Axis(bool is_logarithmic) : is_logarithmic_(is_logarithmic) {}

  bool has(double value) const { return std::isfinite(value) && (!is_logarithmic_ || value > 0.0); }
  void include(double value) {
    if (!has(value)) return;
    low_ = std::min(low_, scaled(value));
    high_ = std::max(high_, scaled(value));
  }
  void close() {
    if (low_ > high_) low_ = 0.0, high_ = 1.0;
    if (low_ == high_) {
      const double half = is_logarithmic_ || low_ == 0.0 ? 0.5 : 0.05 * std::abs(low_);
      low_ -= half, high_ += half;
    }
    const double beside = room * (high_ - low_);
    low_ -= beside, high_ += beside;
  }
  double share(double value) const { return (scaled(value) - low_) / (high_ - low_); }

  /// Values at which the axis has a number: powers of ten, between few of these also 2 and 5 times; or round steps.
  std::vector<double> ticks() const {
    std::vector<double> list;
    if (is_logarithmic_) {
      const bool is_short = high_ - low_ < 2.5;
      for (int power = static_cast<int>(std::floor(low_)); power <= high_; ++power) {
        for (const double digit : {1.0, 2.0, 5.0}) {
          const double value = digit * std::pow(10.0, power);
          if ((digit == 1.0 || is_short) && scaled(value) >= low_ && scaled(value) <= high_) list.push_back(value);
        }
      }
      return list;
    }
    const double least = (high_ - low_) / 6.0, power = std::pow(10.0, std::floor(std::log10(least)));
    double step = 10.0 * power;
    for (const double digit : {5.0, 2.0, 1.0}) {
      if (digit * power >= least) step = digit * power;
    }
    for (double i = std::ceil(low_ / step); i * step <= high_; ++i) list.push_back(i * step);
    return list;
  }

 private:
  double scaled(double value) const { return is_logarithmic_ ? std::log10(value) : value; }

  bool is_logarithmic_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

class PlotDrawing {
 public:
  PlotDrawing(SvgPage& page, const Plot& plot, double x, double y) : page_(page), plot_(plot), x_(plot.log_x), y_(plot.log_y), origin_(x, y) {
    for (const PlotSeries& series : plot.series) {
      for (const PlotPoint& point : series.points) {
        if (!is_drawn(point)) continue;
        x_.include(point.x);
        y_.include(point.y);
        if (point.high) y_.include(*point.high);
      }
    }
    x_.close();
    y_.close();
  }

  void draw() {
    draw_axes();
    for (std::size_t i = 0; i < plot_.series.size(); ++i) draw_series(plot_.series[i], colours[i % colours.size()]);
  }

 private:
  bool is_drawn(const PlotPoint& point) const { return x_.has(point.x) && y_.has(point.y); }
  Vec2 at(double x, double y) const {
    return {origin_.x() + left + x_.share(x) * (plot_width - left - right),
            origin_.y() + plot_height - bottom - y_.share(y) * (plot_height - top - bottom)};
  }

  void draw_axes() {
    const double x1 = origin_.x() + left, x2 = origin_.x() + plot_width - right, y1 = origin_.y() + top, y2 = origin_.y() + plot_height - bottom;
    page_.write(x1, y1 - 12.0, plot_.title, 15.0, " font-weight=\"bold\"");
    for (const double tick : x_.ticks()) {
      const double x = x1 + x_.share(tick) * (x2 - x1);
      page_.line({x, y1}, {x, y2}, "stroke=\"#e4e4e4\"");
      page_.write(x, y2 + 18.0, fmt::format("{:.6g}", tick), 12.0, " text-anchor=\"middle\"");
    }
    for (const double tick : y_.ticks()) {
      const double y = y2 - y_.share(tick) * (y2 - y1);
      page_.line({x1, y}, {x2, y}, "stroke=\"#e4e4e4\"");
      page_.write(x1 - 6.0, y + 4.0, fmt::format("{:.6g}", tick), 12.0, " text-anchor=\"end\"");
    }
    page_.print("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#555\"/>\n", x1, y1, x2 - x1, y2 - y1);
    page_.write(0.5 * (x1 + x2), y2 + 40.0, plot_.x_label, 13.0, " text-anchor=\"middle\"");
    page_.print("<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\" font-size=\"13\">{}</text>\n", origin_.x() + 18.0,
                0.5 * (y1 + y2), escaped(plot_.y_label));
  }

  void draw_series(const PlotSeries& series, const char* colour) {
    std::string line;
    for (const PlotPoint& point : series.points) {
      if (!is_drawn(point)) continue;
      const Vec2 p = at(point.x, point.y);
      if (!point.failed) line += fmt::format("{:.2f},{:.2f} ", p.x(), p.y());
    }
    page_.print("<polyline class=\"curve\" points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"/>\n", line, colour);
    for (const PlotPoint& point : series.points) {
      if (!is_drawn(point)) continue;
      const Vec2 p = at(point.x, point.y);
      if (point.high)
        page_.line(p, at(point.x, *point.high), fmt::format("class=\"interval\" stroke=\"{}\" stroke-width=\"4\" stroke-opacity=\"0.4\"", colour));
      if (point.failed) {
        page_.print("<path class=\"failed\" d=\"M{0:.2f} {1:.2f}l8 8m0 -8l-8 8\" stroke=\"{2}\" stroke-width=\"1.8\"/>\n", p.x() - 4.0, p.y() - 4.0,
                    colour);
      } else {
        page_.print("<circle class=\"point\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3.2\" fill=\"{}\" stroke=\"{}\"><title>{}</title></circle>\n", p.x(),
                    p.y(), point.hollow ? "white" : colour, colour, escaped(fmt::format("{} {:.6g}: {:.6g}", series.name, point.x, point.y)));
      }
    }
  }

  SvgPage& page_;
  const Plot& plot_;
  Axis x_, y_;
  Vec2 origin_;
};

}  // namespace

std::string svg_plots(const std::string& title, const std::vector<std::string>& notes, const std::vector<Plot>& plots) {
  SvgPage page;
  const double head = 44.0 + line_height * static_cast<double>(notes.size());
  std::size_t most_series = 0;
  for (const Plot& plot : plots) most_series = std::max(most_series, plot.series.size());
  const double width = plot_width * static_cast<double>(plots.size()),
               height = head + plot_height + key_line * static_cast<double>(most_series) + 12.0;
  page.print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "font-family=\"sans-serif\">\n<!-- drawn by openclose -->\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
      width, height);
  page.write(20.0, 30.0, title, 18.0, " font-weight=\"bold\"");
  for (std::size_t i = 0; i < notes.size(); ++i) page.write(20.0, 30.0 + line_height * static_cast<double>(i + 1), notes[i], 13.0, " fill=\"#333\"");
  for (std::size_t p = 0; p < plots.size(); ++p) {
    const double x = plot_width * static_cast<double>(p);
    PlotDrawing(page, plots[p], x, head).draw();
    for (std::size_t i = 0; i < plots[p].series.size(); ++i) {
      const double y = head + plot_height + 8.0 + key_line * static_cast<double>(i);
      if (plots[p].series[i].name.empty()) continue;
      page.line({x + left, y - 4.0}, {x + left + 26.0, y - 4.0}, fmt::format("stroke=\"{}\" stroke-width=\"3\"", colours[i % colours.size()]));
      page.write(x + left + 34.0, y, plots[p].series[i].name, 13.0);
    }
  }
  return page.take() + "</svg>\n";
}

}  // namespace openclose
