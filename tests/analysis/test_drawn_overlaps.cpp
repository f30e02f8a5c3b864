// Overlaps of the drawing: when they are told, when they are refused, and when they are closures of an earlier result.
#include <cmath>

#include "openclose/analysis/drawn_overlaps.h"
#include "openclose/analysis/equilibrium.h"
#include "openclose/core/error.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::all_methods;
using openclose::test::fixed_block;
using openclose::test::free_block;
using openclose::test::rectangle;

namespace {

/// A block of 2 m x 1 m, drawn so deep [m] into the base.
Scene sunk_block(double depth, double stiffness) {
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v.y() -= depth;
  scene.joints[0].normal_stiffness = stiffness;
  scene.end_time = 1.0;
  return scene;
}

/// A cube of 1 m between walls, drawn so deep [m] into either.
Scene block_in_shaft(double depth) {
  Scene scene = test::scene_with({fixed_block("left", rectangle(-1.0, -30.0, 1.0, 32.0)), fixed_block("right", rectangle(1.0, -30.0, 1.0, 32.0)),
                                  free_block("cube", rectangle(-depth, 0.0, 1.0 + 2.0 * depth, 1.0))});
  scene.joints[0].normal_stiffness = 1e10;
  scene.end_time = 1.0;
  return scene;
}

std::vector<std::string> judge(const Scene& scene, FirstMotion first_motion) {
  Simulation simulation(scene);
  return judge_drawn_overlaps(simulation, first_motion);
}

/// The scene with the blocks where they have come to rest.
Scene drawn_at_rest(const Scene& scene) {
  Simulation simulation(scene);
  REQUIRE(make_equilibrium_search(simulation)->settle_first({}).settled);
  Scene settled = scene;
  const BlockSystem& system = simulation.system();
  for (int b = 0; b < system.block_count(); ++b) {
    const BlockSystem::Block& block = system.block(b);
    settled.blocks[b].vertices.clear();
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v)
      settled.blocks[b].vertices.push_back(system.origin() + system.centroid(b) + system.arm(v));
  }
  return settled;
}

}  // namespace

TEST_CASE("an overlap that can throw a block is refused where it moves at once, and says with what", "[analysis][drawn_overlaps]") {
  // 1e11 Pa/m over 2 m: 1.8e8 N are 3,670 times the weight of 5000 kg, and 8.1e4 J lift it by 1.65 m, 1.2 of the root of its area.
  const Scene scene = sunk_block(9e-4, 1e11);
  for (const std::string method : {"soft", "dem"}) {
    INFO(method);
    Scene with = scene;
    with.method.contact = method;
    CHECK_THROWS_WITH(judge(with, FirstMotion::at_once),
                      ContainsSubstring("\"block\" is drawn 0.0009 m into \"base\"") && ContainsSubstring("1.8e+08 N, 3.7e+03 times its weight") &&
                          ContainsSubstring("move it by 1.2 of its size") && ContainsSubstring("method.start = \"settled\""));
    CHECK(judge(with, FirstMotion::settling).empty());
  }
}

TEST_CASE("an overlap that moves a block by a little is told, one that nobody sees is not", "[analysis][drawn_overlaps]") {
  // k L d^2 / 2 are 144 J over a length of 2 m, which lift 49.05 kN by 2.9 mm, 0.21 % of the root of 2 m2.
  const std::vector<std::string> warnings = judge(sunk_block(1.2e-4, 1e10), FirstMotion::at_once);
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], ContainsSubstring("0.0021 of its size") && ContainsSubstring("a remedy: blocks that touch"));
  CHECK_THAT(warnings[0], !ContainsSubstring("the worst of"));
  // Another one on the same base, not so deep: the warning is of the deeper one.
  Scene two = sunk_block(1.2e-4, 1e10);
  two.blocks.push_back(two.blocks[1]);
  two.blocks[2].name = "other";
  for (Vec2& v : two.blocks[2].vertices) v += Vec2(3.0, 2e-5);
  const std::vector<std::string> of_two = judge(two, FirstMotion::at_once);
  REQUIRE(of_two.size() == 1);
  CHECK_THAT(of_two[0], ContainsSubstring("0.0021 of its size") && ContainsSubstring("(the worst of 2 such blocks)"));
  CHECK(judge(sunk_block(1e-6, 1e10), FirstMotion::at_once).empty());
  Scene rigid = sunk_block(1e-5, 1e10);
  rigid.method.contact = "hard";
  rigid.method.gap_tolerance = 3e-7;
  const std::vector<std::string> of_rigid = judge(rigid, FirstMotion::at_once);
  REQUIRE(of_rigid.size() == 1);
  CHECK_THAT(of_rigid[0], ContainsSubstring("rigid contacts push it out"));
}

TEST_CASE("overlaps on opposite sides clamp a block", "[analysis][drawn_overlaps]") {
  for (const FirstMotion first_motion : {FirstMotion::settling, FirstMotion::at_once}) {
    // 1e6 N from either side on 2500 kg.
    CHECK_THROWS_WITH(judge(block_in_shaft(1e-4), first_motion),
                      ContainsSubstring("clamps it with 1e+06 N, 41 times its weight") && ContainsSubstring("accepted: blocks that touch"));
    const std::vector<std::string> warnings = judge(block_in_shaft(1e-7), first_motion);
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], ContainsSubstring("clamps it with 1e+03 N, 0.041 times its weight"));
    CHECK(judge(block_in_shaft(1e-9), first_motion).empty());
  }
  Scene smooth = block_in_shaft(1e-4);
  smooth.joints[0].friction_angle = 0.0;
  CHECK(judge(smooth, FirstMotion::at_once).empty());  // it falls as if nothing pressed it
  Scene rigid = block_in_shaft(1e-7);
  rigid.method.contact = "hard";
  CHECK_THROWS_WITH(judge(rigid, FirstMotion::at_once), ContainsSubstring("between rigid contacts it has no room"));
  rigid.joints[0].friction_angle = 0.0;
  CHECK(judge(rigid, FirstMotion::at_once).empty());
}

TEST_CASE("closures of an earlier result at rest are none of the drawing", "[analysis][drawn_overlaps]") {
  Scene column = test::column_of_blocks(12);
  column.joints[0].normal_stiffness = 1e9;
  column.method.contact = "soft";
  const Scene settled = drawn_at_rest(column);
  CHECK(settled.blocks[1].vertices[0].y() < -1e-4);
  for (const FirstMotion first_motion : {FirstMotion::settling, FirstMotion::at_once}) CHECK(judge(settled, first_motion).empty());
}
