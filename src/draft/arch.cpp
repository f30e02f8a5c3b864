#include <fmt/format.h>

#include <cmath>

#include "openclose/core/error.h"
#include "openclose/draft/all_drafts.h"
#include "openclose/draft/common_tables.h"
#include "openclose/scene/angle.h"

namespace openclose {
namespace {

/// Voussoirs with straight edges between radial joints; a fixed one more at either end.
class Arch {
 public:
  explicit Arch(const Dimensions& d)
      : voussoirs_(d.count("voussoirs")),
        radius_(d.of("radius_m")),
        thickness_(d.of("thickness_m")),
        half_opening_(radians(90.0 - d.of("springing_deg"))) {
    if (thickness_ >= 2.0 * radius_)
      throw InputError({"new arch", 0}, "thickness_m", fmt::format("an arch of radius {:g} m cannot be {:g} m thick", radius_, thickness_),
                       fmt::format("less than twice the radius, {:g}", 2.0 * radius_));
  }

  int voussoirs() const { return voussoirs_; }
  /// From the left springer, which is number 0, to the right one; counter-clockwise.
  Polygon voussoir(int number) const {
    const double left = angle(number - 1), right = angle(number);
    return {at(right, -1), at(right, 1), at(left, 1), at(left, -1)};
  }

 private:
  /// From the vertical, clockwise, of the joint behind a voussoir.
  double angle(int joint) const { return half_opening_ * (2.0 * joint / voussoirs_ - 1.0); }
  Vec2 at(double angle, int outwards) const {
    const double radius = radius_ + 0.5 * outwards * thickness_;
    return {radius * std::sin(angle), radius * std::cos(angle)};
  }

  int voussoirs_;
  double radius_, thickness_, half_opening_;
};

std::string write_arch(const Dimensions& d) {
  AnnotatedText text;
  const Arch arch(d);
  text.comment(
      fmt::format("{} voussoirs of {} m between radial joints, on a centre line of radius {} m. Friction decides how much the thrust may lean; how "
                  "thin an arch can "
                  "be is decided by the line of thrust, which no friction changes: try another thickness with openclose new.",
                  arch.voussoirs(), d.of("thickness_m"), d.of("radius_m")));
  begin(text, fmt::format("An arch of {} voussoirs", arch.voussoirs()), d.of("tilt_deg"));
  add_material(text, {"stone", 2400.0, 1e10, 4e9, 40.0, 0.0});
  for (int number = 0; number <= arch.voussoirs() + 1; ++number) {
    const bool is_springer = number == 0 || number > arch.voussoirs();
    text.table("block", number == 0 ? "The abutments first and last" : "");
    text.key("name", std::string_view(number == 0 ? "left_abutment" : is_springer ? "right_abutment" : fmt::format("voussoir_{}", number)));
    text.key("material", std::string_view("stone"));
    text.points("vertices_m", arch.voussoir(number));
    if (is_springer) text.key("fixed", true);
  }
  add_motion(text, 1e-3, 1.0);
  return text.text();
}

}  // namespace

Draft arch_draft() {
  return {
      "arch",
      "a voussoir arch on fixed abutments",
      {{"voussoirs", "how many there are", 15.0, {.low = 3.0, .high = 999.0, .low_included = true, .high_included = true}, true},
       {"radius_m", "of the line through the middle of the voussoirs", 2.0},
       {"thickness_m", "of the voussoirs, across that line", 0.36},
       {"springing_deg",
        "of the joints at the abutments above the horizontal; 0 is a semicircle",
        15.0,
        {.low = -30.0, .high = 80.0, .low_included = true, .high_included = true}},
       {"tilt_deg", "of the table on which it stands, to the right", 0.0, {.low = -90.0, .high = 90.0, .low_included = true, .high_included = true}}},
      &write_arch};
}

}  // namespace openclose
