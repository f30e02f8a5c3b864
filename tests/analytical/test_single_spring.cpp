#include <algorithm>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <stdexcept>

#include "openclose/analytical/single_spring.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

// The scheme itself, solved by fixed-point iteration instead of elimination.
std::array<double, 2> stepped(const SpringStep& step, double u0, double v0) {
  const double k = step.frequency * step.frequency;
  double v1 = v0;
  double u1 = u0;
  for (int i = 0; i < 500; ++i) {
    u1 = u0 + step.dt * (v0 + v1) / 2;
    v1 = v0 - step.dt * k * (step.theta * u1 + (1 - step.theta) * u0);
  }
  return {u1, v1};
}

}  // namespace

TEST_CASE("single spring: columns of the matrix are steps of the scheme") {
  for (const double theta : {0.5, 0.6, 0.85, 1.0}) {
    const SpringStep step{theta, 3.0, 0.2};
    const auto a = amplification_matrix(step);
    const auto first = stepped(step, 1, 0);
    const auto second = stepped(step, 0, 1);
    for (int i = 0; i < 2; ++i) {
      CHECK(std::abs(a[i][0] - first[i]) < 1e-14);
      CHECK(std::abs(a[i][1] - second[i]) < 1e-14);
    }
  }
}

TEST_CASE("single spring: theta = 1 is Newmark (1/2, 1), theta = 1/2 the trapezoid") {
  const double w = 7.0;
  const double dt = 0.11;
  const double square = w * dt * w * dt;
  const auto newmark = amplification_matrix({1.0, w, dt});
  const double d = 1 + square / 2;
  CHECK(std::abs(newmark[0][0] - 1 / d) < 1e-15);
  CHECK(std::abs(newmark[0][1] - dt / d) < 1e-15);
  CHECK(std::abs(newmark[1][0] + w * w * dt / d) < 1e-14);
  CHECK(std::abs(newmark[1][1] - (1 - square / 2) / d) < 1e-15);
  const auto trapezoid = amplification_matrix({0.5, w, dt});
  CHECK(std::abs(trapezoid[0][0] - (1 - square / 4) / (1 + square / 4)) < 1e-15);
  CHECK(trapezoid[0][0] == trapezoid[1][1]);
}

TEST_CASE("single spring: values of case D1") {
  CHECK(std::abs(spectral_radius({1.0, 1.0, 0.5}) - 0.942809) < 5e-7);
  CHECK(std::abs(period_ratio({1.0, 1.0, 0.5}) - 1.02734) < 5e-6);
  CHECK(std::abs(spectral_radius({1.0, 1.0, 1.0}) - 0.816497) < 5e-7);
  CHECK(std::abs(period_ratio({1.0, 1.0, 1.0}) - 1.09681) < 5e-6);
  CHECK(bifurcation_phase(1.0) == 4.0);
}

TEST_CASE("single spring: radius and period against the roots of the characteristic polynomial") {
  for (const double theta : {0.5, 0.7, 1.0}) {
    for (const double dt : {0.01, 0.9, 3.9, 4.1, 9.0, 30.0}) {
      const SpringStep step{theta, 1.0, dt};
      const auto a = amplification_matrix(step);
      const std::complex<double> half_trace = (a[0][0] + a[1][1]) / 2;
      const std::complex<double> root = std::sqrt(half_trace * half_trace - (a[0][0] * a[1][1] - a[0][1] * a[1][0]));
      const double radius = std::max(std::abs(half_trace + root), std::abs(half_trace - root));
      CHECK(std::abs(spectral_radius(step) - radius) < 1e-12);
      if (dt >= bifurcation_phase(theta)) {
        CHECK(std::abs(root.imag()) < 1e-12);
        CHECK_THROWS_AS(period_ratio(step), std::domain_error);
      } else {
        CHECK(std::abs(root.imag()) > 1e-3);
        CHECK(std::abs(period_ratio(step) - dt / std::abs(std::arg(half_trace + root))) < 1e-10);
      }
    }
  }
}

TEST_CASE("single spring: limits in the step") {
  for (const double dt : {0.1, 1.0, 50.0}) CHECK(std::abs(spectral_radius({0.5, 1.0, dt}) - 1) < 1e-14);
  CHECK(std::abs(spectral_radius({1.0, 1.0, 2.0}) - 1 / std::sqrt(3.0)) < 1e-15);
  // damping per step W^2/4 (2 theta - 1), period error of second order
  for (const double theta : {0.6, 1.0}) {
    const double w = 1e-3;
    CHECK(std::abs((1 - spectral_radius({theta, 1.0, w})) / (w * w * (2 * theta - 1) / 4) - 1) < 1e-5);
  }
  const double ratio = (period_ratio({0.5, 1.0, 0.2}) - 1) / (period_ratio({0.5, 1.0, 0.1}) - 1);
  CHECK(std::abs(ratio - 4) < 0.02);
}

TEST_CASE("free vibration turns round after half a period", "[analytical]") {
  CHECK(free_vibration(4.0, 0.0) == 1.0);
  CHECK(free_vibration(4.0, 0.25 * 3.14159265358979323846) == Approx(-1.0));
  CHECK(free_vibration(3.0, 0.2) == Approx(1.0 - 0.36 / 2.0 + 0.1296 / 24.0 - 0.046656 / 720.0).epsilon(1e-6));
}

TEST_CASE("damped vibration: against steps of the fourth order", "[analytical]") {
  for (const double ratio : {0.0, 0.1, 0.7, 1.0, 1.5, 4.0}) {
    const double w = 3.0, end = 2.0;
    const int n = 4000;
    const double h = end / n;
    const auto acceleration = [&](double u, double v) { return -2.0 * ratio * w * v - w * w * u; };
    double u = 0.0, v = 1.0;
    for (int i = 0; i < n; ++i) {
      const double u1 = v, v1 = acceleration(u, v);
      const double u2 = v + 0.5 * h * v1, v2 = acceleration(u + 0.5 * h * u1, v + 0.5 * h * v1);
      const double u3 = v + 0.5 * h * v2, v3 = acceleration(u + 0.5 * h * u2, v + 0.5 * h * v2);
      const double u4 = v + h * v3, v4 = acceleration(u + h * u3, v + h * v3);
      u += h / 6.0 * (u1 + 2.0 * u2 + 2.0 * u3 + u4);
      v += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    }
    // Of the fastest exponent, 24/s, a step of 0.5 ms leaves (24 h)^4 / 120 of each value.
    CHECK(std::abs(damped_vibration(w, ratio, end) - u) < std::pow(8.0 * w * h, 4) / 120.0);
  }
}

TEST_CASE("damped vibration: logarithmic decrement", "[analytical]") {
  const double ratio = 0.2, w = 5.0, period = 2.0 * 3.14159265358979323846 / (w * std::sqrt(1.0 - ratio * ratio));
  const double decrement = std::log(damped_vibration(w, ratio, 0.1) / damped_vibration(w, ratio, 0.1 + period));
  CHECK(decrement == Approx(2.0 * 3.14159265358979323846 * ratio / std::sqrt(1.0 - ratio * ratio)).epsilon(1e-12));
}
