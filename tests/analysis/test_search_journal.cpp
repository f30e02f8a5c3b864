// A search for the factor of safety that goes on from what it had found out does nothing of it again, and finds the same in every bit.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/search_journal.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/core/error.h"
#include "openclose/scene/reader.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;

namespace {

struct Saved {
  std::vector<std::string> states;
  FactorOfSafety safety;
};

/// With the state after every piece of work.
Saved search(const Scene& scene) {
  Saved saved;
  Simulation simulation(scene);
  saved.safety = factor_of_safety(simulation, SearchObserver{{}, [&](std::string state) { saved.states.push_back(std::move(state)); }});
  return saved;
}

Saved resume(const Scene& scene, const std::string& state) {
  Saved saved;
  Simulation simulation(scene);
  saved.safety = resume_search(simulation, SearchObserver{{}, [&](std::string later) { saved.states.push_back(std::move(later)); }}, state);
  return saved;
}

void check_same(const FactorOfSafety& a, const FactorOfSafety& b) {
  CHECK(a.verdict == b.verdict);
  CHECK(a.reason == b.reason);
  CHECK(a.warnings == b.warnings);
  CHECK(a.bracket.stable == b.bracket.stable);
  CHECK(a.bracket.failed == b.bracket.failed);
  CHECK(a.linear_solves == b.linear_solves);
  CHECK(a.largest_travel == b.largest_travel);
  REQUIRE(a.trials.size() == b.trials.size());
  for (std::size_t i = 0; i < a.trials.size(); ++i) {
    CHECK(a.trials[i].srf == b.trials[i].srf);
    CHECK(a.trials[i].outcome == b.trials[i].outcome);
    CHECK(a.trials[i].criterion == b.trials[i].criterion);
    CHECK(a.trials[i].steps == b.trials[i].steps);
    CHECK(a.trials[i].displacement == b.trials[i].displacement);
  }
  REQUIRE(a.curve.size() == b.curve.size());
  for (std::size_t i = 0; i < a.curve.size(); ++i) CHECK(a.curve[i].displacement == b.curve[i].displacement);
  REQUIRE(a.stiffness_effects.size() == b.stiffness_effects.size());
  for (std::size_t i = 0; i < a.stiffness_effects.size(); ++i) CHECK(a.stiffness_effects[i].stable == b.stiffness_effects[i].stable);
  REQUIRE(a.states.size() == b.states.size());
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    CHECK(a.states[i].name == b.states[i].name);
    CHECK(a.states[i].contacts == b.states[i].contacts);
    CHECK(a.states[i].system.state().displacement == b.states[i].system.state().displacement);
    CHECK(a.states[i].system.state().arm == b.states[i].system.state().arm);
  }
  REQUIRE(a.mechanism.size() == b.mechanism.size());
  for (std::size_t i = 0; i < a.mechanism.size(); ++i) CHECK(a.mechanism[i].velocity == b.mechanism[i].velocity);
}

/// From after every piece of work, or, of many, some of them.
void check_goes_on(const Scene& scene) {
  const Saved whole = search(scene);
  REQUIRE(whole.states.size() >= whole.safety.trials.size());
  const std::size_t every = std::max<std::size_t>(1, whole.states.size() / 6);
  for (std::size_t at = 0; at < whole.states.size(); at += every) {
    INFO("after piece " << at << " of " << whole.states.size());
    const Saved rest = resume(scene, whole.states[at]);
    check_same(whole.safety, rest.safety);
    REQUIRE(rest.states.size() == whole.states.size() - at - 1);
    if (!rest.states.empty()) CHECK((rest.states.back() == whole.states.back()));
  }
}

Scene slope(const std::string& method, FactorDefinition definition) {
  Scene scene = test::block_on_incline(30.0 * test::degree);
  scene.method.contact = method;
  scene.joints[0].friction_angle = 40.0 * test::degree;
  scene.joints[0].cohesion = 2000.0;
  scene.settle.failure_displacement = 0.05;
  scene.strength_reduction.width = 1e-3;
  scene.strength_reduction.definition = definition;
  scene.strength_reduction.curve = {1.1, 1.2};
  return scene;
}

}  // namespace

TEST_CASE("a search goes on bit for bit from after every piece of work", "[analysis][search_journal]") {
  for (const std::string& method : all_methods) {
    for (const FactorDefinition definition :
         {FactorDefinition::small_displacements, FactorDefinition::joint_closures, FactorDefinition::large_displacements}) {
      INFO(method << ", definition " << static_cast<int>(definition));
      Scene scene = slope(method, definition);
      if (definition == FactorDefinition::large_displacements) {
        scene.strength_reduction.curve_time = 0.05;
        scene.step.dt = 1e-3;
      }
      check_goes_on(scene);
    }
  }
}

TEST_CASE("a search for the multiplier of a load goes on bit for bit", "[analysis][search_journal][load_multiplier]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = slope(method, FactorDefinition::small_displacements);
    scene.strength_reduction.increase = "gravity_x";
    scene.strength_reduction.curve = {0.1, 0.15};
    check_goes_on(scene);
  }
}

TEST_CASE("a search among many blocks goes on bit for bit, with what the linear solver keeps", "[analysis][search_journal]") {
  // Here the matrix has entries later that it did not have at first, so that a solver made anew would have another order.
  Scene jointed = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_70_joints_0_m70.toml");
  jointed.strength_reduction.definition = FactorDefinition::joint_closures;
  check_goes_on(jointed);
  Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_60_columns_m70.toml");
  for (const std::string method : {"soft", "shi"}) {
    INFO(method);
    scene.method.contact = method;
    check_goes_on(scene);
  }
  scene.method.contact = "soft";
  scene.strength_reduction.width = 0.01;
  scene.strength_reduction.definition = FactorDefinition::large_displacements;
  check_goes_on(scene);
}

TEST_CASE("a search that is stopped in the middle of its work has what was done by then, and goes on bit for bit", "[analysis][search_journal]") {
  Scene scene = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_60_columns_m70.toml");
  scene.strength_reduction.width = 0.01;
  for (const std::string method : {"soft", "dem"}) {
    scene.method.contact = method;
    const auto stopped_after = [&](long calls, Saved& saved) {
      Simulation simulation(scene);
      long called = 0;
      SearchObserver observer{{}, [&](std::string state) { saved.states.push_back(std::move(state)); }};
      observer.interruption = [&] {
        if (++called == calls) throw Stopped();
      };
      saved.safety = factor_of_safety(simulation, observer);
      return called;
    };
    Saved whole;
    const long all = stopped_after(0, whole);
    REQUIRE(all > 100);
    CHECK_FALSE(whole.safety.bracket.stopped);
    // In the first trial, in others, in what follows the search.
    for (const double share : {0.01, 0.3, 0.5, 0.7, 0.9, 0.99}) {
      INFO(method << " stopped at " << share << " of " << all);
      Saved part;
      const long last = std::max(1L, static_cast<long>(share * static_cast<double>(all)));
      CHECK(stopped_after(last, part) == last);
      CHECK(part.safety.bracket.stopped);
      CHECK(part.safety.verdict != FactorVerdict::certified);
      if (!part.states.empty()) check_same(whole.safety, resume(scene, part.states.back()).safety);
    }
  }
}

TEST_CASE("a state of another scene is refused", "[analysis][search_journal]") {
  const Saved saved = search(slope("soft", FactorDefinition::small_displacements));
  const Scene other = read_scene(std::string(OPENCLOSE_VERIFICATION_SCENES) + "/slope_face_60_columns_m70.toml");
  CHECK_THROWS_AS(resume(other, saved.states.back()), DamagedState);
  CHECK_THROWS_AS(resume(other, saved.states.back().substr(0, saved.states.back().size() / 2)), DamagedState);
}

TEST_CASE("a journal gives what it has and does the rest", "[analysis][search_journal]") {
  int done = 0, told = 0;
  const auto work = [&] { return TrialResult{TrialOutcome::stable, "work", ++done, 0.5, false}; };
  SearchJournal first([&] { ++told; });
  first.once(work);
  first.once(work);
  CHECK(told == 2);
  Archive archive;
  archive(first);
  Archive saved(archive.take());
  SearchJournal second([&] { ++told; });
  saved(second);
  CHECK(second.once(work).steps == 1);
  CHECK(second.once(work).steps == 2);
  CHECK(done == 2);
  CHECK(told == 2);
  CHECK(second.once(work).steps == 3);
  CHECK(told == 3);
}
