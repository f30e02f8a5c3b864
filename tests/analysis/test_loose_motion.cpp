// Which blocks move, how, and what would hold them, in words.
#include <Eigen/Geometry>

#include "openclose/analysis/loose_blocks.h"
#include "openclose/analysis/loose_motion.h"
#include "openclose/analysis/run.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/scene/reader.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A fixed base and what stands on it.
Scene scene_with(const std::string& base, const std::string& rest, const std::string& friction_deg = "30") {
  return scene_of_text(
      "[[material]]\nname = 'rock'\ndensity_kg_per_m3 = 2700\n"
      "[[joint]]\nmaterials = ['rock', 'rock']\nnormal_stiffness_pa_per_m = 1e9\nshear_stiffness_pa_per_m = 1e9\nfriction_angle_deg = " +
          friction_deg + "\n[[block]]\nname = 'base'\nmaterial = 'rock'\nfixed = true\nvertices_m = " + base +
          "\n[[block]]\nname = 'top'\nmaterial = 'rock'\n" + rest + "\n[step]\ndt_s = 0.01\n[end]\ntime_s = 0.1\n",
      "scene.toml");
}

const std::string floor_m = "[[-5, -1], [5, -1], [5, 0], [-5, 0]]";

std::string reason_of_run(const Scene& scene) {
  Simulation simulation(scene);
  const RunResult result = prepare_start(simulation);
  CHECK_FALSE(result.converged);
  return result.reason;
}

std::string reason_of_fos(const Scene& scene) {
  Simulation simulation(scene);
  const FactorOfSafety safety = factor_of_safety(simulation);
  CHECK_FALSE(safety.found());
  return safety.reason;
}

void check_both(const Scene& scene, const std::string& words) {
  CHECK_THAT(reason_of_run(scene), ContainsSubstring(words));
  CHECK_THAT(reason_of_fos(scene), ContainsSubstring(words));
}

}  // namespace

TEST_CASE("a block in the air is named", "[analysis][loose_motion]") {
  check_both(scene_with(floor_m, "vertices_m = [[6, 5], [7, 5], [7, 6], [6, 6]]"), "\"top\" touches no other block and moves down");
}

TEST_CASE("blocks that stand beside each other do not slide along their upper and lower sides", "[analysis][loose_motion]") {
  const Scene scene = scene_with(floor_m,
                                 "vertices_m = [[0, 5], [1, 5], [1, 6], [0, 6]]\n[[block]]\nname = 'next'\nmaterial = 'rock'\n"
                                 "vertices_m = [[1, 5], [2, 5], [2, 6], [1, 6]]");
  CHECK_THAT(loose_blocks_in_words(scene), !ContainsSubstring("slides"));
  check_both(scene, "moves down");
}

TEST_CASE("a block that slides is named with its joint, and the friction that would hold it", "[analysis][loose_motion]") {
  const Scene scene = scene_with("[[-5, -1], [5, -5], [5, -2], [-5, 2]]", "vertices_m = [[-1, 0.4], [1, -0.4], [1, 1], [-1, 1]]", "0");
  check_both(scene, "\"top\" slides along its joint with \"base\" towards (0.93, -0.37) (friction above 21.8 degrees");  // tan 21.8 = 0.4
}

TEST_CASE("a block that turns is named with the corner about which it does", "[analysis][loose_motion]") {
  const Scene scene = scene_with("[[-5, -1], [5, -1], [5, 0], [-5, 0]]", "vertices_m = [[5, 0], [5, 1], [2, 1], [4.9, 0]]", "60");
  CHECK_THAT(reason_of_fos(scene), ContainsSubstring("\"top\" turns about its corner at (4.9, 0)"));
}

TEST_CASE("a block that tips over the end of another one turns about its corner", "[analysis][loose_motion]") {
  const Scene scene = scene_with(floor_m, "vertices_m = [[4, 0], [7, 0], [7, 1], [4, 1]]");
  CHECK_THAT(reason_of_fos(scene), ContainsSubstring("\"top\" turns about the corner of \"base\" at (5, 0)"));
}

TEST_CASE("a block hung at a point turns about it", "[analysis][loose_motion]") {
  const Scene scene =
      scene_with(floor_m, "vertices_m = [[0, 4], [2, 4], [2, 5], [0, 5]]\n[[support]]\npoint_m = [0.5, 4.5]\nstiffness_n_per_m = [1e8, 1e8]");
  check_both(scene, "\"top\" turns about its support at (0.5, 4.5)");
}

TEST_CASE("a turn about no corner is told with its centre", "[analysis][loose_motion]") {
  const Scene scene = scene_with(floor_m, "vertices_m = [[0, 4], [2, 4], [2, 5], [0, 5]]");
  const FailingBlock spinning{.block = 1, .area = 2.0, .centroid = {1.0, 4.5}, .velocity = {0.0, 0.5}, .rotation = 1.0};
  CHECK_THAT(motion_in_words(scene, {spinning}), ContainsSubstring("\"top\" turns about (0.5, 4.5)"));  // v + w x (p - c) = 0
}

TEST_CASE("what slides along a joint with a name is told so, though the mechanism opens it by the friction of the name", "[analysis][loose_motion]") {
  Scene scene = scene_with("[[-5, -1], [5, -5], [5, -2], [-5, 2]]", "vertices_m = [[-1, 0.4], [1, -0.4], [1, 1], [-1, 1]]", "60");
  JointProperties bedding = scene.joints[0];
  bedding.name = "bedding";
  bedding.materials = {JointProperties::no_material, JointProperties::no_material};
  bedding.friction_angle = 15.0 * openclose::test::degree;
  scene.joints.push_back(bedding);
  constexpr int none = BlockInput::by_materials;
  scene.blocks[0].edge_joints = {none, none, 1, none};
  scene.blocks[1].edge_joints = {1, none, none, none};
  CHECK_THAT(loose_blocks_in_words(scene), ContainsSubstring("\"top\" slides along its joint with \"base\" towards (0.93, -0.37)"));
}

TEST_CASE("what turns against a neighbour that moves, too, does not slide along it", "[analysis][loose_motion]") {
  Scene scene = scene_with(floor_m, "vertices_m = [[0, 1], [1, 1], [1, 2], [0, 2]]");
  scene.blocks.push_back(scene.blocks[1]);
  scene.blocks[2].name = "middle";
  for (Vec2& v : scene.blocks[2].vertices) v.y() -= 1.0;
  const FailingBlock middle{.block = 2, .area = 1.0, .centroid = {0.5, 0.5}, .velocity = {0.5, 0.0}};
  // It has the velocity of the middle one at the corner (0, 1), about which it turns against it.
  const FailingBlock top{.block = 1, .area = 1.0, .centroid = {0.5, 1.5}, .velocity = {0.7, -0.2}, .rotation = -0.4};
  const std::string words = motion_in_words(scene, {middle, top});
  CHECK_THAT(words, ContainsSubstring("\"top\" turns against \"middle\" about (0, 1)"));
  CHECK_THAT(words, ContainsSubstring("\"middle\" slides along its joint with \"base\" towards (1.00, 0.00) (cohesion_pa"));
}

TEST_CASE("what rides on a block that slides moves with it", "[analysis][loose_motion]") {
  // On a slope of 21.8 degrees with friction of 15; the blocks' own joint has 40.
  Scene scene = scene_with("[[-5, -1], [5, -5], [5, -2], [-5, 2]]", "vertices_m = [[-1, 1.4], [1, 0.6], [1, 2], [-1, 2]]", "40");
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].name = "clay";
  scene.joints.push_back(scene.joints[0]);
  scene.joints[1].materials = {0, 1};
  scene.joints[1].friction_angle = 15.0 * openclose::test::degree;
  scene.blocks[0].material = 1;
  BlockInput middle = scene.blocks[1];
  middle.name = "middle";
  middle.vertices = {{-2.0, 0.8}, {2.0, -0.8}, {2.0, 0.2}, {-2.0, 1.8}};
  scene.blocks.push_back(middle);
  const std::string words = loose_blocks_in_words(scene);
  CHECK_THAT(words, ContainsSubstring("drawn: \"middle\" slides along its joint with \"base\" towards (0.93, -0.37)"));
  CHECK_THAT(words, ContainsSubstring("; \"top\" moves with \"middle\" (what holds \"middle\" would hold it)"));
}

TEST_CASE("a block that a faster one overtakes slides along what carries it, not backwards along the faster one", "[analysis][loose_motion]") {
  Scene scene = scene_with(floor_m, "vertices_m = [[-1, 1], [1, 1], [1, 2], [-1, 2]]");
  BlockInput lower = scene.blocks[1];
  lower.name = "lower";
  lower.vertices = {{-2.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {-2.0, 1.0}};
  scene.blocks.push_back(lower);
  std::ranges::reverse(scene.blocks);
  std::swap(scene.blocks[0], scene.blocks[1]);  // the faster one is met first
  const std::vector<FailingBlock> mechanism = {{0, 2.0, {0.0, 1.5}, {2.0, 0.0}, 0.0}, {1, 4.0, {0.0, 0.5}, {1.0, 0.0}, 0.0}};
  const std::string words = motion_in_words(scene, mechanism);
  CHECK_THAT(words, ContainsSubstring("\"lower\" slides along its joint with \"base\" towards (1.00, 0.00)"));
  CHECK_THAT(words, ContainsSubstring("\"top\" slides along its joint with \"lower\" towards (1.00, 0.00)"));
  CHECK_THAT(words, !ContainsSubstring("-1.00"));
}

TEST_CASE("a column that turns as one body is told by the block at whose corner it turns", "[analysis][loose_motion]") {
  Scene scene = scene_with(floor_m, "vertices_m = [[4.6, 2], [5.6, 2], [5.6, 3], [4.6, 3]]", "60");
  for (const double y : {0.0, 1.0}) {
    BlockInput block = scene.blocks[1];
    block.name = y == 0.0 ? "foot" : "middle";
    for (Vec2& v : block.vertices) v.y() += y - 2.0;
    scene.blocks.push_back(block);
  }
  std::vector<FailingBlock> mechanism;
  for (const int b : {1, 3, 2}) {
    const Vec2 centroid(5.1, b == 1 ? 2.5 : b == 2 ? 0.5 : 1.5), corner(5.0, 0.0);
    mechanism.push_back({.block = b, .area = 1.0, .centroid = centroid, .velocity = -0.3 * perpendicular(centroid - corner), .rotation = -0.3});
  }
  const std::string words = motion_in_words(scene, mechanism);
  CHECK_THAT(words, ContainsSubstring("\"foot\" turns about the corner of \"base\" at (5, 0)"));
  CHECK_THAT(words, ContainsSubstring("\"top\" moves with \"foot\""));
  CHECK_THAT(words, ContainsSubstring("\"middle\" moves with \"foot\""));
}

TEST_CASE("the centre of a turn is that of blocks that slide without parting their joint", "[analysis][loose_motion]") {
  // Two legs that lean on each other: their feet slide level, their heads fall, so that the left one turns about a point above its inner foot and
  // beside its head. Limit analysis lifts the feet by the friction of 5 degrees.
  Scene scene = scene_with(floor_m, "vertices_m = [[-2, 0], [-1.7, 0], [0, 3], [0, 3.5]]", "5");
  BlockInput right = scene.blocks[1];
  right.name = "right";
  right.vertices = {{1.7, 0.0}, {2.0, 0.0}, {0.0, 3.5}, {0.0, 3.0}};
  scene.blocks.push_back(right);
  CHECK_THAT(loose_blocks_in_words(scene), ContainsSubstring("\"top\" turns about (-1.7, 3.5)"));
}

TEST_CASE("what moves along a gravity that does not point down is not said to move down", "[analysis][loose_motion]") {
  Scene scene = scene_with(floor_m, "vertices_m = [[6, 5], [7, 5], [7, 6], [6, 6]]");
  scene.gravity = {0.0, 9.81};
  CHECK_THAT(loose_blocks_in_words(scene), ContainsSubstring("\"top\" touches no other block and moves towards (0.00, 1.00)"));
  scene.gravity = {9.81, 0.0};
  CHECK_THAT(loose_blocks_in_words(scene), ContainsSubstring("moves towards (1.00, 0.00)"));
  scene.gravity = {0.3, 0.0};  // of an asteroid
  CHECK_THAT(loose_blocks_in_words(scene), ContainsSubstring("moves towards (1.00, 0.00)"));
}

TEST_CASE("friction is no remedy where the joint has more already", "[analysis][loose_motion]") {
  const std::string slope = "[[-5, -1], [5, -5], [5, -2], [-5, 2]]", block = "vertices_m = [[-1, 0.4], [1, -0.4], [1, 1], [-1, 1]]";
  const FailingBlock sliding{.block = 1, .area = 2.0, .centroid = {0.0, 0.5}, .velocity = {0.93, -0.37}};
  CHECK_THAT(motion_in_words(scene_with(slope, block, "20"), {sliding}), ContainsSubstring("friction above 21.8 degrees"));
  CHECK_THAT(motion_in_words(scene_with(slope, block, "30"), {sliding}), !ContainsSubstring("friction"));
}

TEST_CASE("of many blocks three are named and the others counted", "[analysis][loose_motion]") {
  Scene scene = scene_with(floor_m, "vertices_m = [[6, 0], [7, 0], [7, 1], [6, 1]]");
  std::vector<FailingBlock> mechanism;
  for (int i = 0; i < 5; ++i) {
    BlockInput block = scene.blocks[1];
    block.name = std::string(1, static_cast<char>('p' + i));
    for (Vec2& v : block.vertices) v.y() += 1.0 + i;
    scene.blocks.push_back(block);
    mechanism.push_back({.block = 2 + i, .area = 1.0, .centroid = {6.5, 1.5 + i}, .velocity = {0.0, -1.0}});
  }
  const std::string words = motion_in_words(scene, mechanism);
  CHECK_THAT(words, ContainsSubstring("; 2 more blocks move"));
}

TEST_CASE("a block that has turned far moves as in a steady turn about its centre", "[analysis][loose_motion]") {
  const Scene scene = test::falling_block();
  Simulation simulation(scene);
  const double angle = 80.0 * test::degree;
  const Vec2 arm(3.0, -2.0);  // of the centroid, from the centre of the turn
  const Vec2 way = Eigen::Rotation2D<double>(angle) * arm - arm;
  simulation.change_system().move_to(0, {way.x(), way.y(), angle});
  const std::vector<FailingBlock> moved = moved_blocks(simulation);
  REQUIRE(moved.size() == 1);
  CHECK((moved[0].velocity / moved[0].rotation - Vec2(-arm.y(), arm.x())).norm() < 1e-12);
}

TEST_CASE("what does not stand as it is drawn is known without a run", "[analysis][loose_motion]") {
  const std::string on_floor = "vertices_m = [[-1, 0], [1, 0], [1, 1], [-1, 1]]";
  CHECK(loose_blocks_in_words(scene_with(floor_m, on_floor)).empty());
  CHECK_THAT(loose_blocks_in_words(scene_with(floor_m, "vertices_m = [[6, 5], [7, 5], [7, 6], [6, 6]]")),
             ContainsSubstring("do not stand as they are drawn: \"top\" touches no other block and moves down"));
  // Its centre of gravity is 0.1 m beside its lower corner.
  CHECK_THAT(loose_blocks_in_words(scene_with(floor_m, "vertices_m = [[4, 0], [5, 0], [6.2, 1], [5, 1]]", "60")),
             ContainsSubstring("\"top\" turns about its corner at (5, 0)"));
  const Scene slope = scene_with("[[-5, -1], [5, -5], [5, -2], [-5, 2]]", "vertices_m = [[-1, 0.4], [1, -0.4], [1, 1], [-1, 1]]", "21.7");
  CHECK_THAT(loose_blocks_in_words(slope), ContainsSubstring("\"top\" slides along its joint with \"base\""));
}

TEST_CASE("what stands but is held by nothing is named with its neutral motion", "[analysis][loose_motion]") {
  const std::string on_floor = "vertices_m = [[-1, 0], [1, 0], [1, 1], [-1, 1]]", push = "nothing holds these blocks against a push of 0.0001";
  const std::string on_ice = loose_blocks_in_words(scene_with(floor_m, on_floor, "0"));
  CHECK_THAT(on_ice, ContainsSubstring(push) && ContainsSubstring("\"top\" slides along its joint with \"base\""));
  // Friction of a hundredth of a degree is 1.7 times the push.
  CHECK(loose_blocks_in_words(scene_with(floor_m, on_floor, "0.01")).empty());
  // Hung at its centre of gravity it turns about it.
  const Scene hung = scene_with(floor_m,
                                "vertices_m = [[6, 5], [8, 5], [8, 6], [6, 6]]\n[[support]]\nblock = 'top'\npoint_m = [7, 5.5]\n"
                                "stiffness_n_per_m = [1e8, 1e8]");
  CHECK_THAT(loose_blocks_in_words(hung), ContainsSubstring(push) && ContainsSubstring("\"top\" turns about its support at (7, 5.5)"));
}
