#include "openclose/scene/section.h"

#include <cmath>
#include <numbers>

namespace openclose {
namespace {

/// [-] Of the unit normal of a plane, along the section; one that has less lies in it as well as anybody measures directions (0.6 degrees).
constexpr double least_part_along = 0.01;

}  // namespace

std::optional<PlaneInSection> plane_in_section(double dip, double dip_direction, double section) {
  const double across = dip_direction - section;
  const double horizontal = std::sin(dip) * std::cos(across), vertical = std::cos(dip);
  const double along = std::hypot(horizontal, vertical);
  if (along < least_part_along) return std::nullopt;
  PlaneInSection line;
  line.dip = std::atan2(-horizontal, vertical);
  if (line.dip <= -0.5 * std::numbers::pi) line.dip += std::numbers::pi;
  line.spacing = 1.0 / along;
  line.oblique = std::abs(std::sin(dip) * std::sin(across));
  return line;
}

}  // namespace openclose
