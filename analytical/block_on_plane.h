// A rectangular block of unit thickness on a rough plane, and the frame that every problem of it is written in:
// x along the plane, positive downhill; y normal to it, positive away from it; rotation positive from x to y (counter-clockwise when the plane falls
// to the right). The block's underside lies on the plane; its downhill corner is called lower, its uphill corner upper. SI units and radians.
#pragma once

#include <numbers>

namespace openclose::analytical {

inline constexpr double degree = std::numbers::pi / 180.0;

/// Defaults: the sliding block of the verification cases B (2 m x 1 m on 30 degrees, joint stiffness 50 MPa/m on a base of 2 m: 50 MN/m a corner).
struct BlockOnPlane {
  double width = 2.0;                   // [m] along the plane
  double height = 1.0;                  // [m] normal to it
  double density = 2700.0;              // [kg/m3]
  double normal_stiffness = 50e6;       // [N/m] per corner and metre of thickness
  double shear_stiffness = 50e6;        // [N/m] per corner and metre of thickness
  double slope_angle = 30 * degree;     // [rad] in [0, pi/2); 0: level plane
  double friction_angle = 20 * degree;  // [rad] in [0, pi/2)
  double gravity = 9.81;                // [m/s2]

  double friction() const;           // tan(friction_angle) [-]
  double mass() const;               // [kg/m]
  double weight() const;             // [N/m]
  double normal_weight() const;      // weight cos(slope_angle) [N/m]
  double moment_of_inertia() const;  // about the centroid, m (b^2 + h^2)/12 [kg m2/m]
};

/// \throws std::invalid_argument naming the first value out of range: lengths, density, stiffnesses and gravity > 0, angles as above
void require_valid(const BlockOnPlane& block);

}  // namespace openclose::analytical
