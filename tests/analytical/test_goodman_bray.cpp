#include <cmath>

#include "openclose/analytical/goodman_bray.h"
#include "openclose/analytical/limit_analysis.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("Goodman and Bray: limiting friction") {
  const GoodmanBray columns;
  CHECK(std::abs(limiting_friction(columns) - 0.7855442) < 5e-8);
  CHECK(std::abs(std::atan(limiting_friction(columns)) / degree - 38.1512) < 5e-5);
}

TEST_CASE("Goodman and Bray: the heights are those of the blocks") {
  const GoodmanBray columns;
  const RigidBlockAssembly assembly = assembly_of(columns, 1);
  REQUIRE(assembly.blocks.size() == 17u);
  CHECK(columns.height(1) == 4.0);
  CHECK(columns.height(10) == 40.0);
  CHECK(columns.height(16) == 4.0);
  for (int k = 1; k <= 16; ++k) CHECK(std::abs(assembly.blocks[k - 1].area - 10 * columns.height(k)) < 1e-9);
  CHECK(assembly.interfaces.size() == 46u);  // 16 treads, 15 risers of the base, 15 sides between columns
}

// One block more slender than the slope, one that holds it: moments and forces written out.
TEST_CASE("Goodman and Bray: two blocks by hand") {
  GoodmanBray columns;
  columns.count = 2;
  columns.crest = 2;
  columns.rise_to_crest = 12;
  const double f = 0.7, s = std::sin(columns.dip), n = std::cos(columns.dip);
  const double y1 = 11, y2 = 22, w1 = 25e3 * 10 * y1, w2 = 25e3 * 10 * y2;
  const double topples = w2 * (y2 * s - 10 * n) / 2 / (y2 - 12), slides = -w2 * (n * f - s) / (1 - f * f);
  REQUIRE(topples > slides);
  // Block 1 on the point of sliding under P_1 and f P_1: P_0 + resistance f (W cos + f P_1 ...) summed along the base.
  const double normal = w1 * n + f * topples;  // the neighbour drags it down
  const double toe = topples + w1 * s - f * normal;
  // The recursion gives P_0 with the shear f P_0 on the face: P_0 (1 - f^2) balances what is left.
  CHECK(std::abs(toe_force(columns, f) - toe / (1 - f * f)) < 1e-9 * w1);
}

TEST_CASE("Goodman and Bray: limit analysis of the same blocks needs less friction") {
  const GoodmanBray columns;
  const CriticalFriction associated = critical_friction(assembly_of(columns, 1));
  CHECK(associated.found);
  CHECK(std::tan(associated.angle) < limiting_friction(columns));
}
