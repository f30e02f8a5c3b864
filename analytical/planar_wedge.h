// Planar failure of a slope (case E1): a plane through the toe daylights in the face and cuts the level crest. Unit thickness.
//   weight W = (gamma H^2/2)(cot psi - cot psi_f), length L = H/sin psi,
//   F = (c L + W cos psi tan phi)/(W sin psi) = tan phi/tan psi + 2 c sin psi_f/(gamma H sin(psi_f - psi) sin psi).
// Hoek & Bray, Rock Slope Engineering (dry, no crack). 0 < psi < psi_f <= pi/2; phi in [0, pi/2); c >= 0.
#pragma once

#include <array>

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

/// Defaults: the slope of section 3.2 of the paper.
struct PlanarWedge {
  double height = 60.0;                 // H [m]
  double face_angle = 50 * degree;      // psi_f [rad]
  double plane_angle = 35 * degree;     // psi [rad]
  double cohesion = 100e3;              // c [Pa]
  double friction_angle = 40 * degree;  // phi [rad]
  double unit_weight = 27e3;            // gamma [N/m3]
};

/// \throws std::invalid_argument for data outside the ranges above
void require_valid(const PlanarWedge& wedge);

double factor_of_safety(const PlanarWedge& wedge);
double wedge_weight(const PlanarWedge& wedge);  // [N/m]
double plane_length(const PlanarWedge& wedge);  // [m]

/// Toe (the origin), daylight of the plane in the crest, crest of the face [m]: counter-clockwise with the slope rising towards positive x.
std::array<std::array<double, 2>, 3> wedge_vertices(const PlanarWedge& wedge);

}  // namespace openclose::analytical
