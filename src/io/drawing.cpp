#include "openclose/io/drawing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "openclose/geometry/box.h"
#include "openclose/io/drawing_colours.h"
#include "openclose/io/drawing_legend.h"
#include "openclose/io/drawing_loads.h"
#include "openclose/io/drawing_units.h"
#include "openclose/io/svg_page.h"

namespace openclose {
namespace {

using namespace drawing_colour;

/// [px] The blocks fill one of these two, and titles and legends have at least the last one.
constexpr double widest_drawing = 1140.0, highest_drawing = 820.0, narrowest_page = 760.0;
constexpr double margin = 30.0;
constexpr double title_size = 20.0, note_size = 14.0, line_height = 22.0;
/// [px] Room below the blocks before the legend begins.
constexpr double legend_gap = 22.0;

/// Of more blocks than this each colour is one path, without tooltips: a viewer then still turns pages at once.
constexpr std::size_t most_single_blocks = 4000;
/// Of more lines than this those of about the same width are one path.
constexpr std::size_t most_single_lines = 4000;
constexpr int width_classes = 24;
constexpr int colour_classes = 32;
/// [-] Forces and openings below this part of the largest are thinner than a line can be drawn.
constexpr double least_drawn_part = 0.005;
/// Names are written beside no more points and loads than this; tooltips tell the others.
constexpr std::size_t most_labels = 12;
/// [px] Of the arrow of a growing part of gravity in the legend.
constexpr double push_length = 34.0;

/// 1, 2 or 5 times a power of ten, not above the value.
double round_length(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= value) return digit * power;
  }
  return power;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

class Drawing {
 public:
  explicit Drawing(const Picture& picture) : picture_(picture), loads_(picture.loads) {
    box_ = Box::around(picture.blocks.front().outline);
    std::vector<double> areas;
    for (const Picture::Block& block : picture.blocks) {
      const Box other = Box::around(block.outline);
      box_ = {box_.low.cwiseMin(other.low), box_.high.cwiseMax(other.high)};
      if (!block.fixed) areas.push_back(signed_area(block.outline));
    }
    const Vec2 size = box_.high - box_.low;
    scale_ = std::min(widest_drawing / size.x(), highest_drawing / size.y());
    block_size_ = areas.empty() ? 100.0 : scale_ * std::sqrt(median(std::move(areas)));
    // Loads act from outside: their arrows have to lie on the page, too.
    std::vector<Vec2> ends = {Vec2::Zero(), scale_ * size};
    for (const Picture::Arrow& load : picture.loads) {
      for (const double part : {-0.5, 0.5}) ends.push_back(scale_ * (load.point + part * load.spread - box_.low) + loads_.outwards(load));
    }
    const Box around = Box::around(ends);
    page_width_ = std::max(narrowest_page, scale_ * size.x() + 2.0 * (margin + std::max(-around.low.x(), around.high.x() - scale_ * size.x())));
    left_ = 0.5 * (page_width_ - scale_ * size.x());
    title_lines_ = wrapped(picture.title, title_size);
    for (const std::string& note : picture.notes) {
      for (std::string& line : wrapped(note, note_size)) note_lines_.push_back(std::move(line));
    }
    notes_bottom_ = margin + line_height * static_cast<double>(note_lines_.size()) + 1.3 * title_size * static_cast<double>(title_lines_.size());
    // With room for the number above an arrow.
    top_ = notes_bottom_ + (picture.loads.empty() ? 6.0 : 6.0 + line_height) + (around.high.y() - scale_ * size.y());
  }

  std::string svg() {
    draw_blocks();
    draw_seams();
    draw_joints();
    draw_cracks();
    draw_forces();
    draw_velocities();
    draw_supports();
    draw_loads();
    draw_points();
    draw_legend();
    const std::string body = page_.take();
    SvgPage page;
    page.print(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
        "font-family=\"sans-serif\">\n<!-- drawn by openclose -->\n",
        page_width_, bottom_ + margin);
    page.print(
        "<defs><pattern id=\"fixed\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\">"
        "<circle cx=\"3.5\" cy=\"3.5\" r=\"1.1\" fill=\"#444\"/></pattern></defs>\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n");
    double y = margin;
    for (const std::string& line : title_lines_) page.write(margin, (y += 1.3 * title_size) - 10.0, line, title_size, " font-weight=\"bold\"");
    for (const std::string& line : note_lines_) page.write(margin, (y += line_height) - 8.0, line, note_size, " fill=\"#333\"");
    return page.take() + body + "</svg>\n";
  }

 private:
  Vec2 at(const Vec2& place) const { return {left_ + scale_ * (place.x() - box_.low.x()), top_ + scale_ * (box_.high.y() - place.y())}; }

  /// Broken between words where it would be wider than the page.
  std::vector<std::string> wrapped(const std::string& text, double size) const {
    std::vector<std::string> lines;
    std::string rest = text;
    const auto most = static_cast<std::size_t>((page_width_ - 2.0 * margin) / width_of("x", size));
    while (rest.size() > most) {
      std::size_t end = rest.rfind(' ', most);
      if (end == std::string::npos || end == 0) end = most;
      lines.push_back(rest.substr(0, end));
      rest = rest.substr(std::min(rest.size(), rest.find_first_not_of(' ', end)));
    }
    if (!rest.empty()) lines.push_back(rest);
    return lines;
  }

  double outline_width() const { return std::clamp(0.02 * block_size_, 0.08, 0.9); }

  std::string fill_of(const Picture::Block& block) const {
    if (block.fixed) return fixed_fill;
    if (!picture_.scale) return fills[static_cast<std::size_t>(block.colour) % fills.size()];
    return colour_at(picture_.scale->largest > 0.0 ? block.value / picture_.scale->largest : 0.0);
  }

  void draw_blocks() {
    if (picture_.blocks.size() > most_single_blocks) return draw_blocks_by_colour();
    const std::string stroke = fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\" stroke-linejoin=\"round\"", outline_colour, outline_width());
    for (const Picture::Block& block : picture_.blocks) {
      std::string points;
      for (const Vec2& vertex : block.outline) {
        const Vec2 p = at(vertex);
        fmt::format_to(std::back_inserter(points), "{:.2f},{:.2f} ", p.x(), p.y());
      }
      points.pop_back();
      page_.print("<polygon points=\"{}\" fill=\"{}\" {}><title>{}</title></polygon>\n", points, fill_of(block), stroke, tooltip(block));
      if (block.fixed) page_.print("<polygon points=\"{}\" fill=\"url(#fixed)\" pointer-events=\"none\"/>\n", points);
    }
  }

  std::string tooltip(const Picture::Block& block) const {
    if (!picture_.scale || block.fixed) return escaped(block.name);
    return escaped(fmt::format("{}: {} {:.4g}", block.name, picture_.scale->quantity, block.value));
  }

  void draw_blocks_by_colour() {
    std::map<std::string, PathData> paths;
    Polygon outline;
    for (const Picture::Block& block : picture_.blocks) {
      Picture::Block rounded{"", {}, block.colour, block.fixed, block.value};
      if (picture_.scale && picture_.scale->largest > 0.0)
        rounded.value = picture_.scale->largest * std::round(block.value / picture_.scale->largest * colour_classes) / colour_classes;
      outline.clear();
      for (const Vec2& vertex : block.outline) outline.push_back(at(vertex));
      paths[fill_of(rounded)].polygon(outline);
    }
    for (const auto& [fill, path] : paths) {
      page_.path(path, fmt::format("fill=\"{}\" stroke=\"{}\" stroke-linejoin=\"round\"", fill, outline_colour), outline_width());
    }
  }

  static const char* colour_of_seam(std::size_t name) { return drawing_colour::seams[name % drawing_colour::seams.size()]; }
  /// Names beyond the colours are dashed, ever shorter. \param scale  of the numbers of the line
  static std::string dashes_of_seam(std::size_t name, double scale) {
    const std::size_t round = name / drawing_colour::seams.size();
    return round == 0 ? "" : fmt::format(" stroke-dasharray=\"{0:g} {0:g}\"", scale * 8.0 / static_cast<double>(round));
  }

  void draw_seams() {
    std::vector<PathData> paths(picture_.seam_names.size());
    for (const Picture::Seam& seam : picture_.seams) paths[static_cast<std::size_t>(seam.name)].segment(at(seam.from), at(seam.to));
    for (std::size_t n = 0; n < paths.size(); ++n) {
      page_.path(paths[n],
                 fmt::format("class=\"seam\" fill=\"none\" stroke=\"{}\" stroke-linecap=\"butt\"{}", colour_of_seam(n), dashes_of_seam(n, 100.0)),
                 seam_width());
    }
  }
  double seam_width() const { return std::clamp(0.05 * block_size_, 0.4, 2.5); }

  void draw_joints() {
    std::map<std::tuple<JointDrawing, bool, bool>, PathData> paths;
    for (const Picture::Joint& joint : picture_.joints) {
      if (joint.state == JointDrawing::plain) continue;
      const bool is_point = joint.from == joint.to;
      PathData& path = paths[{joint.state, is_point, joint.is_slight}];
      if (is_point) {
        path.dot(at(joint.from));
      } else if (joint.state != JointDrawing::sticking) {  // as the outlines have it
        path.segment(at(joint.from), at(joint.to));
      }
    }
    for (const auto& [kind, path] : paths) {
      const auto [state, is_point, is_slight] = kind;
      const double width = is_slight ? slight_width() : std::clamp(0.06 * block_size_, 0.25, 3.0) * (is_point ? 2.0 : 1.0);
      if (state == JointDrawing::sticking) {
        page_.path(path, fmt::format("class=\"sticking\" fill=\"none\" stroke=\"{}\" stroke-linecap=\"round\"", outline_colour), width);
        continue;
      }
      const bool open = state == JointDrawing::open;
      page_.path(path,
                 fmt::format("class=\"{}\" fill=\"none\" stroke=\"{}\" stroke-linecap=\"round\"", open ? "open" : "sliding",
                             open ? open_colour : sliding_colour),
                 width);
    }
  }

  double slight_width() const { return std::clamp(0.02 * block_size_, 0.25, 1.0); }

  /// [px] Of the widest line that stands for a size.
  double widest_line() const { return std::clamp(0.3 * block_size_, 1.5, 14.0); }

  struct SizedLine {
    std::vector<std::pair<Vec2, Vec2>> pieces;
    double size = 0.0;
  };

  /// Lines whose width is their size over the largest, in paths by width where there are many.
  void draw_sized_lines(const std::vector<SizedLine>& lines, double largest, const char* name, const char* colour, double opacity) {
    if (lines.empty()) return;
    page_.print("<g class=\"{}\" fill=\"none\" stroke=\"{}\" stroke-opacity=\"{:g}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n", name,
                colour, opacity);
    const bool single = lines.size() <= most_single_lines;
    std::map<int, PathData> paths;
    for (const SizedLine& line : lines) {
      if (line.size < least_drawn_part * largest) continue;
      PathData own;
      PathData& data = single ? own : paths[static_cast<int>(std::ceil(line.size / largest * width_classes))];
      for (const auto& [from, to] : line.pieces) data.segment(at(from), at(to));
      if (single) page_.path(own, "class=\"sized\"", widest_line() * line.size / largest);
    }
    for (const auto& [width, path] : paths) page_.path(path, "class=\"sized\"", widest_line() * width / width_classes);
    page_.print("</g>\n");
  }

  void draw_forces() {
    std::vector<SizedLine> lines;
    for (const Picture::Force& force : picture_.forces) {
      largest_force_ = std::max(largest_force_, force.size);
      lines.push_back({{{force.from, force.to}}, force.size});
    }
    draw_sized_lines(lines, largest_force_, "forces", force_colour, 0.72);
  }

  void draw_cracks() {
    std::vector<SizedLine> lines;
    for (const Picture::Crack& crack : picture_.cracks) {
      largest_opening_ = std::max(largest_opening_, crack.opening);
      lines.push_back({{{crack.from, crack.to}}, crack.opening});
    }
    std::erase_if(lines, [](const SizedLine& line) { return line.size <= 0.0; });
    draw_sized_lines(lines, largest_opening_, "cracks", open_colour, 0.8);
  }

  /// A line with a head at its end.
  void draw_arrow(const Vec2& from, const Vec2& to, double head, const std::string& colour, double width) {
    const Vec2 way = to - from;
    const double length = way.norm();
    if (length <= 0.0) return;
    const Vec2 along = way / length, across = perpendicular(along);
    const double size = std::min(head, 0.6 * length);
    const Vec2 neck = to - size * along;
    page_.line(from, neck, fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\"", colour, width));
    const Vec2 a = neck + 0.4 * size * across, b = neck - 0.4 * size * across;
    page_.print("<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}z\" fill=\"{}\"/>\n", to.x(), to.y(), a.x(), a.y(), b.x(), b.y(), colour);
  }

  /// One arrow in each cell of a grid, or they would cover each other: the fastest there.
  void draw_velocities() {
    double fastest = 0.0;
    for (const Picture::Arrow& arrow : picture_.velocities) fastest = std::max(fastest, arrow.vector.norm());
    if (fastest == 0.0) return;
    longest_arrow_ = std::clamp(1.1 * block_size_, 22.0, 60.0);
    const double cell = 0.75 * longest_arrow_;
    std::map<std::pair<long, long>, const Picture::Arrow*> shown;
    for (const Picture::Arrow& arrow : picture_.velocities) {
      if (arrow.vector.norm() < 0.03 * fastest) continue;
      const Vec2 p = at(arrow.point) / cell;
      const Picture::Arrow*& place = shown[{std::lround(p.x()), std::lround(p.y())}];
      if (!place || place->vector.norm() < arrow.vector.norm()) place = &arrow;
    }
    page_.print("<g class=\"velocities\">\n");
    for (const auto& [place, arrow] : shown) {
      const Vec2 way = longest_arrow_ / fastest * Vec2(arrow->vector.x(), -arrow->vector.y());
      page_.line(at(arrow->point), at(arrow->point) + way, "stroke=\"white\" stroke-width=\"4\" stroke-opacity=\"0.6\" stroke-linecap=\"round\"");
      draw_arrow(at(arrow->point), at(arrow->point) + way, 8.0, "black", 1.4);
    }
    page_.print("</g>\n");
  }

  void draw_loads() {
    if (picture_.loads.empty()) return;
    page_.print("<g class=\"loads\">\n");
    const std::vector<DrawnLoad> drawn = loads_.drawn([this](const Vec2& place) { return at(place); }, picture_.loads.size() <= most_labels);
    for (const DrawnLoad& load : drawn) {
      for (const auto& [from, to] : load.arrows) draw_arrow(from, to, load.head, load_colour, load.width);
      if (load.arrows.size() > 1)
        page_.line(load.outer_end, load.other_outer_end, fmt::format("class=\"spread\" stroke=\"{}\" stroke-width=\"{}\"", load_colour, load.width));
    }
    // Above the arrows of neighbours.
    for (const DrawnLoad& load : drawn) {
      if (!load.label.empty()) label(0.5 * (load.outer_end + load.other_outer_end), load.label, load_colour);
    }
    page_.print("</g>\n");
  }

  /// With a white rim, readable on blocks; on the side of the point where the page has room for it, and below the lines of the title.
  void label(const Vec2& p, const std::string& text, const char* colour) {
    const bool to_the_left = p.x() + 8.0 + width_of(text, 13.0) > page_width_;
    page_.write(
        to_the_left ? p.x() - 7.0 : p.x() + 7.0, std::max(p.y() - 6.0, notes_bottom_ + 8.0), text, 13.0,
        fmt::format(" fill=\"{}\" stroke=\"white\" stroke-width=\"3\" paint-order=\"stroke\"{}", colour, to_the_left ? " text-anchor=\"end\"" : "")
            .c_str());
  }

  void draw_supports() {
    if (picture_.supports.empty()) return;
    page_.print("<g class=\"supports\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\">\n", support_colour);
    for (const Picture::Spring& support : picture_.supports) {
      const Vec2 p = at(support.point);
      // As if the left and the lower side were outside; on the others they are mirrored.
      const int x = support.outwards.x() > 0.0 ? -1 : 1, y = support.outwards.y() > 0.0 ? -1 : 1;
      const auto mirrored = [&](const char* path) {
        page_.print("<path transform=\"translate({:.2f} {:.2f}) scale({} {})\" d=\"M0 0{}\"/>\n", p.x(), p.y(), x, y, path);
      };
      if (support.in_x) mirrored("h-6l-2 -5l-4 10l-4 -10l-4 10l-2 -5h-4m0 -8v16");
      if (support.in_y) mirrored("v6l-5 2l10 4l-10 4l10 4l-5 2v4m-8 0h16");
      page_.print("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2.6\" fill=\"{}\"/>\n", p.x(), p.y(), support_colour);
    }
    page_.print("</g>\n");
  }

  void draw_points() {
    if (picture_.points.empty()) return;
    page_.print("<g class=\"points\">\n");
    for (const Picture::Point& point : picture_.points) {
      const Vec2 p = at(point.place);
      page_.print("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4\" fill=\"white\" stroke=\"black\" stroke-width=\"1.4\"><title>{}</title></circle>\n",
                  p.x(), p.y(), escaped(point.name));
      if (picture_.points.size() <= most_labels) label(p, point.name, "black");
    }
    page_.print("</g>\n");
  }

  void draw_legend() {
    Legend legend(page_, {margin, top_ + scale_ * (box_.high.y() - box_.low.y()) + legend_gap + 14.0}, page_width_ - margin);
    const double bar = round_length(std::min(0.25 * (box_.high.x() - box_.low.x()), 300.0 / scale_));
    legend.add_scale_bar(scale_ * bar, fmt::format("{:g} m", bar));
    if (picture_.scale) legend.add_colour_bar(*picture_.scale);
    if (!picture_.scale) {
      std::vector<char> used(picture_.colour_names.size(), 0);
      for (const Picture::Block& block : picture_.blocks) {
        if (!block.fixed && static_cast<std::size_t>(block.colour) < used.size()) used[static_cast<std::size_t>(block.colour)] = 1;
      }
      for (std::size_t m = 0; m < picture_.colour_names.size(); ++m) {
        if (used[m]) legend.add_swatch(fills[m % fills.size()], picture_.colour_names[m]);
      }
    }
    if (std::ranges::any_of(picture_.blocks, &Picture::Block::fixed)) legend.add_swatch(fixed_fill, "fixed", "url(#fixed)");
    std::set<int> seams;
    for (const Picture::Seam& seam : picture_.seams) seams.insert(seam.name);
    for (const int name : seams) {
      const auto n = static_cast<std::size_t>(name);
      legend.add_line("seam-key", colour_of_seam(n), 2.5, picture_.seam_names[n], 1.0, dashes_of_seam(n, 1.0));
    }
    const auto has = [&](JointDrawing state, bool is_slight = false) {
      return std::ranges::any_of(picture_.joints, [&](const Picture::Joint& joint) { return joint.state == state && joint.is_slight == is_slight; });
    };
    if (has(JointDrawing::sticking)) legend.add_line("sticking", outline_colour, 1.0, "joint that holds");
    if (has(JointDrawing::sliding)) legend.add_line("sliding", sliding_colour, 3.0, "slides");
    if (has(JointDrawing::open)) legend.add_line("open", open_colour, 3.0, "open");
    if (has(JointDrawing::open, true)) legend.add_line("open", open_colour, slight_width(), "open by less than a hundredth of the widest");
    if (largest_opening_ == 0.0 && !picture_.crack_name.empty()) legend.add_symbol(0.0, picture_.crack_name);
    if (largest_opening_ > 0.0)
      legend.add_line("crack-scale", open_colour, widest_line(), fmt::format("{} {}", picture_.crack_name, length_text(largest_opening_)), 0.8);
    if (largest_force_ > 0.0) {
      for (const double part : {1.0, 0.3}) {
        const double size = part == 1.0 ? largest_force_ : round_length(part * largest_force_);
        legend.add_line("force-scale", force_colour, widest_line() * size / largest_force_, (part == 1.0 ? "largest force " : "") + force_text(size),
                        0.72);
      }
    }
    if (longest_arrow_ > 0.0) {
      const Vec2 left = legend.add_symbol(longest_arrow_, picture_.velocity_name);
      draw_arrow(left, left + Vec2(longest_arrow_, 0.0), 8.0, "black", 1.4);
    }
    if (std::ranges::any_of(picture_.loads, [](const Picture::Arrow& load) { return !load.vector.isZero(0.0); }))
      legend.add_line("load-key", load_colour, 2.4, "load");
    if (picture_.push) {
      const Vec2 way = push_length * Vec2(picture_.push->direction.x(), -picture_.push->direction.y()).normalized();
      const Vec2 middle = legend.add_symbol(push_length, picture_.push->name) + Vec2(0.5 * push_length, 0.0);
      page_.print("<g class=\"push\">\n");
      draw_arrow(middle - 0.5 * way, middle + 0.5 * way, 11.0, load_colour, 2.4);
      page_.print("</g>\n");
    }
    if (!picture_.supports.empty()) legend.add_line("support-key", support_colour, 2.4, "support");
    if (!picture_.points.empty()) {
      const Vec2 left = legend.add_symbol(6.0, "measured point");
      page_.print("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"4\" fill=\"white\" stroke=\"black\" stroke-width=\"1.4\"/>\n", left.x() + 4.0, left.y());
    }
    bottom_ = legend.bottom();
  }

  const Picture& picture_;
  LoadArrows loads_;
  Box box_;
  double scale_ = 1.0;             ///< [px/m]
  double left_ = 0.0, top_ = 0.0;  ///< [px] of the blocks
  double notes_bottom_ = 0.0;      ///< [px] where title and notes end
  double page_width_ = 0.0;        ///< [px]
  double block_size_ = 0.0;        ///< [px] of the median free block
  double bottom_ = 0.0;            ///< [px] where the legend ends
  double largest_force_ = 0.0, largest_opening_ = 0.0;
  double longest_arrow_ = 0.0;  ///< [px] of the velocities
  std::vector<std::string> title_lines_, note_lines_;
  SvgPage page_;
};

}  // namespace

std::string svg_drawing(const Picture& picture) {
  return Drawing(picture).svg();
}

}  // namespace openclose
