// One mass on a linear spring, u'' = -w^2 u, stepped by schemes of second order (case D1).
//
// Generalised alpha (Chung and Hulbert 1993) acts on (u, v, a): with am = (2 r - 1)/(r + 1), af = r/(r + 1), g = 1/2 - am + af, b = (1 - am +
// af)^2/4, r the spectral radius at infinite frequency, eliminating u1 from (1 - am) a1 + am a0 = -w^2 [(1 - af) u1 + af u0] gives
//   a1 = -{am a0 + w^2 [u0 + (1 - af) (dt v0 + dt^2 (1/2 - b) a0)]}/[1 - am + (1 - af) b w^2 dt^2].
//
// TR-BDF2 (Bank et al. 1985) is linear in y = u + i v/w, y' = -i w y, so a step multiplies y by its stability function at z = -i w dt:
//   R(z) = [(1 + g z/2)/(1 - g z/2) c1 - c2]/(1 - c3 z),   g = 2 - sqrt(2), c1 = 1/(g (2 - g)), c2 = c1 - 1, c3 = (1 - g)/(2 - g).
//
// The mean of the path of a linear spring is the mean of its end forces, so that path averaging is the trapezoid of single_spring.h there.
#pragma once

#include <array>
#include <complex>

namespace openclose::analytical {

/// Row-major 3 x 3, acts on (u [m], v [m/s], a [m/s2]). rho_inf in [0, 1]; frequency w [rad/s], dt [s] > 0.
std::array<std::array<double, 3>, 3> generalized_alpha_matrix(double rho_inf, double frequency, double dt);

/// phase = w dt > 0.
std::complex<double> tr_bdf2_factor(double phase);

}  // namespace openclose::analytical
