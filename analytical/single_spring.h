// One mass on a linear spring, stepped by the theta family (case D1):
//   u1 = u0 + dt (v0 + v1)/2,   m (v1 - v0) = dt [theta F1 + (1 - theta) F0],   F = -k u.
// theta = 1 is Newmark's beta = 1/2, gamma = 1 (the dynamic DDA), theta = 1/2 the trapezoid. With W = w dt, w^2 = k/m, D = 1 + theta W^2/2:
//   [u1]   1 [ 1 - (1 - theta) W^2/2        dt           ] [u0]
//   [v1] = - [ -w^2 dt                      1 - theta W^2/2 ] [v0]
//          D
// (eliminate v1, then u1). det A = (1 + (1 - theta) W^2/2)/D and trace A = (2 - W^2/2)/D, so the eigenvalues are complex for
// W < 2/(theta - 1/2) and their modulus is then sqrt(det A): (1 + W^2/2)^(-1/2), W < 4, for theta = 1; 1 for theta = 1/2.
// theta in [1/2, 1]; dt, w > 0.
#pragma once

#include <array>

namespace openclose::analytical {

struct SpringStep {
  double theta = 1.0;
  double frequency = 1.0;  // w [rad/s]
  double dt = 0.5;         // [s]

  double phase() const { return frequency * dt; }  // W [rad]
};

/// Exact motion of the mass from rest at unit displacement, cos(w t); frequency w [rad/s], time [s].
double free_vibration(double frequency, double time);

/// The same mass with a dashpot of damping ratio xi beside the spring, u'' + 2 xi w u' + w^2 u = 0, from u = 0 with velocity 1: an oscillation for
/// xi < 1, exp(-xi w t) sin(w_d t)/w_d with w_d = w sqrt(1 - xi^2); t exp(-w t) for xi = 1; two decaying exponentials beyond. xi >= 0.
double damped_vibration(double frequency, double damping_ratio, double time);

/// Row-major 2 x 2, acts on (u [m], v [m/s]).
std::array<std::array<double, 2>, 2> amplification_matrix(const SpringStep& step);
/// Largest modulus of its eigenvalues, on both sides of the bifurcation.
double spectral_radius(const SpringStep& step);
/// W from which on the eigenvalues are real; infinite for theta = 1/2.
double bifurcation_phase(double theta);
/// Period of the stepped motion over the true 2 pi/w: W / arg(eigenvalue). Below the bifurcation. \throws std::domain_error beyond
double period_ratio(const SpringStep& step);

}  // namespace openclose::analytical
