// The multiplier of a load that the blocks bear with their own strength, against closed forms of one block.
#include <algorithm>
#include <cmath>
#include <string>

#include "openclose/analysis/drawn_joints.h"
#include "openclose/analysis/strength_reduction.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;
using openclose::test::block_edge;
using openclose::test::block_weight;
using openclose::test::degree;

namespace {

FactorOfSafety multiplier(Scene scene, const std::string& load, const std::string& method = "soft") {
  scene.method.contact = method;
  scene.strength_reduction.increase = load;
  Simulation simulation(scene);
  return factor_of_safety(simulation);
}

/// Both ends, and limit analysis, which is exact for one block that slides or tips.
void check_multiplier(const FactorOfSafety& found, double expected) {
  REQUIRE(found.verdict == FactorVerdict::certified);
  constexpr double rounding = 1e-6;
  CHECK(found.stable() <= expected * (1.0 + rounding));
  CHECK(found.failed() >= expected * (1.0 - rounding));
  CHECK(found.failed() - found.stable() <= 1e-4 * found.stable());
  REQUIRE(found.limit_analysis.has_value());
  REQUIRE(found.limit_analysis->factor.has_value());
  CHECK(*found.limit_analysis->factor == Approx(expected).epsilon(2e-5));
  CHECK(found.trials.front().srf == 0.0);
  CHECK(found.trials.front().outcome == TrialOutcome::stable);
  CHECK(found.mechanism.size() == 1);
}

/// A block of 2 m x 1 m on an incline, friction angle 35 degrees.
Scene incline(double slope_deg) {
  Scene scene = test::block_on_incline(slope_deg * degree);
  scene.joints[0].friction_angle = 35.0 * degree;
  return scene;
}

/// 1 m wide and 4 m high on the base, with so much friction that it tips.
Scene tall_block() {
  Scene scene = test::block_on_base();
  scene.blocks[1].vertices = test::rectangle(0.0, 0.0, 1.0, 4.0);
  scene.joints[0].friction_angle = 50.0 * degree;
  return scene;
}

}  // namespace

TEST_CASE("a block on a plane slides at a horizontal body force of tan(phi - alpha), uphill of tan(phi + alpha)", "[analysis][load_multiplier]") {
  for (const std::string& method : all_methods) {
    for (const double slope_deg : {0.0, 20.0}) {
      INFO(method << " on " << slope_deg << " degrees");
      const FactorOfSafety down = multiplier(incline(slope_deg), "gravity_x", method), up = multiplier(incline(slope_deg), "-gravity_x", method);
      check_multiplier(down, std::tan((35.0 - slope_deg) * degree));
      check_multiplier(up, std::tan((35.0 + slope_deg) * degree));
      CHECK(down.mechanism[0].velocity.dot(test::downhill(slope_deg * degree)) > 0.5);
      CHECK(up.mechanism[0].velocity.dot(test::downhill(slope_deg * degree)) < -0.5);
    }
  }
}

TEST_CASE("a tall block tips at a horizontal body force of width over height", "[analysis][load_multiplier]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    check_multiplier(multiplier(tall_block(), "gravity_x", method), 0.25);
  }
}

TEST_CASE("named loads grow together, from nothing, and the others stay", "[analysis][load_multiplier]") {
  Scene scene = incline(0.0);
  scene.joints[0].cohesion = 3000.0;
  // A weight on top, and a push in two parts, the second of which is a shear along the top: its outline runs to the left.
  scene.loads = {{1, {1.0, 1.0}, {0.0, -20e3}}, {1, {0.0, 0.5}, {3000.0, 0.0}, "push"}};
  scene.surcharges = {{1, {2.0, 1.0}, {0.0, 1.0}, 0.0, -500.0, "push"}};
  const double resisting = std::tan(35.0 * degree) * (block_weight + 20e3) + 3000.0 * block_edge, push = 3000.0 + 500.0 * block_edge;
  check_multiplier(multiplier(scene, "push"), resisting / push);
  const FactorOfSafety pulled = multiplier(scene, "-push");
  check_multiplier(pulled, resisting / push);
  CHECK(pulled.mechanism[0].velocity.x() < 0.0);
}

TEST_CASE("a load in any unit has the same limit, to the same part of it", "[analysis][load_multiplier]") {
  const double unit = GENERATE(1.0, 1e3, 1e7, 1e10);
  INFO(unit << " N");
  Scene scene = tall_block();
  scene.loads = {{1, {0.0, 4.0}, {unit, 0.0}, "push"}};
  scene.strength_reduction.upper_limit = 1e6;
  // H 4 m = W 0.5 m
  const double expected = 2500.0 * 4.0 * 9.81 * 0.5 / 4.0 / unit;
  check_multiplier(multiplier(scene, "push"), expected);
}

TEST_CASE("a vertical body force lifts the block off, and never moves it downwards", "[analysis][load_multiplier]") {
  Scene scene = test::block_on_base();
  scene.joints[0].tensile_strength = 0.25 * block_weight / block_edge;
  scene.joints[0].cohesion = 1e5;
  check_multiplier(multiplier(scene, "gravity_y"), 1.25);
  scene.strength_reduction.upper_limit = 0.3;
  const FactorOfSafety pressed = multiplier(scene, "-gravity_y");
  CHECK(pressed.verdict == FactorVerdict::no_failure);
  CHECK(pressed.stable() == 0.3);
  CHECK(pressed.reason == "still stable at strength_reduction.upper_limit");
}

TEST_CASE("what does not stand without the load has no multiplier", "[analysis][load_multiplier]") {
  const FactorOfSafety slides = multiplier(incline(36.0), "-gravity_x");
  CHECK(slides.verdict == FactorVerdict::no_equilibrium);
  CHECK_FALSE(slides.found());
  CHECK_THAT(slides.reason, Catch::Matchers::StartsWith("not stable before -gravity_x grows (mechanism)"));
  REQUIRE(slides.trials.size() == 1);
  CHECK(slides.trials[0].srf == 0.0);
  Scene scene = test::falling_block();
  const FactorOfSafety falls = multiplier(scene, "gravity_x");
  CHECK(falls.verdict == FactorVerdict::no_equilibrium);
  CHECK_THAT(falls.reason, Catch::Matchers::StartsWith("no strength of the joints could hold the blocks"));
}

TEST_CASE("what bears nothing of a load has the multiplier 0, with which there is nothing to compare", "[analysis][load_multiplier]") {
  Scene scene = test::block_on_base();
  scene.joints[0].friction_angle = 0.0;
  const FactorOfSafety smooth = multiplier(scene, "gravity_x");
  REQUIRE(smooth.found());
  CHECK(smooth.stable() == 0.0);
  CHECK(smooth.stiffness_effects.empty());
}

TEST_CASE("without gravity a named load alone pushes the blocks", "[analysis][load_multiplier]") {
  // Pressed against a wall by 8 kN, it bears half of that along the wall.
  Scene scene = test::empty_scene();
  scene.gravity = Vec2::Zero();
  scene.joints[0].friction_angle = std::atan(0.5);
  scene.blocks = {test::fixed_block("wall", test::rectangle(-1.0, 0.0, 1.0, 1.0)), test::free_block("block", test::rectangle(0.0, 0.0, 1.0, 1.0))};
  scene.loads = {{1, {1.0, 0.5}, {-8e3, 0.0}}, {1, {0.0, 0.5}, {0.0, 1e3}, "pull"}};
  const FactorOfSafety found = multiplier(scene, "pull");
  REQUIRE(found.verdict == FactorVerdict::certified);
  CHECK(found.stable() <= 4.0 * (1.0 + 1e-6));
  CHECK(found.failed() >= 4.0 * (1.0 - 1e-6));
}

TEST_CASE("a search at small multipliers ends", "[analysis][load_multiplier]") {
  // At the limit of friction: hardly any horizontal force is left to bear.
  const FactorOfSafety found = multiplier(incline(35.0 - 1e-7), "gravity_x");
  REQUIRE(found.bracket.stable.has_value());
  CHECK(found.stable() <= 1e-8);
  CHECK(found.failed() <= 1e-6);
  CHECK(found.trials.size() < 40);
}

TEST_CASE("joints that share a load in more than one way: the multiplier has the warnings and effects of a factor", "[analysis][load_multiplier]") {
  const FactorOfSafety found = multiplier(incline(20.0), "gravity_x");
  REQUIRE(found.stiffness_effects.size() == 2);
  for (const StiffnessEffect& effect : found.stiffness_effects) {
    // One block that slides: what its springs are does not matter.
    CHECK(effect.stable.value() == Approx(std::tan(15.0 * degree)).epsilon(0.02));
    CHECK(effect.failed.value() >= std::tan(15.0 * degree) * (1.0 - 1e-4));
  }
  CHECK(found.warnings.empty());
  REQUIRE(found.states.size() == 2);
  CHECK(found.states[0].name == "stable");
  double shear = 0.0;
  for (const Contact& c : found.states[0].contacts) shear += std::abs(c.shear_force);
  // At the limit: friction of what presses on the plane, of weight and body force.
  const double pressing = block_weight * (std::cos(20.0 * degree) - found.stable() * std::sin(20.0 * degree));
  CHECK(shear == Approx(std::tan(35.0 * degree) * pressing).epsilon(1e-3));
}

TEST_CASE("what tips as one body is drawn with its inner joints closed, and opens at its foot alone", "[analysis][load_multiplier]") {
  Scene scene = tall_block();
  scene.blocks.pop_back();
  for (int i = 0; i < 4; ++i) scene.blocks.push_back(test::free_block("block " + std::to_string(i), test::rectangle(0.0, i, 1.0, 1.0)));
  const auto found = multiplier(scene, "gravity_x");
  REQUIRE(found.mechanism.size() == 4);
  const NamedState& failed = found.states.back();
  REQUIRE(failed.is_mechanism);
  const double turn = std::abs(Motion::rotation(failed.system.displacement(4)));
  CHECK(turn > 0.05);
  CHECK(turn <= 0.25);
  constexpr double rounding = 1e-6;  // of the springs, over the travel
  for (const DrawnJoint& joint : drawn_joints(scene)) {
    const JointMotion m = joint_motion(joint, failed.system, JointDirection::drawn);
    const auto [closed, open] = std::minmax(m.from.opening, m.to.opening);
    CHECK(std::abs(closed) < rounding);
    CHECK(open == Approx(joint.block_a == 0 ? turn : 0.0).margin(rounding));
    CHECK(std::abs(m.from.slip) < rounding);
  }
}
