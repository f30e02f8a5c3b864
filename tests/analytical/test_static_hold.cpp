#include <cmath>

#include "openclose/analytical/static_hold.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("static hold: corner forces of case B2") {
  const BlockOnPlane block;
  const double weight = block.weight();
  CHECK(std::abs(weight - 52974) < 1e-9);
  CHECK(std::abs(holding_corner_forces(block).lower / weight - 0.55801) < 5e-6);
  CHECK(std::abs(holding_corner_forces(block).upper / weight - 0.30801) < 5e-6);
  CHECK(std::abs(sliding_corner_forces(block).lower / weight - 0.51181) < 5e-6);
  CHECK(std::abs(sliding_corner_forces(block).upper / weight - 0.35421) < 5e-6);
}

TEST_CASE("static hold: moment about the lower corner vanishes") {
  BlockOnPlane block;
  block.width = 1.3;
  block.height = 0.8;
  block.slope_angle = 0.45;
  const double moment = holding_corner_forces(block).upper * block.width + block.weight() * std::sin(block.slope_angle) * block.height / 2 -
                        block.normal_weight() * block.width / 2;
  CHECK(std::abs(moment) < 1e-13 * block.weight());
  CHECK(std::abs(holding_corner_forces(block).upper / block.weight()) > 0.1);
}

TEST_CASE("static hold: holding and sliding agree where the slope is the friction angle; on a level plane the corners share") {
  BlockOnPlane block;
  block.friction_angle = block.slope_angle;
  CHECK(std::abs(holding_corner_forces(block).lower / sliding_corner_forces(block).lower - 1) < 1e-15);
  block.slope_angle = 0;
  CHECK(holding_corner_forces(block).lower == holding_corner_forces(block).upper);
  CHECK(sliding_corner_forces(block).lower > 1.5 * sliding_corner_forces(block).upper);
}

TEST_CASE("static hold: the upper corner lifts where b/h is tan alpha") {
  BlockOnPlane block;
  block.width = block.height * std::tan(block.slope_angle);
  CHECK(std::abs(holding_corner_forces(block).upper) < 1e-13 * block.weight());
  CHECK(std::abs(holding_corner_forces(block).lower / block.normal_weight() - 1) < 1e-13);
}
