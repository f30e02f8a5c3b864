#include <cmath>

#include "blocks.h"
#include "openclose/analytical/cohesion_threshold.h"
#include "openclose/analytical/static_hold.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

// Plays the slow loading through: corners share the pull until one slips and falls back to friction; the other then carries the rest.
bool brittle_contact_holds(const BlockOnPlane& block, double cohesion) {
  const CornerForces normal = holding_corner_forces(block);
  const double bond = cohesion * block.width / 2;
  const double pull = block.weight() * std::sin(block.slope_angle);
  const double mu = block.friction();
  const bool upper_holds = pull / 2 <= bond + mu * normal.upper;
  const bool lower_holds = pull / 2 <= bond + mu * normal.lower;
  if (upper_holds && lower_holds) return true;
  const double upper = upper_holds ? bond + mu * normal.upper : mu * normal.upper;
  const double lower = lower_holds ? bond + mu * normal.lower : mu * normal.lower;
  return pull <= upper + lower;
}

}  // namespace

TEST_CASE("cohesion threshold: values of case B3") {
  const BlockOnPlane block = block_with_friction(20);
  CHECK(std::abs(ductile_cohesion_threshold(block) - 4894.600) < 5e-4);
  CHECK(std::abs(brittle_cohesion_threshold(block) - 7304.7) < 0.05);
}

TEST_CASE("cohesion threshold: ductile cohesion balances the pull") {
  BlockOnPlane block = block_with_friction(12);
  block.width = 3.1;
  const double strength = ductile_cohesion_threshold(block) * block.width + block.friction() * block.normal_weight();
  CHECK(std::abs(strength / (block.weight() * std::sin(block.slope_angle)) - 1) < 1e-14);
}

TEST_CASE("cohesion threshold: brittle cohesion brackets the loading played through, in both of its regimes") {
  for (const double phi : {1.0, 10.0, 20.0, 24.0, 24.3, 27.0, 29.5}) {
    const BlockOnPlane block = block_with_friction(phi);
    const double threshold = brittle_cohesion_threshold(block);
    CHECK(threshold > ductile_cohesion_threshold(block));
    CHECK(brittle_contact_holds(block, threshold * (1 + 1e-9)));
    CHECK_FALSE(brittle_contact_holds(block, threshold * (1 - 1e-9)));
  }
  // above 24.1 degrees the lower corner carries the rest, twice the ductile cohesion on half of the base
  const BlockOnPlane rough = block_with_friction(27);
  CHECK(std::abs(brittle_cohesion_threshold(rough) / ductile_cohesion_threshold(rough) - 2) < 1e-14);
}

TEST_CASE("cohesion threshold: none needed where friction holds") {
  CHECK(ductile_cohesion_threshold(block_with_friction(31)) == 0.0);
  CHECK(brittle_cohesion_threshold(block_with_friction(31)) == 0.0);
  CHECK(ductile_cohesion_threshold(block_with_friction(29.99)) > 0.0);
}
