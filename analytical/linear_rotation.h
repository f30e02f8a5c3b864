// What the displacement function of the original DDA, linear in the rotation increment, does to a spinning block (case A3): a step by
// d = omega dt multiplies coordinates about the centroid by [[1, -d], [d, 1]], whose determinant is 1 + d^2, so after n steps
//   area / first area = (1 + omega^2 dt^2)^n.
// Shi, G.-H. (1988), Discontinuous Deformation Analysis, PhD thesis, Berkeley: the displacement function; the rest follows.
#pragma once

namespace openclose::analytical {

/// \param angular_velocity [rad/s], constant  \param dt [s]  \param steps >= 0
double linear_rotation_area_ratio(double angular_velocity, double dt, int steps);

/// The angle [rad] really turned in one such step, atan(omega dt): the linear rotation also lags.
double linear_rotation_angle(double angular_velocity, double dt);

}  // namespace openclose::analytical
