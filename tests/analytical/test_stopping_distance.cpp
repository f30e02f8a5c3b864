#include <cmath>
#include <stdexcept>

#include "blocks.h"
#include "openclose/analytical/stopping_distance.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("stopping distance: values of case B4") {
  BlockOnPlane level;
  level.slope_angle = 0;
  level.friction_angle = std::atan(0.5);
  CHECK(std::abs(stopping(level, 5, 1).time - 1.019368) < 5e-7);
  CHECK(std::abs(stopping(level, 5, 1).distance - 2.548420) < 5e-7);
  CHECK(std::abs(stopping(block_on(20, 30), 5, -1).distance - 1.440515) < 5e-7);
  CHECK(std::abs(stopping(block_on(20, 30), 5, 1).distance - 6.354793) < 5e-7);
}

TEST_CASE("stopping distance: mean speed is half, friction eats the energy") {
  for (const int direction : {1, -1}) {
    const BlockOnPlane block = block_on(15, 28);
    const Stop stop = stopping(block, 3.0, direction);
    CHECK(std::abs(stop.distance / stop.time - 1.5) < 1e-14);
    const double work =
        block.friction() * block.normal_weight() * stop.distance - direction * block.weight() * std::sin(block.slope_angle) * stop.distance;
    CHECK(std::abs(work / (block.mass() * 4.5) - 1) < 1e-13);
  }
}

TEST_CASE("stopping distance: directions agree on a level plane; steep planes do not stop") {
  CHECK(stopping(block_on(0, 30), 5, 1).distance == stopping(block_on(0, 30), 5, -1).distance);
  CHECK_THROWS_AS(stopping(block_on(30, 20), 5, 1), std::domain_error);
  CHECK(stopping(block_on(30, 20), 5, -1).distance > 1.0);
}

TEST_CASE("stopping distance: rebound starts at rest at the stop with the springs at their bound") {
  BlockOnPlane block = block_on(0, 25);
  block.shear_stiffness = 3e6;
  const Rebound rebound = rebound_after_stop(block, 4.0);
  CHECK(std::abs(rebound.centre + rebound.amplitude - stopping(block, 4.0, 1).distance) < 1e-15);
  CHECK(std::abs(2 * block.shear_stiffness * rebound.amplitude / (block.friction() * block.weight()) - 1) < 1e-15);
  CHECK(std::abs(rebound.frequency * rebound.frequency * block.mass() / 6e6 - 1) < 1e-14);
  CHECK_THROWS_AS(rebound_after_stop(block_on(1, 25), 4.0), std::domain_error);
}
