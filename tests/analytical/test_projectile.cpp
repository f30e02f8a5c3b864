#include <cmath>

#include "openclose/analytical/projectile.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("projectile: position of case A1 after 2 s") {
  const auto position = projectile_position({}, 2.0);
  CHECK(std::abs(position[0] - 20.0) < 1e-13 * 20);
  CHECK(std::abs(position[1] - (20 * std::sqrt(3.0) - 2 * 9.81)) < 1e-13 * 15);
  CHECK(std::abs(position[1] - 15.02102) < 5e-6);
}

TEST_CASE("projectile: velocity is the derivative of position, height the work of gravity") {
  const Projectile p{13.0, 0.4, 1.62};
  const double dt = 1e-4;
  const double time = 3.0;
  const auto before = projectile_position(p, time - dt);
  const auto after = projectile_position(p, time + dt);
  const auto velocity = projectile_velocity(p, time);
  for (int i = 0; i < 2; ++i) CHECK(std::abs((after[i] - before[i]) / (2 * dt) - velocity[i]) < 1e-9);
  const double speed_squared = velocity[0] * velocity[0] + velocity[1] * velocity[1];
  CHECK(std::abs(speed_squared / 2 + p.gravity * projectile_position(p, time)[1] - p.speed * p.speed / 2) < 1e-12 * p.speed * p.speed);
}
