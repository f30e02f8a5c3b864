#include <cmath>

#include "openclose/analytical/single_spring.h"
#include "openclose/analytical/spring_integrators.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("spring integrators: generalised alpha without dissipation is the trapezoid") {
  const double w = 3.0, dt = 0.2;
  const auto m = generalized_alpha_matrix(1.0, w, dt);
  const auto trapezoid = amplification_matrix({0.5, w, dt});
  for (int i = 0; i < 2; ++i) {
    // Starting from a = -w^2 u; am = af = 1/2 keeps the balance of forces at the ends of the step.
    CHECK(std::abs(m[i][0] - w * w * m[i][2] - trapezoid[i][0]) < 1e-14);
    CHECK(std::abs(m[i][1] - trapezoid[i][1]) < 1e-14);
  }
}

TEST_CASE("spring integrators: generalised alpha satisfies its equations") {
  for (const double rho : {0.0, 0.5, 0.9}) {
    const double w = 2.0, dt = 0.3, am = (2 * rho - 1) / (rho + 1), af = rho / (rho + 1);
    const auto m = generalized_alpha_matrix(rho, w, dt);
    const double x[3] = {0.7, -0.4, 0.2};
    double y[3] = {};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) y[i] += m[i][j] * x[j];
    }
    CHECK(std::abs((1 - am) * y[2] + am * x[2] + w * w * ((1 - af) * y[0] + af * x[0])) < 1e-14);
    const double g = 0.5 - am + af, b = (1 - am + af) * (1 - am + af) / 4;
    CHECK(std::abs(y[1] - (x[1] + dt * ((1 - g) * x[2] + g * y[2]))) < 1e-14);
    CHECK(std::abs(y[0] - (x[0] + dt * x[1] + dt * dt * ((0.5 - b) * x[2] + b * y[2]))) < 1e-14);
  }
}

TEST_CASE("spring integrators: TR-BDF2 is of second order and forgets what is infinitely fast") {
  const auto error = [](double phase) { return std::abs(tr_bdf2_factor(phase) - std::polar(1.0, -phase)); };
  CHECK(std::log2(error(0.02) / error(0.01)) == Approx(3.0).margin(0.02));
  CHECK(std::abs(tr_bdf2_factor(1e8)) < 1e-7);
  CHECK(std::abs(tr_bdf2_factor(1.0)) < 1.0);
}
