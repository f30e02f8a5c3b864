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

/// The same where friction falls linearly over a slip D, the slip-weakening distance. With kappa = N (mu - mu_r)/(2 ks D) it slides, from x* and v*
/// on, with x'' = g (sin alpha - mu cos alpha) + beta^2 (x - x*), beta^2 = g cos alpha (mu - mu_r)/(D (1 - kappa)), and has the residual friction
/// once x - x* = D (1 - kappa).
///
/// \param first  of released_slide() or released_rigid_slide()
/// \return       from where friction is residual
/// \throws std::domain_error if friction stops the block before, or if the springs let go faster than it weakens (kappa >= 1)
ReleasedSlide weakened_slide(const BlockOnPlane& block, double residual_angle, double distance, const ReleasedSlide& first);

/// [m] What a delay [s] of the weakening costs at most at a time after it: the delay acts like an acceleration beta^2 delay v, and where the peak
/// friction angle is at least the slope's, v <= v* cosh(beta t).
double cost_of_late_weakening(const BlockOnPlane& block, double residual_angle, double distance, const ReleasedSlide& first, double delay,
                              double time);

// Factor at which the upper corner slips, each corner carrying half of the shear force: 2 mu N_u/T.
double first_slip_factor(const BlockOnPlane& block);

/// [-] Strength reduction factor of the block at rest, without cohesion, at small displacements. Its corners share the shear force T = W sin alpha
/// equally and carry N_l - N_u = T h/b more and less. The upper one slips first, at F1 = 2 mu N_u/T, and from then on carries mu_r N_u/F. Then the
/// lower one holds up to F2 = (mu_r N_u + mu N_l)/T. The block stands up to the larger of the two.
double residual_strength_factor(const BlockOnPlane& block, double residual_angle);

/// [-] The same where friction falls linearly over a slip D. Between the upper corner's first slip and the lower one's, at a way x = mu N_l/(F ks),
/// the upper one carries T_u = (N_u/F)(mu - (mu - mu_r)(x - T_u/ks)/D), no less than mu_r N_u/F; both together carry most at one of the two.
///
/// \throws std::domain_error if the upper corner's spring lets go faster than it weakens
double weakened_strength_factor(const BlockOnPlane& block, double residual_angle, double distance);

}  // namespace openclose::analytical
