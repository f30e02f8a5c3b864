#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "openclose/core/error.h"
#include "openclose/draft/all_drafts.h"
#include "openclose/draft/common_tables.h"

namespace openclose {
namespace {

/// From left to right, in bricks.
struct Piece {
  double left, right;
};

/// Running bond, with half bricks at the ends of every second course, and perhaps doors or windows at equal distances, each under a lintel of one
/// stone.
class Wall {
 public:
  explicit Wall(const Dimensions& d)
      : courses_(d.count("courses")),
        bricks_(d.count("bricks")),
        door_(d.count("door_bricks")),
        doors_(d.count("doors")),
        sill_(d.count("sill_courses")),
        lintel_(sill_ + d.count("door_courses")) {
    const bool has_room = doors_ * (door_ + 4) <= bricks_ && lintel_ < courses_;
    if (door_ > 0 && !has_room)
      throw InputError({"new wall", 0}, "", "the doors do not fit into the wall",
                       "doors * (door_bricks + 4) <= bricks and sill_courses + door_courses < courses");
  }

  int courses() const { return courses_; }
  int bricks() const { return bricks_; }
  std::vector<Piece> course(int number) const {
    std::vector<Piece> pieces = whole_course(number);
    if (door_ == 0 || number < sill_ || number > lintel_) return pieces;
    const bool is_lintel = number == lintel_;
    const double support = is_lintel ? 0.5 : 0.0;  // at either side
    for (int k = 0; k < doors_; ++k) {
      const Piece door = opening(k), gap{door.left - support, door.right + support};
      pieces = without(pieces, gap);
      if (is_lintel) pieces.push_back(gap);
    }
    std::ranges::sort(pieces, {}, &Piece::left);
    return pieces;
  }

 private:
  /// Its sides are where bricks end, of this course or of the next one.
  Piece opening(int number) const {
    const double middle = (number + 0.5) * bricks_ / doors_, left = 0.5 * std::round(2.0 * middle - door_);
    return {left, left + door_};
  }

  std::vector<Piece> whole_course(int number) const {
    std::vector<double> joints{0.0};
    for (int brick = 0; brick <= bricks_; ++brick) {
      const double joint = brick + (number % 2 == 0 ? 0.0 : 0.5);
      if (joint > 0.0 && joint < bricks_) joints.push_back(joint);
    }
    joints.push_back(bricks_);
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i + 1 < joints.size(); ++i) pieces.push_back({joints[i], joints[i + 1]});
    return pieces;
  }

  /// What lies outside of the gap; pieces that reach into it are cut.
  static std::vector<Piece> without(const std::vector<Piece>& pieces, const Piece& gap) {
    std::vector<Piece> outside;
    for (const Piece& piece : pieces) {
      for (const Piece& part : {Piece{piece.left, std::min(piece.right, gap.left)}, Piece{std::max(piece.left, gap.right), piece.right}}) {
        if (part.right > part.left) outside.push_back(part);
      }
    }
    return outside;
  }

  int courses_, bricks_, door_, doors_;
  int sill_, lintel_;  ///< courses below the openings, and that of their lintels
};

std::string write_wall(const Dimensions& d) {
  AnnotatedText text;
  const Wall wall(d);
  const double length = d.of("brick_length_m"), height = d.of("brick_height_m"), tilt = d.of("tilt_deg");
  text.comment(
      fmt::format("A dry wall in running bond, {} courses of {} bricks of {} m by {} m. As long as nothing overturns its factor of safety is "
                  "tan(friction angle) / "
                  "tan(tilt), whatever its size; {}.",
                  wall.courses(), wall.bricks(), length, height,
                  tilt == 0.0 ? "on a level table no friction is needed and there is none" : fmt::format("the table is tilted by {} degrees", tilt)));
  begin(text, fmt::format("A dry wall of {} courses", wall.courses()), tilt);
  add_material(text, {"brick", 2000.0, 1e10, 4e9, 35.0, 0.0});
  const auto add_block = [&](const std::string& name, const Vec2& low, const Vec2& high, const std::string& words) {
    text.table("block", words);
    text.key("name", std::string_view(name));
    text.key("material", std::string_view("brick"));
    text.points("vertices_m", {low, {high.x(), low.y()}, high, {low.x(), high.y()}});
  };
  add_block("base", {-length, -height}, {(wall.bricks() + 1) * length, 0.0}, "The ground first, then the bricks from below, from left to right");
  text.key("fixed", true);
  for (int course = 0; course < wall.courses(); ++course) {
    int number = 0;
    for (const Piece& piece : wall.course(course)) {
      add_block(fmt::format("course_{}_{}", course + 1, ++number), {piece.left * length, course * height},
                {piece.right * length, (course + 1) * height}, "");
    }
  }
  add_motion(text, 1e-3, 1.0);
  return text.text();
}

}  // namespace

Draft wall_draft() {
  constexpr Range many{.low = 1.0, .high = 999.0, .low_included = true, .high_included = true};
  constexpr Range none_or_many{.low = 0.0, .high = 999.0, .low_included = true, .high_included = true};
  return {"wall",
          "a dry wall in running bond on a table that can be tilted",
          {{"courses", "how many there are", 9.0, many, true},
           {"bricks", "in a course", 9.0, many, true},
           {"brick_length_m", "of a brick", 0.6},
           {"brick_height_m", "of a brick", 0.4},
           {"door_bricks", "width of a door or window, in bricks; 0 is none", 0.0, none_or_many, true},
           {"door_courses", "its height, in courses", 5.0, many, true},
           {"doors", "how many there are, at equal distances", 1.0, many, true},
           {"sill_courses", "below each, which makes it a window", 0.0, none_or_many, true},
           {"tilt_deg",
            "of the table on which it stands, to the right",
            10.0,
            {.low = -90.0, .high = 90.0, .low_included = true, .high_included = true}}},
          &write_wall};
}

}  // namespace openclose
