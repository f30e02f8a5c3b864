// A block that is thrown down a plane on which it could rest: its friction angle, above the slope's, falls to a residual one as soon as it slips
// (case B7). Rotation locked, shear springs relaxed at time 0. With w^2 = 2 ks/m it first hangs on the springs,
//   x = (v0/w) sin(w t) + (g sin alpha/w^2)(1 - cos w t),
// until these carry the peak strength, x* = mu W cos(alpha)/(2 ks); then it slides with the residual acceleration,
//   x = x* + v* (t - t*) + (a/2)(t - t*)^2,   a = g (sin alpha - mu_r cos alpha).
// Rigid contacts slip at once: x* = 0, t* = 0, v* = v0.
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

struct ReleasedSlide {
  double slip_time = 0.0;      // t* [s]
  double slip_distance = 0.0;  // x* [m]
  double slip_velocity = 0.0;  // v* [m/s]
  double acceleration = 0.0;   // a [m/s2]

  double displacement(double time) const;  // [m] at a time [s] >= t*
};

/// \param block           its friction angle is the peak one
/// \param residual_angle  [rad]
/// \param speed           [m/s] v0 > 0 down the plane
/// \throws std::domain_error if the springs hold the block
ReleasedSlide released_slide(const BlockOnPlane& block, double residual_angle, double speed);
ReleasedSlide released_rigid_slide(const BlockOnPlane& block, double residual_angle, double speed);

// Factor at which the upper corner slips, each corner carrying half of the shear force: 2 mu N_u/T.
double first_slip_factor(const BlockOnPlane& block);

/// [-] Strength reduction factor of the block at rest, without cohesion, at small displacements. Its corners share the shear force T = W sin alpha
/// equally and carry N_l - N_u = T h/b more and less. The upper one slips first, at F1 = 2 mu N_u/T, and from then on carries mu_r N_u/F. Then the
/// lower one holds up to F2 = (mu_r N_u + mu N_l)/T. The block stands up to the larger of the two.
double residual_strength_factor(const BlockOnPlane& block, double residual_angle);

}  // namespace openclose::analytical
