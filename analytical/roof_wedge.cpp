#include "openclose/analytical/roof_wedge.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace openclose::analytical {

double roof_wedge_load(const RoofWedge& w) {
  if (!(w.half_angle > 0 && w.half_angle < w.friction_angle && w.friction_angle < std::numbers::pi / 2))
    throw std::domain_error("friction does not hold the wedge");
  const double c = std::cos(w.half_angle), s = std::sin(w.half_angle);
  return 2 * w.squeeze * (w.stiffness_ratio * c * c + s * s) * std::sin(w.friction_angle - w.half_angle) /
         (w.stiffness_ratio * c * std::cos(w.friction_angle) + s * std::sin(w.friction_angle));
}

double pressed_normal_force(const RoofWedge& w) {
  const double c = std::cos(w.half_angle), s = std::sin(w.half_angle);
  return w.squeeze * (w.stiffness_ratio * c * c + s * s) / (w.stiffness_ratio * c);
}

}  // namespace openclose::analytical
