#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "openclose/analysis/reservations.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/scene/reader.h"
#include "overhanging_bricks.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;
using openclose::test::block_weight;

namespace {

Scene slope_scene(const std::string& method, double slope_deg, double friction_deg, double cohesion) {
  Scene scene = test::block_on_incline(slope_deg * test::degree);
  scene.method.contact = method;
  scene.joints[0].friction_angle = friction_deg * test::degree;
  scene.joints[0].cohesion = cohesion;
  scene.settle.failure_displacement = 0.05;
  scene.strength_reduction.width = 1e-4;
  scene.strength_reduction.definition = FactorDefinition::large_displacements;
  return scene;
}

FactorOfSafety factor(const Scene& scene) {
  Simulation simulation(scene);
  return factor_of_safety(simulation);
}

/// (tan phi cos a W + c L)/(W sin a)
double closed_form(double slope_deg, double friction_deg, double cohesion) {
  const double a = slope_deg * test::degree;
  const double resisting = std::tan(friction_deg * test::degree) * std::cos(a) * block_weight + cohesion * test::block_edge;
  return resisting / (block_weight * std::sin(a));
}

}  // namespace

TEST_CASE("factor of safety of a block on an incline", "[analysis][strength_reduction]") {
  struct Case {
    double slope_deg, friction_deg, cohesion;
  };
  const Case c = GENERATE(values<Case>({{30.0, 40.0, 0.0}, {30.0, 35.0, 5000.0}, {35.0, 20.0, 12000.0}, {45.0, 0.0, 30000.0}}));
  const double exact = closed_form(c.slope_deg, c.friction_deg, c.cohesion);
  for (const std::string& method : all_methods) {
    INFO(method << ", slope " << c.slope_deg << ", friction " << c.friction_deg << ", cohesion " << c.cohesion);
    const auto safety = factor(slope_scene(method, c.slope_deg, c.friction_deg, c.cohesion));
    REQUIRE(safety.found());
    CHECK(safety.reason.empty());
    CHECK(safety.failed() - safety.stable() <= 1e-4);
    CHECK(safety.failed() > safety.stable());
    // Blocks that exceed the strength by less than the tolerated unbalanced force count as stable.
    CHECK(safety.stable() <= exact * (1.0 + 1e-6));
    CHECK(safety.failed() >= exact * (1.0 - 1e-6));
    CHECK_FALSE(safety.bracket.failed_by.empty());
  }
}

TEST_CASE("scenes that fail with their own strength have a factor below 1", "[analysis][strength_reduction]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    const double exact = closed_form(40.0, 30.0, 2000.0);
    REQUIRE(exact < 0.9);
    const auto safety = factor(slope_scene(method, 40.0, 30.0, 2000.0));
    REQUIRE(safety.found());
    CHECK(safety.stable() <= exact * (1.0 + 1e-6));
    CHECK(safety.failed() >= exact * (1.0 - 1e-6));
    CHECK(safety.trials.front().outcome != TrialOutcome::stable);
    CHECK(safety.trials.front().srf == 1.0);
  }
}

TEST_CASE("a scene that no reduction brings down", "[analysis][strength_reduction]") {
  Scene scene = test::block_on_base();
  scene.strength_reduction.upper_limit = 3.0;
  scene.strength_reduction.definition = GENERATE(FactorDefinition::small_displacements, FactorDefinition::large_displacements);
  const auto safety = factor(scene);
  CHECK(safety.verdict == FactorVerdict::no_failure);
  CHECK(safety.reason == "still stable at strength_reduction.upper_limit");
  CHECK(safety.stable() == 3.0);
  CHECK(safety.failed() == 0.0);
  CHECK(safety.trials.back().srf == 3.0);
  for (const StrengthTrial& t : safety.trials) {
    CHECK(t.outcome == TrialOutcome::stable);
    CHECK(t.stage == "bracket");
  }
}

TEST_CASE("a scene that no strength holds", "[analysis][strength_reduction]") {
  Scene scene = test::falling_block();
  scene.strength_reduction.definition = FactorDefinition::large_displacements;
  const auto safety = factor(scene);
  CHECK(safety.verdict == FactorVerdict::no_equilibrium);
  CHECK(safety.reason.find("not stable even at a strength reduction factor of 0.00124") == 0);
  for (const StrengthTrial& t : safety.trials) CHECK(t.outcome != TrialOutcome::stable);
}

TEST_CASE("a block slides at its own factor, however heavy another one is that rests elsewhere", "[analysis][strength_reduction]") {
  const double exact = closed_form(40.0, 30.0, 0.0);
  for (const std::string& method : all_methods) {
    for (const double size : {1e2, 1e4}) {
      CAPTURE(method, size);
      Scene scene = slope_scene(method, 40.0, 30.0, 0.0);
      scene.joints[0] = test::frictional_joint(1e12, 4e11, 30.0 * test::degree);
      scene.blocks.push_back(test::fixed_block("ground", test::rectangle(1e2, -1.0, 2.0 * size, 1.0)));
      scene.blocks.push_back(test::free_block("giant", test::rectangle(1e2 + 0.5 * size, 0.0, size, size)));
      const auto safety = factor(scene);
      // Explicit steps may be too many for the last digit.
      REQUIRE((safety.verdict == FactorVerdict::certified || method == "dem"));
      CHECK(safety.stable() >= exact * (1.0 - 1e-2));
      CHECK(safety.stable() <= exact * (1.0 + 2e-5));
      CHECK(safety.failed() >= exact * (1.0 - 2e-5));
    }
  }
}

TEST_CASE("a seam of the ground ahead of a block's toe does not hold it", "[analysis][strength_reduction]") {
  const double ahead = GENERATE(2e-5, 5e-4, 3e-3);  // [m] of the toe
  const double fall = GENERATE(10.0, 40.0, 80.0) * test::degree;
  const double dip = 25.0 * test::degree, friction = 24.0 * test::degree, depth = 6.0, foot = 4.0 + ahead + depth / std::tan(fall);
  Scene scene = test::scene_with({test::fixed_block("under", {{-20.0, -depth}, {foot, -depth}, {4.0 + ahead, 0.0}, {-20.0, 0.0}}),
                                  test::free_block("block", test::rectangle(0.0, 0.0, 4.0, 3.0)),
                                  test::fixed_block("ahead", {{foot, -depth}, {60.0, -depth}, {60.0, 0.0}, {4.0 + ahead, 0.0}})});
  scene.gravity = {9.81 * std::sin(dip), -9.81 * std::cos(dip)};
  scene.joints[0] = test::frictional_joint(1e10, 4e9, friction);
  for (const std::string& method : all_methods) {
    CAPTURE(ahead, fall, method);
    scene.method.contact = method;
    CHECK(factor(scene).stable() == Approx(std::tan(friction) / std::tan(dip)).epsilon(2e-4));
  }
}

TEST_CASE("cohesion between a block and the ground counts the whole face, however many pieces it has", "[analysis][strength_reduction]") {
  // tan F = (c L + W cos dip tan phi) / (W sin dip), with the face so low that nothing is bent off; and one so high that it is.
  const double height = GENERATE(0.5, 6.0), width = 4.0, dip = 40.0 * test::degree, friction = 30.0 * test::degree;
  std::vector<double> factors;
  for (const bool is_cut : {false, true}) {
    std::vector<BlockInput> blocks{test::free_block("block", test::rectangle(0.0, 0.0, width, height))};
    if (is_cut) {
      blocks.push_back(test::fixed_block("left", {{-20.0, -6.0}, {0.5, -6.0}, {1.5, 0.0}, {-20.0, 0.0}}));
      blocks.push_back(test::fixed_block("middle", {{0.5, -6.0}, {9.0, -6.0}, {3.0, 0.0}, {1.5, 0.0}}));
      blocks.push_back(test::fixed_block("right", {{9.0, -6.0}, {60.0, -6.0}, {60.0, 0.0}, {3.0, 0.0}}));
    } else {
      blocks.push_back(test::fixed_block("ground", {{-20.0, -6.0}, {60.0, -6.0}, {60.0, 0.0}, {-20.0, 0.0}}));
    }
    Scene scene = test::scene_with(blocks);
    scene.gravity = {9.81 * std::sin(dip), -9.81 * std::cos(dip)};
    scene.joints[0] = test::frictional_joint(1e10, 4e9, friction);
    const double weight = 9.81 * scene.materials[0].density * width * height;
    scene.joints[0].cohesion = 0.5 * weight * std::sin(dip) / width;
    scene.joints[0].tensile_strength = height < 1.0 ? 0.0 : 0.9 * weight * std::sin(dip) / width;
    factors.push_back(factor(scene).stable());
    if (height < 1.0) CHECK(factors.back() == Approx(0.5 + std::tan(friction) / std::tan(dip)).epsilon(2e-4));
  }
  CHECK(factors[0] < 5.0);
  CHECK(factors[1] == Approx(factors[0]).epsilon(2e-4));
}

TEST_CASE("cohesion acts where a block touches ground in pieces: at a corner, where they overlap, over a step as low as drawings have",
          "[analysis][strength_reduction]") {
  struct Ground {
    const char* name;
    std::vector<std::vector<Vec2>> pieces;
    double joined;  // [m] of the block's lower side, which reaches from x = 0 to 4
  };
  const double turn = std::tan(3.0 * test::degree), overlap = 5e-5, step = 1e-5;
  const auto ground = GENERATE_COPY(
      Ground{"the face falls away beyond a seam", {{{-20, -6}, {1, -6}, {2.5, 0}, {-20, 0}}, {{1, -6}, {30, -6}, {30, -27.5 * turn}, {2.5, 0}}}, 2.5},
      Ground{"it is whole", {{{-20, -6}, {30, -6}, {30, -27.5 * turn}, {2.5, 0}, {-20, 0}}}, 2.5},
      Ground{"pieces overlap at a seam that leans ahead",
             {{{-20, -6}, {1 + overlap, -6}, {2 + overlap, 0}, {-20, 0}}, {{1, -6}, {30, -6}, {30, 0}, {2, 0}}},
             4},
      Ground{"that leans back", {{{-20, -6}, {3 + overlap, -6}, {2 + overlap, 0}, {-20, 0}}, {{3, -6}, {30, -6}, {30, 0}, {2, 0}}}, 4},
      Ground{"the lower piece is lower", {{{-20, -6}, {2, -6}, {2, 0}, {-20, 0}}, {{2, -6}, {30, -6}, {30, -step}, {2, -step}}}, 4},
      Ground{"the upper piece is lower", {{{-20, -6}, {2, -6}, {2, -step}, {-20, -step}}, {{2, -6}, {30, -6}, {30, 0}, {2, 0}}}, 4});
  CAPTURE(ground.name);
  const double height = 0.5, width = 4.0, dip = 40.0 * test::degree, friction = 30.0 * test::degree;
  // Outlines are followed ahead or back by the numbers of the blocks.
  const bool ground_comes_first = GENERATE(false, true);
  std::vector<BlockInput> blocks;
  for (const auto& piece : ground.pieces) blocks.push_back(test::fixed_block("piece", piece));
  blocks.insert(ground_comes_first ? blocks.end() : blocks.begin(), test::free_block("block", test::rectangle(0.0, 0.0, width, height)));
  Scene scene = test::scene_with(blocks);
  scene.gravity = {9.81 * std::sin(dip), -9.81 * std::cos(dip)};
  scene.joints[0] = test::frictional_joint(1e10, 4e9, friction);
  const double weight = 9.81 * scene.materials[0].density * width * height;
  scene.joints[0].cohesion = 0.5 * weight * std::sin(dip) / width;
  CHECK(factor(scene).stable() == Approx(0.5 * ground.joined / width + std::tan(friction) / std::tan(dip)).epsilon(2e-4));
}

TEST_CASE("a tip that stands on a seam slides on the seam", "[analysis][strength_reduction]") {
  // A wedge on its tip, held upright between two columns that move with it on a smooth seam of rough rock.
  Scene scene = scene_of_text(R"(
    gravity_m_per_s2 = [3, -9]
    [[material]]
    name = "rock"
    density_kg_per_m3 = 2500
    [[joint]]
    materials = ["rock", "rock"]
    normal_stiffness_pa_per_m = 1e10
    shear_stiffness_pa_per_m = 4e9
    friction_angle_deg = 60
    [[joint]]
    name = "seam"
    normal_stiffness_pa_per_m = 1e10
    shear_stiffness_pa_per_m = 4e9
    friction_angle_deg = 20
    [[block]]
    name = "ground"
    material = "rock"
    fixed = true
    vertices_m = [[-9, -1], [9, -1], [9, 0], [-9, 0]]
    edge_joints = ["", "", "seam", ""]
    [[block]]
    name = "left"
    material = "rock"
    vertices_m = [[-2, 0], [0, 0], [-1, 2], [-2, 2]]
    edge_joints = ["seam", "", "", ""]
    [[block]]
    name = "right"
    material = "rock"
    vertices_m = [[0, 0], [2, 0], [2, 2], [1, 2]]
    edge_joints = ["seam", "", "", ""]
    [[block]]
    name = "wedge"
    material = "rock"
    vertices_m = [[0, 0], [1, 2], [-1, 2]]
  )",
                              "seam.toml");
  // No forces on the seam give more than this, whatever those between the blocks are.
  CHECK(factor(scene).stable() <= std::tan(20.0 * test::degree) / (3.0 / 9.0) * 1.001);
}

TEST_CASE("a wedge on a joint of which a part is rock has the factor of Jennings", "[analysis][strength_reduction]") {
  const Scene scene = scene_of_text(R"(
    [[material]]
    name = "rock"
    density_kg_per_m3 = 2600
    [[joint]]
    materials = ["rock", "rock"]
    normal_stiffness_pa_per_m = 1e10
    shear_stiffness_pa_per_m = 2e9
    friction_angle_deg = 30
    [[joint]]
    name = "intact"
    normal_stiffness_pa_per_m = 1e10
    shear_stiffness_pa_per_m = 2e9
    friction_angle_deg = 30
    cohesion_pa = 300e3
    tensile_strength_pa = 150e3
    [domain]
    material = "rock"
    vertices_m = [[-20, -15], [90, -15], [90, 40], [23, 40], [0, 0], [-20, 0]]
    [[joint_set]]
    dip_deg = 35
    spacing_m = 100
    origin_m = [0, 0]
    trace_length_m = 9
    gap_m = 3
    bridge = "intact"
    [[fixed_line]]
    from_m = [-20, -15]
    to_m = [90, -15]
    )",
                                    "bridges.toml");
  const double dip = 35.0 * test::degree, height = 40.0, plane = height / std::sin(dip);
  const double weight = 0.5 * height * (height / std::tan(dip) - 23.0) * 2600.0 * scene.gravity.norm();
  const double rock = 3.0 * std::floor(plane / 12.0) + std::max(0.0, std::fmod(plane, 12.0) - 9.0);  // [m]
  const double exact = (weight * std::cos(dip) * std::tan(30.0 * test::degree) + 300e3 * rock) / (weight * std::sin(dip));
  const auto safety = factor(scene);
  REQUIRE(safety.verdict == FactorVerdict::certified);
  CHECK(safety.stable() == Approx(exact).epsilon(2e-4));
}

TEST_CASE("a motion that nothing decides is not said to fail", "[analysis][strength_reduction]") {
  Scene scene = slope_scene("soft", 30.0, 40.0, 0.0);
  scene.settle.max_steps = 1;
  const auto safety = factor(scene);
  CHECK(safety.verdict == FactorVerdict::undecided);
  CHECK_THAT(safety.reason,
             Catch::Matchers::StartsWith("neither equilibrium nor failure found down to a strength reduction factor of 0.00124 (steps"));
}

TEST_CASE("a joint that is bent beyond what cracks it is warned of at large displacements", "[analysis][strength_reduction]") {
  // A block of 1 m x 2.5 m that stands glued on an incline of 30 degrees: N/L + 6 M/L^2 of the joint is far above its tensile strength.
  Scene scene = slope_scene("soft", 30.0, 35.0, 1e5);
  scene.blocks[1].vertices = test::placed(test::rectangle(0.0, 0.0, 1.0, 2.5), -30.0 * test::degree);
  scene.joints[0].tensile_strength = 30e3;
  const auto warns = [](const FactorOfSafety& safety) {
    return std::ranges::any_of(safety.warnings, [](const std::string& words) { return words.find("joints are bent by up to") != std::string::npos; });
  };
  const auto bent = factor(scene);
  REQUIRE(bent.verdict == FactorVerdict::certified);
  CHECK(warns(bent));
  scene.joints[0].tensile_strength = 3e6;
  CHECK_FALSE(warns(factor(scene)));
}

TEST_CASE("what stands on a point is warned of at large displacements, too", "[analysis][strength_reduction]") {
  Scene scene = test::block_on_base();
  scene.blocks[1].vertices = {{0.0, 0.0}, {1.0, 2.0}, {-1.0, 2.0}};
  scene.strength_reduction.definition = FactorDefinition::large_displacements;
  const auto safety = factor(scene);
  REQUIRE(safety.verdict == FactorVerdict::no_failure);
  CHECK(std::ranges::count_if(safety.warnings, [](const std::string& words) { return words.starts_with("nothing holds these blocks against"); }) ==
        1);
}

TEST_CASE("rigid contacts do not jam a block that nothing jams", "[analysis][strength_reduction]") {
  for (const std::string& method : all_methods) {
    for (const auto definition : {FactorDefinition::small_displacements, FactorDefinition::large_displacements}) {
      INFO(method << ' ' << static_cast<int>(definition));
      Scene scene = test::overhanging_bricks();
      scene.method.contact = method;
      scene.strength_reduction.definition = definition;
      const auto safety = factor(scene);
      CHECK_FALSE(safety.bracket.stable);
    }
  }
}

TEST_CASE("rigid blocks that settle in another place than they are drawn have their balance there", "[analysis][strength_reduction]") {
  Scene scene = slope_scene("hard", 30.0, 40.0, 0.0);
  for (Vec2& v : scene.blocks[1].vertices) v.y() += 0.02;
  const auto safety = factor(scene);
  REQUIRE(safety.verdict == FactorVerdict::certified);
  CHECK(safety.stable() == Approx(closed_form(30.0, 40.0, 0.0)).epsilon(2e-4));
}

TEST_CASE("every trial is on record", "[analysis][strength_reduction]") {
  Scene scene = slope_scene("soft", 30.0, 40.0, 0.0);
  scene.strength_reduction.curve = {1.1, 2.0};
  const auto safety = factor(scene);
  REQUIRE(safety.found());
  const auto& trials = safety.trials;
  CHECK(trials.front().srf == 1.0);
  CHECK(trials.front().stage == "bracket");
  CHECK(trials.front().displacement == 0.0);

  // [m] by which the joint gives way in the first trial, from whose end displacements are counted
  const double normal = block_weight * std::cos(30.0 * test::degree) / (scene.joints[0].normal_stiffness * test::block_edge);
  const double shear = block_weight * std::sin(30.0 * test::degree) / (scene.joints[0].shear_stiffness * test::block_edge);
  double stable = 0.0, failed = 1e9;
  int bisections = 0, curve_points = 0;
  for (const StrengthTrial& t : trials) {
    CHECK(t.steps >= 1);
    CHECK_FALSE(t.criterion.empty());
    CHECK((t.outcome == TrialOutcome::stable) == (t.criterion == "unbalanced force"));
    // The uphill corner may begin to slip while the other holds the block, which goes by a quarter of that until it fails.
    if (t.outcome == TrialOutcome::stable) CHECK(t.displacement < 0.5 * std::hypot(normal, shear));
    if (t.stage == "curve") {
      ++curve_points;
      CHECK((t.outcome == TrialOutcome::stable) == (t.srf < safety.stable()));
      continue;
    }
    bisections += t.stage == "bisect" ? 1 : 0;
    (t.outcome == TrialOutcome::stable ? stable : failed) = t.outcome == TrialOutcome::stable ? std::max(stable, t.srf) : std::min(failed, t.srf);
  }
  CHECK(stable == safety.stable());
  CHECK(failed == safety.failed());
  CHECK(bisections == std::ceil(std::log2((1.25 * 1.25 - 1.25) / 1e-4)));
  CHECK(curve_points == 2);
  CHECK(trials.back().srf == 2.0);
  CHECK(trials.back().displacement > 0.04);
  CHECK(safety.curve.empty());
}

TEST_CASE("the width of the bracket is the one asked for", "[analysis][strength_reduction]") {
  const double width = GENERATE(1e-1, 1e-3, 1e-5);
  Scene scene = slope_scene("soft", 30.0, 40.0, 0.0);
  scene.strength_reduction.width = width;
  const auto safety = factor(scene);
  REQUIRE(safety.found());
  CHECK(safety.failed() - safety.stable() <= width);
  CHECK(safety.failed() - safety.stable() > 0.4 * width);
}

TEST_CASE("cohesion that is lost on slip or opening lowers the factor, never raises it", "[analysis][strength_reduction]") {
  // A tall block tilts uphill-corner open before it slides: the brittle joint loses the bond there.
  Scene scene = test::block_on_incline(30.0 * test::degree);
  scene.blocks[1].vertices = test::placed(test::rectangle(0.0, 0.0, 1.0, 2.2), -30.0 * test::degree);
  scene.joints[0].friction_angle = 25.0 * test::degree;
  scene.joints[0].cohesion = 40000.0;
  scene.joints[0].tensile_strength = 40000.0;
  scene.settle.failure_displacement = 0.05;
  scene.strength_reduction.definition = FactorDefinition::large_displacements;
  const auto ductile = factor(scene);
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  const auto brittle = factor(scene);
  REQUIRE(ductile.found());
  REQUIRE(brittle.found());
  CHECK(brittle.stable() < 0.99 * ductile.stable());
}

TEST_CASE("residual friction lowers the factor, limit analysis keeps the friction of joints that have not slipped",
          "[analysis][strength_reduction]") {
  const std::string method = GENERATE(as<std::string>{}, "soft", "hard", "shi");
  INFO(method);
  Scene scene = test::block_on_incline(30.0 * test::degree);
  scene.joints[0].friction_angle = 45.0 * test::degree;
  scene.method.contact = method;
  const auto peak = factor(scene);
  scene.joints[0].residual_friction_angle = 5.0 * test::degree;
  const auto residual = factor(scene);
  REQUIRE(residual.found());
  // The upper corner slips first and leaves its share to the lower one.
  CHECK(peak.stable() == Approx(1.0 / std::tan(30.0 * test::degree)).epsilon(1e-4));
  CHECK(residual.stable() < 0.8 * peak.stable());
  REQUIRE(residual.limit_analysis.has_value());
  REQUIRE(peak.limit_analysis.has_value());
  // Each is the largest factor with forces in equilibrium, to the width of the search.
  CHECK(residual.limit_analysis->factor.value() == Approx(peak.limit_analysis->factor.value()).margin(2e-5));
}

TEST_CASE("joints of which all have a part of the strength have that part of the factor, though they break on the way",
          "[analysis][strength_reduction]") {
  // A light block bridges two heavy ones, one of which a load lifts: its joints break first, and the others carry on.
  JointProperties weak = builders::frictional_joint(1e10, 1e10, 35.0 * test::degree);
  weak.cohesion = weak.tensile_strength = 5e3;
  weak.cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  weak.residual_friction_angle = 20.0 * test::degree;
  JointProperties strong = weak, stronger = weak;
  strong.cohesion = strong.tensile_strength = 5e4;
  stronger.cohesion = stronger.tensile_strength = 9e4;
  strong.materials = {1, 1};
  stronger.materials = {0, 1};
  Scene scene = builders::rock_scene(2600.0, weak, 1e-6);
  scene.materials.push_back({"light", 200.0});
  scene.blocks = {
      builders::fixed_block("base", test::rectangle(-10.0, -1.0, 20.0, 1.0)), builders::free_block("left", test::rectangle(0.0, 0.0, 1.0, 0.5)),
      builders::free_block("right", test::rectangle(1.0, 0.0, 1.0, 0.5)), builders::free_block("top", test::rectangle(0.5, 0.5, 1.0, 0.5))};
  scene.blocks[3].material = 1;
  scene.loads = {{1, {1.0, 0.5}, {-1000.0, 13000.0}}};
  scene.strength_reduction.width = 1e-3;
  scene.strength_reduction.limit_analysis = false;
  scene.method.contact = GENERATE(as<std::string>{}, "soft", "dem");

  std::vector<double> factors;
  for (const double part : {1.0, 1.0 / 1.1, 1.0 / 4.2, 1.0 / 5.2}) {
    scene.joints = {weak.reduced_by(1.0 / part), stronger.reduced_by(1.0 / part), strong.reduced_by(1.0 / part)};
    const auto safety = factor(scene);
    INFO(scene.method.contact << ", " << part << " of the strength");
    REQUIRE(safety.verdict == FactorVerdict::certified);
    factors.push_back(safety.stable() / part);
  }
  // Each to twice the stride in which joints may break, 0.2 % of it.
  for (const double f : factors) CHECK(f == Approx(factors[0]).epsilon(4e-3));
}

TEST_CASE("a stride of the search over which joints break is taken back and made short", "[analysis][strength_reduction]") {
  // Joints break at 1.5. Over a long stride all at once, which nothing survives or all does; over a short one the blocks stand up to 1.7.
  constexpr double breaks_at = 1.5, fails_at = 1.7;
  class BreakingTrials : public StrengthTrials {
   public:
    explicit BreakingTrials(bool survives) : survives_(survives) {}
    TrialResult first(double srf) override {
      broke_ = srf > breaks_at;
      return at(srf, broke_);
    }
    TrialResult next(double srf, OnBreak on_break) override {
      const bool breaks = !broke_ && srf > breaks_at, is_long = srf - stable_ > 4e-3;
      TrialResult result = at(srf, breaks);
      if (breaks && is_long) result.outcome = survives_ ? TrialOutcome::stable : TrialOutcome::failed;
      if (breaks && on_break == OnBreak::go_back) {
        result.outcome = TrialOutcome::undecided;
        return result;
      }
      if (result.outcome == TrialOutcome::stable) stable_ = srf;
      broke_ = broke_ || breaks;
      return result;
    }

   private:
    TrialResult at(double srf, bool breaks) {
      TrialResult result;
      result.outcome = srf < fails_at ? TrialOutcome::stable : TrialOutcome::failed;
      result.criterion = "told";
      result.broke = breaks;
      if (result.outcome == TrialOutcome::stable) stable_ = srf;
      return result;
    }
    bool survives_;
    double stable_ = 0.0;
    bool broke_ = false;
  };
  BreakingTrials trials(GENERATE(true, false));
  StrengthReductionInput input;
  input.width = 1e-3;
  const StrengthBracket bracket = search_strength(trials, input, [](const StrengthTrial&) {});
  REQUIRE((bracket.stable && bracket.failed));
  CHECK(*bracket.stable == Approx(1.7).margin(1e-3));
  CHECK(*bracket.failed == Approx(1.7).margin(1e-3));
  CHECK(bracket.undecided == 0);
}

TEST_CASE("a factor that rests on one corner is told what it would be without", "[analysis][strength_reduction]") {
  // A wedge on a plane of 35 deg through the toe of a slope, whose tip stands on the level bench; slid off in closed form without it.
  const double dip = 35.0 * test::degree, face = 60.0 * test::degree, height = 30.0, density = 2600.0, cohesion = 2e4, friction = 28.0 * test::degree;
  JointProperties joint = builders::frictional_joint(1e10, 1e10, friction);
  joint.cohesion = cohesion;
  Scene scene = builders::rock_scene(density, joint, 1e-6);
  const double back = height / std::tan(dip), crest = height / std::tan(face);
  scene.blocks = {builders::fixed_block("ground", {{-30.0, -15.0}, {back, -15.0}, {back, height}, {0.0, 0.0}, {-30.0, 0.0}}),
                  builders::free_block("wedge", {{0.0, 0.0}, {back, height}, {crest, height}})};
  const auto safety = factor(scene);
  REQUIRE(safety.verdict == FactorVerdict::certified);
  const double weight = density * 9.81 * 0.5 * height * (back - crest), length = std::hypot(back, height);
  const double sliding = (weight * std::cos(dip) * std::tan(friction) + cohesion * length) / (weight * std::sin(dip));
  CHECK(safety.stable() > 2.0 * sliding);
  const auto told = std::ranges::find_if(safety.warnings, [&](const std::string& w) { return w.find("corner") != std::string::npos; });
  REQUIRE(told != safety.warnings.end());
  INFO(*told << "; slides at " << sliding);
  CHECK(told->find("block wedge, alone on block ground") != std::string::npos);
  CHECK(told->find(fmt::format("at most {:.3f}", sliding)) != std::string::npos);
}

TEST_CASE("cohesion that needs a normal force is named where limit analysis counts all of it", "[analysis][strength_reduction]") {
  // A thin slab on a plane so steep that its weight hardly presses on it: cohesion of ten times the normal force holds it, no more.
  Scene scene = test::block_on_incline(86.0 * test::degree);
  scene.blocks[1].vertices = test::placed(test::rectangle(0.0, 0.0, 10.0, 0.3), -86.0 * test::degree);
  scene.joints[0].cohesion = 2e5;
  const auto safety = factor(scene);
  REQUIRE(safety.verdict == FactorVerdict::certified);
  REQUIRE(safety.limit_analysis.has_value());
  REQUIRE(safety.stable() < 0.5 * *safety.limit_analysis->factor);
  const bool told =
      std::ranges::any_of(safety.warnings, [](const std::string& w) { return w.find("counts the whole cohesion") != std::string::npos; });
  CHECK(told);
}

TEST_CASE("an interval tells how wide it is and from where on it is open", "[analysis][strength_reduction]") {
  StrengthBracket bracket;
  bracket.stable = 0.8;
  std::vector<StrengthTrial> trials(4);
  for (std::size_t i = 0; i < trials.size(); ++i) trials[i].srf = 0.7 + 0.1 * static_cast<double>(i);
  trials[1].outcome = TrialOutcome::stable;
  CHECK_THAT(interval_in_words(bracket, trials), Catch::StartsWith("an interval without an end: at 0.9 "));
  bracket.failed = 1.2;
  CHECK_THAT(interval_in_words(bracket, trials), Catch::StartsWith("an interval, 50 % wide: at 0.9 "));
  // What only broke joints says nothing of the factor.
  trials[2].broke = true;
  trials[2].criterion = by_breaking_joints;
  CHECK_THAT(interval_in_words(bracket, trials), Catch::StartsWith("an interval, 50 % wide: at 1 "));
  trials[3].outcome = TrialOutcome::failed;
  CHECK(interval_in_words(bracket, trials).empty());
}

TEST_CASE("the curve in time: free sliding with the reduced strength", "[analysis][strength_reduction]") {
  Scene scene = slope_scene("soft", 30.0, 40.0, 0.0);
  const double srf = 2.0, time = 0.2;
  scene.strength_reduction.curve = {1.1, srf};
  scene.strength_reduction.curve_time = time;
  scene.measured_points = {{"corner", 1, scene.blocks[1].vertices[2]}, {"foot", 1, scene.blocks[1].vertices[0]}};
  const auto safety = factor(scene);
  REQUIRE(safety.curve.size() == 4);
  CHECK(safety.curve[0].point == "corner");
  CHECK(safety.curve[1].point == "foot");
  CHECK(safety.curve[0].srf == 1.1);
  CHECK(safety.curve[2].srf == srf);
  CHECK(safety.curve[0].displacement < 1e-5);
  const double a = 30.0 * test::degree;
  const double acceleration = 9.81 * (std::sin(a) - std::tan(40.0 * test::degree) / srf * std::cos(a));
  // The shear springs unload at the beginning: some millimetres per 1e8 N/m are W/ks = 0.06 mm.
  CHECK(safety.curve[2].displacement == Approx(0.5 * acceleration * time * time).margin(5e-4));
}

TEST_CASE("settled and failed states are kept", "[analysis][strength_reduction]") {
  Scene scene = slope_scene("soft", 30.0, 40.0, 0.0);
  Simulation simulation(scene);
  const auto safety = factor_of_safety(simulation);
  REQUIRE(safety.found());
  REQUIRE(safety.states.size() == 2);
  CHECK(safety.states[0].name == "settled");
  CHECK(safety.states[1].name == "failed");
  const Vec2 settled = safety.states[0].system.displacement(1).head<2>();
  CHECK(settled.norm() < 1e-3);
  CHECK((safety.states[1].system.displacement(1).head<2>() - settled).dot(test::downhill(30.0 * test::degree)) > 0.04);
}

TEST_CASE("progress of the bisection never falls back", "[analysis][strength_reduction]") {
  Simulation simulation(slope_scene("soft", 30.0, 40.0, 0.0));
  double last = 0.0;
  int calls = 0;
  factor_of_safety(simulation, [&](double fraction) {
    CHECK(fraction >= last);
    CHECK(fraction <= 1.0);
    last = fraction;
    ++calls;
  });
  CHECK(calls > 5);
  CHECK(last > 0.8);
}

TEST_CASE("hard finds the factor of a slope with no more solves than soft", "[analysis][strength_reduction][hard]") {
  const auto behaviour = GENERATE(CohesionBehaviour::ductile, CohesionBehaviour::lost_on_slip);
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4.toml");
  scene.joints[0].cohesion_behaviour = behaviour;
  // As near to failure as makes one trial more on either side.
  scene.strength_reduction.width = 0.02;
  std::vector<FactorOfSafety> found;
  std::vector<long> solves;
  for (const std::string method : {"soft", "hard"}) {
    scene.method.contact = method;
    Simulation simulation(scene);
    found.push_back(factor_of_safety(simulation));
    solves.push_back(simulation.state().counters.iterations);
    if (method == "hard") CHECK(simulation.max_penetration() < scene.method.gap_tolerance);
  }
  INFO("soft " << solves[0] << " solves, hard " << solves[1]);
  CHECK(found[1].stable() == Approx(found[0].stable()).margin(scene.strength_reduction.width));
  CHECK(static_cast<double>(solves[1]) <= 1.2 * static_cast<double>(solves[0]));
}

TEST_CASE("hard knows columns that topple slowly from such that stand", "[analysis][strength_reduction][hard]") {
  // Beyond the limit the forces that turn the columns are at first a millionth of their weights.
  Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_60_columns_m70.toml");
  std::vector<long> solves;
  for (const std::string method : {"soft", "hard"}) {
    scene.method.contact = method;
    scene.strength_reduction.definition = FactorDefinition::large_displacements;
    Simulation simulation(scene);
    const auto safety = factor_of_safety(simulation);
    CHECK(safety.bracket.failed_by == "displacement");
    CHECK(safety.warnings.empty());
    solves.push_back(simulation.state().counters.iterations);
  }
  INFO("soft " << solves[0] << " solves, hard " << solves[1]);
  CHECK(solves[1] <= 3 * solves[0]);
}

namespace {

/// Answers as a table of outcomes says.
class ToldTrials : public StrengthTrials {
 public:
  explicit ToldTrials(std::function<TrialOutcome(double)> outcome, std::optional<double> proved = std::nullopt)
      : outcome_(std::move(outcome)), proved_(proved) {}
  TrialResult first(double srf) override { return next(srf, OnBreak::go_on); }
  TrialResult next(double srf, OnBreak) override {
    TrialResult result;
    result.outcome = outcome_(srf);
    result.criterion = "told";
    return result;
  }
  std::optional<double> proved_failure(double) override { return proved_; }

 private:
  std::function<TrialOutcome(double)> outcome_;
  std::optional<double> proved_;
};

StrengthBracket searched(const std::function<TrialOutcome(double)>& outcome, std::optional<double> proved = std::nullopt, double width = 1e-3) {
  ToldTrials trials(outcome, proved);
  StrengthReductionInput input;
  input.width = width;
  return search_strength(trials, input, [](const StrengthTrial&) {});
}

}  // namespace

TEST_CASE("an undecided trial is never a failed one", "[analysis][strength_reduction]") {
  SECTION("undecided between a stable and a failed range: both ends are found") {
    const auto b = searched([](double srf) { return srf < 1.3 ? TrialOutcome::stable : srf < 1.4 ? TrialOutcome::undecided : TrialOutcome::failed; });
    REQUIRE((b.stable && b.failed));
    CHECK(*b.stable < 1.3);
    CHECK(*b.failed >= 1.4);
    CHECK(b.undecided > 0);
  }
  SECTION("nothing but undecided above") {
    const auto b = searched([](double srf) { return srf < 1.3 ? TrialOutcome::stable : TrialOutcome::undecided; });
    REQUIRE(b.stable);
    CHECK_FALSE(b.failed);
  }
  SECTION("nothing but undecided above, up to a proof without a trial") {
    const auto b = searched([](double srf) { return srf < 1.3 ? TrialOutcome::stable : TrialOutcome::undecided; }, 1.35);
    REQUIRE((b.stable && b.failed));
    CHECK(*b.stable < 1.3);
    CHECK(*b.failed == 1.35);
    CHECK(b.failed_by == by_limit_analysis);
  }
  SECTION("a proof above what trials have found to fail changes nothing") {
    const auto b =
        searched([](double srf) { return srf < 1.3    ? TrialOutcome::stable
                                         : srf < 1.31 ? TrialOutcome::undecided
                                                      : TrialOutcome::failed; }, 1.7);
    REQUIRE(b.failed);
    CHECK(*b.failed < 1.33);
    CHECK(b.failed_by == "told");
  }
  SECTION("never decided") {
    const auto b = searched([](double) { return TrialOutcome::undecided; });
    CHECK_FALSE(b.stable);
    CHECK_FALSE(b.failed);
    CHECK(b.undecided > 0);
  }
  SECTION("an undecided factor within a stable range does not stop the search") {
    const auto b = searched([](double srf) {
      return srf == 1.25 ? TrialOutcome::undecided : srf < 2.0 ? TrialOutcome::stable : TrialOutcome::failed;
    });
    REQUIRE((b.stable && b.failed));
    CHECK(*b.failed - *b.stable <= 1e-3);
    CHECK(*b.stable < 2.0);
    CHECK(*b.failed >= 2.0);
  }
}

TEST_CASE("where so much work is done that undecided factors stay so, the search ends; where trials are decided it goes on",
          "[analysis][strength_reduction]") {
  /// Exhausted from the beginning, and counting.
  class TiredTrials : public ToldTrials {
   public:
    using ToldTrials::ToldTrials;
    TrialResult next(double srf, OnBreak on_break) override {
      ++count;
      TrialResult result = ToldTrials::next(srf, on_break);
      result.exhausted = true;
      return result;
    }
    int count = 0;
  };
  StrengthReductionInput input;
  input.width = 1e-3;
  TiredTrials undecided([](double srf) { return srf < 1.3 ? TrialOutcome::stable : TrialOutcome::undecided; });
  const StrengthBracket open = search_strength(undecided, input, [](const StrengthTrial&) {});
  REQUIRE(open.stable);
  CHECK_FALSE(open.failed);
  // Factors 1, 1.25 and 1.5625, the last of which is undecided.
  CHECK(undecided.count == 3);
  TiredTrials decided([](double srf) { return srf < 1.3 ? TrialOutcome::stable : TrialOutcome::failed; });
  const StrengthBracket narrow = search_strength(decided, input, [](const StrengthTrial&) {});
  REQUIRE((narrow.stable && narrow.failed));
  CHECK(*narrow.failed - *narrow.stable <= 1e-3);
}

TEST_CASE("the bracket of a small factor is narrow beside the factor", "[analysis][strength_reduction]") {
  const double limit = 0.0637, width = 1e-3;
  const auto b = searched([&](double srf) { return srf < limit ? TrialOutcome::stable : TrialOutcome::failed; }, std::nullopt, width);
  REQUIRE((b.stable && b.failed));
  CHECK(*b.stable < limit);
  CHECK(*b.failed >= limit);
  CHECK(*b.failed - *b.stable <= width * *b.stable);
  CHECK(*b.failed - *b.stable > 0.4 * width * *b.stable);
}

TEST_CASE("the factor at small displacements is the closed form's, proved at both ends, whatever the stiffness", "[analysis][strength_reduction]") {
  for (const std::string& method : all_methods) {
    for (const double stiffness : {1.0, 1e-2, 1e3}) {
      INFO(method << ", stiffness times " << stiffness);
      Scene scene = slope_scene(method, 30.0, 35.0, 5000.0);
      scene.strength_reduction.definition = FactorDefinition::small_displacements;
      scene.joints[0].normal_stiffness *= stiffness;
      scene.joints[0].shear_stiffness *= stiffness;
      const auto safety = factor(scene);
      CHECK(safety.verdict == FactorVerdict::certified);
      const double exact = closed_form(30.0, 35.0, 5000.0);
      // Forces are in balance to 1e-8 of the weight.
      CHECK(safety.stable() <= exact * (1.0 + 1e-7));
      CHECK(safety.failed() >= exact * (1.0 - 1e-7));
      CHECK(safety.failed() - safety.stable() <= scene.strength_reduction.width);
      REQUIRE(safety.limit_analysis);
      REQUIRE(safety.limit_analysis->factor);
      CHECK(*safety.limit_analysis->factor == Approx(exact).epsilon(2e-5));
      CHECK(*safety.limit_analysis->factor >= exact * (1.0 - 1e-8));
      REQUIRE(safety.mechanism.size() == 1);
      // Limit analysis opens what slides at the friction angle.
      const bool by_limit = safety.bracket.failed_by == "limit analysis";
      const double opening = by_limit ? std::atan(std::tan(35.0 * test::degree) / exact) : 0.0;
      CHECK(safety.mechanism[0].velocity.normalized().dot(test::downhill(30.0 * test::degree)) == Approx(std::cos(opening)).epsilon(1e-4));
    }
  }
}

TEST_CASE("supports, loads and tensile strength count in the factor at small displacements", "[analysis][strength_reduction]") {
  SECTION("a push of 5 kN on a block on the flat: mu W/H") {
    Scene scene = test::block_on_base();
    scene.joints[0].friction_angle = 30.0 * test::degree;
    scene.loads.push_back({1, Vec2(1.0, 0.5), Vec2(5000.0, 0.0)});
    const auto safety = factor(scene);
    CHECK(safety.verdict == FactorVerdict::certified);
    CHECK(safety.stable() == Approx(std::tan(30.0 * test::degree) * test::block_weight / 5000.0).epsilon(1e-4));
  }
  SECTION("a spring that holds the block along the slope holds it at every factor, however soft it is") {
    for (const double stiffness : {1e8, 1e5, 1e4}) {
      INFO(stiffness << " N/m");
      Scene scene = test::block_on_incline(30.0 * test::degree);
      scene.supports.push_back({1, 0.5 * (scene.blocks[1].vertices[0] + scene.blocks[1].vertices[2]), Vec2(stiffness, stiffness)});
      CHECK(factor(scene).verdict == FactorVerdict::no_failure);
    }
  }
  SECTION("with stiff joints, too, where a bolt stretches by millions of closures, and up to the size of the block") {
    // At 1 N/m the block would go for kilometres.
    for (const double stiffness : {1e5, 1.0}) {
      for (const std::string& method : all_methods) {
        CAPTURE(stiffness, method);
        Scene scene = test::block_on_incline(30.0 * test::degree);
        scene.joints[0] = test::frictional_joint(1e13, 4e12, 35.0 * test::degree);
        scene.supports.push_back({1, 0.5 * (scene.blocks[1].vertices[0] + scene.blocks[1].vertices[2]), Vec2(stiffness, stiffness)});
        scene.method.contact = method;
        const auto safety = factor(scene);
        CHECK(safety.bracket.failed.has_value() == (stiffness < 1e4));
        // The way of the spring leaves passes and explicit steps undecided above it.
        const double exact = std::tan(35.0 * test::degree) / std::tan(30.0 * test::degree);
        if (safety.bracket.failed) CHECK(safety.failed() >= exact * (1.0 - 1e-6));
        if (safety.bracket.failed && method == "soft") CHECK(safety.failed() == Approx(exact).epsilon(2e-4));
      }
    }
  }
  SECTION("a block that hangs by its tensile strength: f L/W") {
    Scene scene = test::empty_scene();
    scene.blocks = {test::fixed_block("ceiling", test::rectangle(-10.0, 1.0, 20.0, 1.0)),
                    test::free_block("block", test::rectangle(0.0, 0.0, 2.0, 1.0))};
    scene.joints[0].tensile_strength = 1.5 * test::block_weight / test::block_edge;
    scene.joints[0].cohesion = 1e6;
    const auto safety = factor(scene);
    CHECK(safety.verdict == FactorVerdict::certified);
    CHECK(safety.stable() == Approx(1.5).margin(2e-4));
  }
}

TEST_CASE("a block that hangs by less tensile strength than its weight has a factor below 1: strength over weight",
          "[analysis][strength_reduction]") {
  for (const std::string& method : all_methods) {
    for (const double exact : {0.8, 0.05}) {
      CAPTURE(method, exact);
      Scene scene = test::column_of_blocks(1);
      scene.method.contact = method;
      scene.gravity = -scene.gravity;
      scene.joints[0].tensile_strength = exact * block_weight / test::block_edge;
      scene.joints[0].cohesion = 10.0 * scene.joints[0].tensile_strength;
      const auto safety = factor(scene);
      REQUIRE(safety.found());
      CHECK(safety.verdict == FactorVerdict::certified);
      CHECK(safety.stable() <= exact * (1.0 + 1e-6));
      CHECK(safety.failed() >= exact * (1.0 - 1e-6));
    }
  }
}

TEST_CASE("a slender column that sways by a thousand closures slides at tan(friction) over tan(tilt)", "[analysis][strength_reduction]") {
  constexpr int drums = 15;
  constexpr double height = 1.757, tilt = 2.1 * test::degree;  // it topples at atan(1/(15 * 1.757)) = 2.17 deg
  for (const std::string& method : all_methods) {
    CAPTURE(method);
    Scene scene = test::empty_scene();
    scene.method.contact = method;
    scene.blocks = {test::fixed_block("base", test::rectangle(-2.0, -1.0, 5.0, 1.0))};
    for (int i = 0; i < drums; ++i)
      scene.blocks.push_back(test::free_block("drum " + std::to_string(i), test::rectangle(0.0, i * height, 1.0, height)));
    scene.gravity = 9.81 * Vec2(std::sin(tilt), -std::cos(tilt));
    const double exact = std::tan(scene.joints[0].friction_angle) / std::tan(tilt);
    const auto safety = factor(scene);
    REQUIRE(safety.found());
    CHECK(safety.stable() <= exact * (1.0 + 1e-6));
    CHECK(safety.failed() >= exact * (1.0 - 1e-6));
  }
}

TEST_CASE("closures of the joints before the search: the same factor where the plane does not turn", "[analysis][strength_reduction]") {
  Scene scene = slope_scene("soft", 30.0, 40.0, 0.0);
  scene.strength_reduction.definition = FactorDefinition::joint_closures;
  const auto safety = factor(scene);
  CHECK(safety.verdict == FactorVerdict::certified);
  // The block tilts on its springs by less than 1e-4.
  CHECK(safety.stable() == Approx(closed_form(30.0, 40.0, 0.0)).epsilon(4e-4));
  REQUIRE(safety.states.size() >= 2);
  CHECK(safety.states[0].name == "settled");
}

TEST_CASE("closures of the joints before the search: columns stay where they are drawn and have the factor they have there",
          "[analysis][strength_reduction]") {
  // If contacts were kept that only the first look at the drawing finds, they would go to another equilibrium, 0.6 m off, with 1.08 of the factor.
  Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_60_columns_m70.toml");
  scene.strength_reduction.definition = FactorDefinition::small_displacements;
  const auto as_drawn = factor(scene);
  scene.strength_reduction.definition = FactorDefinition::joint_closures;
  const auto closed = factor(scene);
  REQUIRE(as_drawn.found());
  REQUIRE(closed.found());
  // Both are known within their brackets; closures of 0.1 mm tilt columns that are metres wide by less than 1e-4.
  const double tilt = 1e-4 * as_drawn.stable();
  CHECK(closed.stable() == Approx(as_drawn.stable()).margin(2.0 * scene.strength_reduction.width + tilt));
}

TEST_CASE("what the ratio of the stiffnesses does to the factor is what a search of its own finds", "[analysis][strength_reduction]") {
  const auto mentions_ratio = [](const FactorOfSafety& safety) {
    return std::ranges::any_of(safety.warnings,
                               [](const std::string& w) { return w.find("ratio of shear to normal stiffness") != std::string::npos; });
  };
  SECTION("columns that slide and topple") {
    Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_60_columns_m70.toml");
    scene.strength_reduction.definition = FactorDefinition::small_displacements;
    const auto safety = factor(scene);
    REQUIRE(safety.stiffness_effects.size() == 2);
    REQUIRE(safety.limit_analysis->failed);
    for (const StiffnessEffect& effect : safety.stiffness_effects) {
      for (JointProperties& joint : scene.joints) joint.shear_stiffness = effect.ratio * joint.normal_stiffness;
      const auto other = factor(scene);
      REQUIRE(effect.stable);
      REQUIRE(effect.failed);
      CHECK(*effect.stable <= other.failed());
      CHECK(*effect.failed >= other.stable());
      CHECK(*effect.failed <= *safety.limit_analysis->failed);
      // At a ratio that the joints have already, the answer is the scene's own.
      const auto own = std::ranges::find(other.stiffness_effects, effect.ratio, &StiffnessEffect::ratio);
      REQUIRE(own != other.stiffness_effects.end());
      CHECK(own->stable == other.bracket.stable);
      CHECK(own->failed == other.bracket.failed);
    }
    CHECK(*safety.stiffness_effects[0].failed < safety.stable());  // soft in shear, they stand less
    CHECK(mentions_ratio(safety));
  }
  SECTION("one block on an incline: nothing") {
    Scene scene = slope_scene("soft", 30.0, 35.0, 0.0);
    scene.strength_reduction.definition = FactorDefinition::small_displacements;
    const auto safety = factor(scene);
    REQUIRE(safety.stiffness_effects.size() == 2);
    for (const StiffnessEffect& effect : safety.stiffness_effects) {
      CHECK(effect.stable.value() <= closed_form(30.0, 35.0, 0.0) * (1.0 + 1e-7));
      CHECK(effect.failed.value() >= closed_form(30.0, 35.0, 0.0) * (1.0 - 1e-7));
    }
    CHECK_FALSE(mentions_ratio(safety));
    CHECK(safety.warnings.empty());
  }
  SECTION("left out with limit analysis") {
    Scene scene = slope_scene("soft", 30.0, 35.0, 0.0);
    scene.strength_reduction.definition = FactorDefinition::small_displacements;
    scene.strength_reduction.limit_analysis = false;
    CHECK(factor(scene).stiffness_effects.empty());
  }
}

TEST_CASE("a search at another ratio of stiffness that ended undecided below the factor says nothing of it", "[analysis][strength_reduction]") {
  CHECK(is_unknown({1.0, 0.85, std::nullopt}, 1.25));
  CHECK_FALSE(is_unknown({1.0, 0.85, 0.9}, 1.25));
  CHECK_FALSE(is_unknown({1.0, 1.249, std::nullopt}, 1.25));
  CHECK_FALSE(is_unknown({1.0, 1.3, std::nullopt}, 1.25));
  CHECK_FALSE(is_unknown({1.0, std::nullopt, std::nullopt}, 1.25));
}
