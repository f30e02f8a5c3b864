#include <cmath>

#include "openclose/analytical/linear_rotation.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("linear rotation: area ratio of case A3") {
  CHECK(std::abs(linear_rotation_area_ratio(10, 0.01, 100) - 2.7048) < 5e-5);
}

TEST_CASE("linear rotation: a square turned step by step") {
  const double omega = -3.0;
  const double dt = 0.07;
  const int steps = 9;
  double x = 1;
  double y = 0;
  for (int i = 0; i < steps; ++i) {
    const double d = omega * dt;
    const double turned = x - d * y;
    y = y + d * x;
    x = turned;
  }
  CHECK(std::abs((x * x + y * y) / linear_rotation_area_ratio(omega, dt, steps) - 1) < 1e-13);
  CHECK(std::abs(std::atan2(y, x) - steps * linear_rotation_angle(omega, dt)) < 1e-13);
}

TEST_CASE("linear rotation: no growth without steps; exp(omega^2 dt T) for small steps") {
  CHECK(linear_rotation_area_ratio(10, 0.01, 0) == 1.0);
  const double dt = 1e-6;
  CHECK(std::abs(std::log(linear_rotation_area_ratio(10, dt, 1000000)) / (100 * dt) - 1) < 1e-9);
}
