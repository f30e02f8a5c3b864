#include <fmt/format.h>

#include <cmath>
#include <string>

#include "openclose/analysis/equilibrium.h"
#include "openclose/analysis/strength_reduction.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::block_weight;

namespace {

constexpr double half_height = 1.0;  // [m] of block_on_base, from -1 to 1

Scene paper_scene() {
  Scene scene = test::block_on_base();
  scene.settle.criterion = SettleCriterion::paper;
  scene.settle.relative_displacement = 1e-9;
  return scene;
}

}  // namespace

TEST_CASE("the criterion by default is that of settle()", "[analysis][equilibrium]") {
  Simulation a(test::column_of_blocks(3)), b(test::column_of_blocks(3));
  const SettleResult direct = settle(a), chosen = make_equilibrium_search(b)->settle_first({});
  CHECK(chosen.settled);
  CHECK(chosen.criterion == "unbalanced force");
  CHECK(chosen.steps == direct.steps);
  CHECK(chosen.unbalanced_fraction == direct.unbalanced_fraction);
  CHECK_FALSE(chosen.relative_displacement);
}

TEST_CASE("the paper's criterion ends where the block rests", "[analysis][equilibrium]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = paper_scene();
    scene.method.contact = method;
    scene.blocks[1].velocity = {3.0, 0.0};  // equilibrium knows no velocity of the scene
    Simulation simulation(scene);
    const SettleResult result = make_equilibrium_search(simulation)->settle_first({});
    REQUIRE(result.settled);
    CHECK(result.criterion == "relative displacement");
    CHECK(result.steps >= scene.settle.steady_steps);
    REQUIRE(result.relative_displacement);
    CHECK(*result.relative_displacement < scene.settle.relative_displacement);
    // A free swing at w moves v dt in a step and is v/w away from rest.
    const double stiffness = method == "soft" ? 1e9 : 1e10;
    const double sink = method == "hard" ? 0.0 : block_weight / (stiffness * test::block_edge);
    const double w = std::sqrt(1e9 * test::block_edge / test::block_mass);
    const double margin = scene.settle.relative_displacement * half_height / (scene.step.dt * w);
    CHECK(simulation.system().displacement(1)[1] == Approx(-sink).margin(margin + 1e-11));
    CHECK(std::abs(simulation.system().displacement(1)[0]) < 1e-9);
  }
}

TEST_CASE("a single short step is not steadiness", "[analysis][equilibrium]") {
  // The first step from rest is g dt^2/2 = 4.9e-6 m on half a height of 1 m: below the limit while the block falls.
  Scene scene = test::falling_block();
  scene.blocks.push_back(test::fixed_block("base", test::rectangle(0.0, -11.0, 2.0, 1.0)));
  scene.settle.criterion = SettleCriterion::paper;
  scene.settle.relative_displacement = 1e-6;  // half the height is 6 m
  scene.settle.max_time_steps = 300;
  Simulation simulation(scene);
  const SettleResult result = make_equilibrium_search(simulation)->settle_first({});
  CHECK_FALSE(result.settled);
  CHECK(result.criterion == "steps");
  CHECK(result.steps == 300);
  // After n steps of free fall the last one is g dt^2 (n - 1/2) long.
  CHECK(*result.relative_displacement == Approx(9.81 * 1e-6 * 299.5 / 6.0).epsilon(1e-10));
}

TEST_CASE("a trial goes on for twice the steps of the first settling", "[analysis][equilibrium]") {
  Scene scene = test::block_on_incline(20.0 * test::degree);
  scene.settle.criterion = SettleCriterion::paper;
  scene.settle.relative_displacement = 1e-8;
  Simulation simulation(scene);
  const auto search = make_equilibrium_search(simulation);
  const SettleResult first = search->settle_first({});
  REQUIRE(first.settled);
  SECTION("stable") {
    simulation.change_joints().reduce_strength(1.2);
    const SettleResult trial = search->settle_trial({});
    CHECK(trial.settled);
    CHECK(trial.steps == 2 * first.steps);
  }
  SECTION("failing") {
    simulation.change_joints().reduce_strength(2.0);
    const SettleResult trial = search->settle_trial({});
    CHECK_FALSE(trial.settled);
    CHECK(trial.criterion == "steps");
    CHECK(trial.steps == 2 * first.steps);
    const double time = trial.steps * scene.step.dt, slope = 20.0 * test::degree;
    const double acceleration = 9.81 * (std::sin(slope) - 0.5 * std::tan(30.0 * test::degree) * std::cos(slope));
    CHECK(trial.displacement == Approx(0.5 * acceleration * time * time).margin(5e-4));
  }
}

TEST_CASE("a step that cannot be taken ends the paper's settling with its reason", "[analysis][equilibrium]") {
  Scene scene = paper_scene();
  scene.method.contact = "shi";
  scene.blocks[1].vertices = test::rectangle(0.0, 0.001, 2.0, 1.0);
  scene.method.max_open_close_iterations = 1;
  scene.step.smallest_fraction = 0.5;
  Simulation simulation(scene);
  const SettleResult result = make_equilibrium_search(simulation)->settle_first({});
  CHECK_FALSE(result.settled);
  CHECK(result.criterion == "open-close iterations did not settle");
}

TEST_CASE("of an explicit method the paper's criterion is a force within a number of steps", "[analysis][equilibrium][explicit]") {
  Scene scene = test::block_on_incline(20.0 * test::degree);
  scene.method.contact = "dem";
  scene.settle.criterion = SettleCriterion::paper;
  scene.settle.unbalanced_force = GENERATE(1e3, 10.0);
  scene.settle.max_time_steps = 2000;
  scene.settle.failure_displacement = 1e-3;  // of the other criterion
  Simulation simulation(scene);
  const auto search = make_equilibrium_search(simulation);
  const SettleResult first = search->settle_first({});
  REQUIRE(first.settled);
  CHECK(first.criterion == "unbalanced force");
  const double left = simulation.explicit_stepper()->unbalanced_force(0.0);
  CHECK(left <= scene.settle.unbalanced_force);
  // It stops there: damping takes the force down by less than a hundredth in the last steps.
  CHECK(left > 1e-2 * scene.settle.unbalanced_force);
  const double force = scene.settle.unbalanced_force;
  CHECK_THAT(search->unseen(),
             ContainsSubstring(fmt::format("unbalanced_force_n = {:g} N, {:.2g} % of the weight", force, 100.0 * force / block_weight)));
  simulation.change_joints().reduce_strength(2.0);
  const SettleResult trial = search->settle_trial({});
  CHECK_FALSE(trial.settled);
  CHECK(trial.criterion == "steps");
  CHECK(trial.steps == scene.settle.max_time_steps);
  CHECK(trial.displacement > scene.settle.failure_displacement);
}

TEST_CASE("factor of safety by the paper's criterion", "[analysis][equilibrium]") {
  const double slope = 30.0 * test::degree, exact = std::tan(40.0 * test::degree) / std::tan(slope);
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = test::block_on_incline(slope);
    scene.method.contact = method;
    scene.joints[0].friction_angle = 40.0 * test::degree;
    scene.settle.criterion = SettleCriterion::paper;
    scene.settle.relative_displacement = 1e-8;
    scene.strength_reduction.definition = FactorDefinition::large_displacements;
    Simulation simulation(scene);
    const auto safety = factor_of_safety(simulation);
    REQUIRE(safety.found());
    CHECK(safety.bracket.failed_by == "steps");
    // Half the height of the scene: a base 20 m long and 1 m thick below a block.
    const double height = 20.0 * std::sin(slope) + std::cos(slope);
    const double slow = scene.settle.relative_displacement * 0.5 * height / scene.step.dt;
    // What accelerates by less than `slow` within a trial is taken for steady; what swings at w with `slow` adds m w slow to the forces.
    const double time = 2.0 * safety.trials.front().steps * scene.step.dt;
    const double swing = std::sqrt((method == "shi" ? 10.0 : 1.0) * 1e9 * test::block_edge / test::block_mass);
    CHECK(safety.stable() <= exact * (1.0 + 1.1 * slow / (time * 9.81 * std::sin(slope))));
    CHECK(safety.failed() >= exact * (1.0 - swing * slow / (9.81 * std::sin(slope))));
    REQUIRE(safety.warnings.size() == 1);
    CHECK_THAT(safety.warnings[0],
               ContainsSubstring(fmt::format("accelerates by up to {:.2g} m/s2 ({:.2g} % of gravity)", slow / time, 100.0 * slow / time / 9.81)));
  }
}

TEST_CASE("a saved search by the paper's criterion with steps that it may not take is refused", "[analysis][equilibrium]") {
  const Scene scene = paper_scene();
  Simulation simulation(scene);
  for (const auto& [steps, is_sound] :
       {std::pair{-1, false}, {0, true}, {scene.settle.max_time_steps, true}, {scene.settle.max_time_steps + 1, false}}) {
    INFO(steps);
    int written = steps;
    Archive saved;
    saved(written);
    Archive archive(saved.bytes());
    const auto search = make_equilibrium_search(simulation);
    if (is_sound) {
      CHECK_NOTHROW(search->exchange(archive));
    } else {
      CHECK_THROWS_AS(search->exchange(archive), DamagedState);
    }
  }
}
