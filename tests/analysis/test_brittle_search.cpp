// Searches in which joints lose their strength for good: what is said of the factor does not hang on the way that trials before have gone.
#include <algorithm>
#include <cmath>

#include "openclose/analysis/frozen_trials.h"
#include "openclose/analysis/second_opinion.h"
#include "openclose/analysis/strength_reduction.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::degree;

namespace {

/// A column of 2 m x 4 m that a horizontal acceleration pushes along its base; its cohesion is lost once it slips.
Scene brittle_column(const std::string& method = "soft") {
  Scene scene = test::block_on_base();
  scene.blocks[1].vertices = test::rectangle(0.0, 0.0, 2.0, 4.0);
  scene.gravity = {4.5, -10.0};
  scene.joints[0].friction_angle = 38.66 * degree;
  scene.joints[0].cohesion = 5e3;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  scene.joints[0].shear_stiffness = scene.joints[0].normal_stiffness;
  scene.method.contact = method;
  return scene;
}

FactorOfSafety factor(const Scene& scene) {
  Simulation simulation(scene);
  return factor_of_safety(simulation);
}

}  // namespace

TEST_CASE("trials for a curve of displacements change nothing of what is said of the factor", "[analysis][brittle_search]") {
  Scene scene = brittle_column();
  const FactorOfSafety without = factor(scene);
  scene.strength_reduction.curve = {0.5, 3.0};
  const FactorOfSafety with = factor(scene);
  REQUIRE(std::ranges::count(with.trials, "curve", &StrengthTrial::stage) == 2);
  REQUIRE(with.states.size() == without.states.size());
  for (std::size_t i = 0; i < with.states.size(); ++i) {
    CHECK(with.states[i].name == without.states[i].name);
    CHECK(with.states[i].contacts == without.states[i].contacts);
  }
  REQUIRE(with.mechanism.size() == without.mechanism.size());
  for (std::size_t i = 0; i < with.mechanism.size(); ++i) CHECK(with.mechanism[i].velocity == without.mechanism[i].velocity);
  CHECK(with.largest_travel == without.largest_travel);
}

TEST_CASE("where a search begins anew at a smaller factor, displacements count from there", "[analysis][brittle_search]") {
  const Scene scene = brittle_column();
  FrozenSystem system(scene);
  FrozenTrials trials(scene, system);
  // The joint breaks at the first factor, and holds at the second one.
  REQUIRE(trials.first(1.5).outcome == TrialOutcome::stable);
  REQUIRE(trials.first(0.25).outcome == TrialOutcome::stable);
  const TrialResult next = trials.next(0.28, OnBreak::go_on);
  REQUIRE(next.outcome == TrialOutcome::stable);
  CHECK(std::abs(next.displacement) < 1e-12);  // nothing slips
  CHECK(trials.travel().largest < 1e-6);
}

TEST_CASE("dem: joints that break in a trial that fails are seen", "[analysis][brittle_search]") {
  for (const std::string method : {"soft", "dem"}) {
    INFO(method);
    const Scene scene = brittle_column(method);
    FrozenSystem system(scene);
    FrozenTrials trials(scene, system);
    REQUIRE(trials.first(1.0).outcome == TrialOutcome::stable);
    const TrialResult result = trials.next(4.0, OnBreak::go_back);
    CHECK(result.broke);
    CHECK(result.outcome == TrialOutcome::undecided);
  }
}

TEST_CASE("the search of another ratio of stiffness ends where nothing fails", "[analysis][brittle_search]") {
  // A block that lies on a level base stands at every strength, whatever its springs are.
  Scene scene = test::block_on_base();
  scene.strength_reduction.upper_limit = 20.0;
  const StiffnessEffect effect = stiffness_effect(scene, 0.1, 1.0, std::nullopt, {});
  REQUIRE(effect.stable);
  CHECK(*effect.stable == 20.0);
  CHECK_FALSE(effect.failed);
}

TEST_CASE("a joint that is bent cracks from its edge, which limit analysis does not know", "[analysis][brittle_search]") {
  // An overhang of 2 m x 1 m: sigma L^2/6 over W 1 m.
  Scene scene = test::scene_with(
      {test::fixed_block("wall", test::rectangle(-1.0, 0.0, 1.0, 1.0)), test::free_block("beam", test::rectangle(0.0, 0.0, 2.0, 1.0))});
  scene.joints[0].tensile_strength = 1.5 * 6.0 * test::block_weight;
  scene.joints[0].cohesion = 1e3 * scene.joints[0].tensile_strength;
  const FactorOfSafety safety = factor(scene);
  CHECK(safety.verdict == FactorVerdict::certified);
  CHECK(safety.stable() == Approx(1.5).margin(2e-4));
  CHECK(std::ranges::any_of(safety.warnings,
                            [](const std::string& w) { return w.find("one that is bent cracks from its edge") != std::string::npos; }));
  // Pulled evenly it has all of its strength, and limit analysis no more.
  scene.gravity = {9.81, 0.0};
  const FactorOfSafety pulled = factor(scene);
  CHECK(pulled.stable() == Approx(9.0).margin(2e-3));
  CHECK(std::ranges::none_of(pulled.warnings, [](const std::string& w) { return w.find("cracks") != std::string::npos; }));
}

TEST_CASE("a displacement of failure that is larger than the blocks is worth a warning", "[analysis][brittle_search]") {
  Scene scene = test::block_on_incline(20.0 * degree);
  scene.strength_reduction.definition = FactorDefinition::large_displacements;
  scene.strength_reduction.width = 0.1;
  const auto warns = [&](double displacement) {
    scene.settle.failure_displacement = displacement;
    return std::ranges::any_of(factor(scene).warnings,
                               [](const std::string& w) { return w.find("settle.failure_displacement_m") != std::string::npos; });
  };
  CHECK(warns(1.5));  // the block has a size of 1.41 m
  CHECK_FALSE(warns(1.4));
}
