// A free block without gravity, at rest at time 0, that a traction of constant size on one of its edges pushes and turns (case B6). The traction
// turns with the block, so its resultant F has a constant moment M about the centroid:
//   theta = M t^2/(2 I),   x'' = R(theta) F/m,   x = (1/m) int_0^t (t - s) R(theta(s)) F ds  (Fresnel integrals).
#pragma once

#include <array>

namespace openclose::analytical {

struct FollowerTraction {
  double mass = 1.0;               // [kg/m]
  double moment_of_inertia = 1.0;  // [kg m2/m]
  std::array<double, 2> force{};   // [N/m] at time 0
  double moment = 0.0;             // [N m/m] about the centroid, counter-clockwise
};

/// [rad] of the block after a time [s] >= 0.
double turned_angle(const FollowerTraction& pushed, double time);

/// [m] of the centroid. The integral by Simpson's rule on 4096 intervals: to 1e-12 of F t^2/m while the block turns by less than 3 rad.
std::array<double, 2> pushed_displacement(const FollowerTraction& pushed, double time);

}  // namespace openclose::analytical
