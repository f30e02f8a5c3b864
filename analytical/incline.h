// The block that slides down a plane (case B1): the rigid solution, and what springs in place of rigid contact change.
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

/// Acceleration [m/s2] down the plane from rest: g (sin alpha - mu cos alpha), and 0 for phi >= alpha (the block holds).
double sliding_acceleration(const BlockOnPlane& block);

/// a t^2/2 [m] with the acceleration above; eq. (8) of the paper. time [s] >= 0.
double sliding_displacement(const BlockOnPlane& block, double time);

/// While both contacts slide downhill the tangential forces are -mu N_i, so m (x'' + mu y'') = W (sin alpha - mu cos alpha) whatever the normal
/// forces and the rotation do. From rest, with x and y counted from the start:
///   x + mu y = g (sin alpha - mu cos alpha) t^2/2  [m].
/// Needs sliding at both corners from t = 0 on; unlike sliding_displacement it has no branch at phi = alpha.
double sliding_invariant(const BlockOnPlane& block, double time);

/// Start at the static penetration with relaxed shear springs, rotation locked. With w^2 = 2 ks/m the block first hangs on the shear springs,
/// x = (g sin alpha/w^2)(1 - cos w t), until these carry mu N: cos(w t*) = 1 - mu/tan alpha; then it slides with acceleration a. Its lead over the
/// rigid block grows linearly:
///   e(t) = [x* - a t*^2/2] + (v* - a t*)(t - t*)  for t >= t*.
/// Exact for rotation locked, alpha > phi; with rotation the true lead is 2-4 % larger for the default block.
struct RelaxedStart {
  double stick_time;      // t* [s]
  double stick_distance;  // x* [m]
  double slip_velocity;   // v* [m/s] at t*
};

/// \throws std::domain_error if phi >= alpha (the springs never carry mu N to the end of the plane)
RelaxedStart relaxed_start(const BlockOnPlane& block);
/// Exact displacement [m] of the start above at any time [s] >= 0, the sticking phase included.
double relaxed_start_displacement(const BlockOnPlane& block, double time);
/// e(t) [m] for time >= t*; see RelaxedStart.
double relaxed_start_lead(const BlockOnPlane& block, double time);

/// Where the block rides on its springs while it slides steadily: y'' = 0, theta'' = 0, tangential force -direction mu N_i at both corners, lever
/// arms taken in the tilted position. With t = tan(tilt), s = direction mu:
///   (h/2) W_n (t - s) = (kn b^2/2) sin(tilt) (1 + s t),   W_n = W cos(alpha),
///   drop = W_n/(2 kn) + (h/2)(1 - cos tilt).
/// Independent of the speed. direction = +1: slides downhill, -1: uphill, 0: no friction, which is also the static pose with relaxed shear springs.
struct SteadyPose {
  double tilt;          // [rad]
  double drop;          // of the centroid below the position in which the untilted block just touches [m]
  double lower_normal;  // normal force at the lower corner [N]
  double upper_normal;  // at the upper corner [N]
};

/// \throws std::domain_error if the upper or lower corner would lift (the block topples instead)
SteadyPose steady_pose(const BlockOnPlane& block, int direction);

}  // namespace openclose::analytical
