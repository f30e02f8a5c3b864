#include "openclose/analytical/planar_wedge.h"

#include <cmath>
#include <stdexcept>

namespace openclose::analytical {

void require_valid(const PlanarWedge& wedge) {
  const double right_angle = std::numbers::pi / 2;
  if (!(wedge.height > 0 && std::isfinite(wedge.height))) throw std::invalid_argument("the height must be positive");
  if (!(wedge.unit_weight > 0 && std::isfinite(wedge.unit_weight))) throw std::invalid_argument("the unit weight must be positive");
  if (!(wedge.cohesion >= 0 && std::isfinite(wedge.cohesion))) throw std::invalid_argument("the cohesion must not be negative");
  if (!(wedge.friction_angle >= 0 && wedge.friction_angle < right_angle))
    throw std::invalid_argument("the friction angle must be in [0, 90) degrees");
  if (!(0 < wedge.plane_angle && wedge.plane_angle < wedge.face_angle && wedge.face_angle <= right_angle)) {
    throw std::invalid_argument("the plane must be flatter than the face and neither beyond (0, 90] degrees");
  }
}

double factor_of_safety(const PlanarWedge& wedge) {
  const double slip = std::sin(wedge.plane_angle);
  return std::tan(wedge.friction_angle) / std::tan(wedge.plane_angle) +
         2 * wedge.cohesion * std::sin(wedge.face_angle) / (wedge.unit_weight * wedge.height * std::sin(wedge.face_angle - wedge.plane_angle) * slip);
}

double wedge_weight(const PlanarWedge& wedge) {
  return wedge.unit_weight * wedge.height * wedge.height * std::sin(wedge.face_angle - wedge.plane_angle) /
         (2 * std::sin(wedge.face_angle) * std::sin(wedge.plane_angle));
}

double plane_length(const PlanarWedge& wedge) {
  return wedge.height / std::sin(wedge.plane_angle);
}

std::array<std::array<double, 2>, 3> wedge_vertices(const PlanarWedge& wedge) {
  const double h = wedge.height;
  return {{{0, 0}, {h / std::tan(wedge.plane_angle), h}, {h / std::tan(wedge.face_angle), h}}};
}

}  // namespace openclose::analytical
