#include "openclose/analytical/spring_integrators.h"

#include <cmath>

namespace openclose::analytical {

std::array<std::array<double, 3>, 3> generalized_alpha_matrix(double rho_inf, double frequency, double dt) {
  const double am = (2 * rho_inf - 1) / (rho_inf + 1), af = rho_inf / (rho_inf + 1);
  const double g = 0.5 - am + af, b = 0.25 * (1 - am + af) * (1 - am + af), square = frequency * frequency;
  const double d = 1 - am + (1 - af) * b * square * dt * dt;
  const std::array<double, 3> a = {-square / d, -square * (1 - af) * dt / d, -(am + square * (1 - af) * (0.5 - b) * dt * dt) / d};
  std::array<std::array<double, 3>, 3> m{};
  m[0] = {1, dt, (0.5 - b) * dt * dt};
  m[1] = {0, 1, (1 - g) * dt};
  for (int j = 0; j < 3; ++j) {
    m[0][j] += b * dt * dt * a[j];
    m[1][j] += g * dt * a[j];
    m[2][j] = a[j];
  }
  return m;
}

std::complex<double> tr_bdf2_factor(double phase) {
  const std::complex<double> z(0, -phase);
  const double g = 2 - std::sqrt(2.0), c1 = 1 / (g * (2 - g)), c2 = c1 - 1, c3 = (1 - g) / (2 - g);
  return (c1 * (1.0 + 0.5 * g * z) / (1.0 - 0.5 * g * z) - c2) / (1.0 - c3 * z);
}

}  // namespace openclose::analytical
