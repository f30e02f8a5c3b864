// A simulation that goes on from a saved state does the same as one that has never stopped, in every bit.
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/core/error.h"
#include "openclose/integrator/integrators.h"
#include "openclose/scene/reader.h"
#include "openclose_traps.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;

namespace {

std::string state_of(Simulation& simulation) {
  Archive archive;
  archive(simulation);
  return archive.bytes();
}

/// A column that is hit from above: more blocks than the dense solver takes, so that the pattern decides the order of elimination.
Scene hit_column() {
  Scene scene = test::column_of_blocks(10);
  scene.blocks.push_back(test::free_block("stone", test::placed(test::rectangle(-0.5, -0.5, 1.0, 1.0), 0.4, {-0.7, 11.0})));
  scene.blocks.back().velocity = {3.0, -6.0};
  scene.joints[0].cohesion = 1e4;
  scene.joints[0].tensile_strength = 1e3;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  scene.joints[0].damping_ratio = 0.1;
  scene.joints[0].residual_friction_angle = 20.0 * test::degree;
  scene.joints[0].slip_weakening_distance = 0.02;
  scene.supports = {{2, {0.5, 1.5}, {1e6, 0.0}}};
  scene.loads = {{1, {0.5, 0.5}, {1e3, 0.0}}};
  scene.surcharges = {{3, scene.blocks[3].vertices[1], scene.blocks[3].vertices[2], 1e3, 5e2}};
  return scene;
}

/// Boxes that fall into a trough, a little turned.
Scene heap() {
  constexpr int rows = 8, columns = 5;
  constexpr double cell = 0.6, half = 0.18;
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("floor", test::rectangle(-1.0, -1.0, columns * cell + 2.0, 1.0)),
                  test::fixed_block("left", test::rectangle(-1.0, 0.0, 1.0, rows * cell)),
                  test::fixed_block("right", test::rectangle(columns * cell, 0.0, 1.0, rows * cell))};
  for (int i = 0; i < rows * columns; ++i) {
    const Vec2 centre{(i % columns + 0.5) * cell, (i / columns + 0.5) * cell};  // NOLINT(bugprone-integer-division)
    scene.blocks.push_back(test::free_block("box " + std::to_string(i),
                                            test::placed(test::rectangle(-half, -half, 2.0 * half, 2.0 * half), 0.05 * (i % 7 - 3), centre)));
  }
  return scene;
}

Scene prepared(Scene scene, const std::string& method) {
  scene.method.contact = method;
  scene.step.dt = 1e-3;
  scene.step.max_displacement = 6e-3;  // shorter than the fastest steps
  scene.method.penetration_tolerance = 0.1;
  return scene;
}

/// Leaves at the end of the step `at` in the one simulation and goes on in the other. Whether the states agree from there on.
void check_goes_on(const Scene& scene, int at, int to) {
  Simulation first(scene), second(scene);
  if (scene.base_motion) first.start_base_motion();
  for (int i = 0; i < at; ++i) REQUIRE(first.advance(scene.step.dt));
  Archive saved;
  saved(first);
  Archive archive(saved.bytes());
  archive(second);
  CHECK(archive.at_end());
  CHECK(state_of(second) == saved.bytes());
  for (int i = at; i < to; ++i) {
    REQUIRE(first.advance(scene.step.dt));
    REQUIRE(second.advance(scene.step.dt));
    // As constants: others are taken to change what they ask for, and the explicit loop begins anew.
    CHECK(std::as_const(second).system().displacement(1) == std::as_const(first).system().displacement(1));
  }
  CHECK(second.ledger().imbalance() == first.ledger().imbalance());
  CHECK(second.state().counters.iterations == first.state().counters.iterations);
  for (int b = 0; b < first.system().block_count(); ++b) {
    CHECK(second.system().displacement(b) == first.system().displacement(b));
    CHECK(second.velocity(b) == first.velocity(b));
  }
  REQUIRE(second.change_contacts().size() == first.change_contacts().size());
  for (std::size_t i = 0; i < first.change_contacts().size(); ++i) {
    CHECK(second.change_contacts()[i].shear_force == first.change_contacts()[i].shear_force);
    CHECK(second.change_contacts()[i].elastic_slip == first.change_contacts()[i].elastic_slip);
  }
}

}  // namespace

TEST_CASE("the factor that an iterative solver keeps is saved too", "[analysis][checkpoint]") {
  Scene scene = prepared(hit_column(), "soft");
  scene.method.linear_solver = LinearSolverKind::iterative;
  for (const int at : {0, 1, 60, 137}) {
    INFO("after step " << at);
    check_goes_on(scene, at, at + 60);
  }
}

TEST_CASE("the springs that hard has come to are saved too", "[analysis][checkpoint][hard]") {
  // 978 blocks, too weak to stand, that gravity meets at once: softer springs take the first steps.
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml",
                           {"joint_set[0].spacing_m=27.2", "joint_set[1].spacing_m=6.8", "joint[0].friction_angle_deg=21.7",
                            "joint[0].cohesion_pa=47e3", "step.dt_s=1e-3", "method.contact=\"hard\""});
  for (const int at : {1, 2}) {
    INFO("after step " << at);
    check_goes_on(scene, at, at + 1);
  }
}

TEST_CASE("how often hard has tried stiffer springs in vain is saved too", "[analysis][checkpoint][hard]") {
  Scene scene = heap();
  scene.method.contact = "hard";
  scene.step.dt = 0.01;
  for (int at = 30; at < 60; at += 2) {
    INFO("after step " << at);
    check_goes_on(scene, at, at + 4);
  }
}

TEST_CASE("a saved simulation goes on bit for bit", "[analysis][checkpoint]") {
  for (const std::string& method : all_methods) {
    for (const int at : {0, 1, 60, 137, 250}) {
      INFO(method << " after step " << at);
      check_goes_on(prepared(test::tumbling_blocks(), method), at, at + 100);
      check_goes_on(prepared(hit_column(), method), at, at + 60);
      check_goes_on(prepared(test::block_on_incline(35.0 * test::degree), method), at, at + 60);  // below the skin of the contacts
    }
  }
}

TEST_CASE("a saved simulation goes on bit for bit with every integrator, in adaptive steps too", "[analysis][checkpoint]") {
  for (const auto& entry : integrators()) {
    for (const bool adaptive : {false, true}) {
      INFO(entry.name << (adaptive ? ", adaptive" : ""));
      Scene scene = prepared(test::tumbling_blocks(), "soft");
      scene.method.integrator = entry.name;
      scene.step.adaptive = adaptive;
      scene.step.error_tolerance = 1e-6;
      for (const int at : {1, 60}) check_goes_on(scene, at, at + 60);
    }
  }
}

TEST_CASE("a saved simulation goes on bit for bit on a shaken base with every integrator", "[analysis][checkpoint][base_motion]") {
  for (const auto& entry : integrators()) {
    INFO(entry.name);
    Scene scene = prepared(test::tumbling_blocks(), "soft");
    scene.method.integrator = entry.name;
    scene.base_motion.emplace();
    scene.base_motion->kind = BaseMotionKind::harmonic;
    scene.base_motion->amplitude = {5.0, 2.0};
    scene.base_motion->frequency = 20.0;
    for (const int at : {1, 60}) check_goes_on(scene, at, at + 60);
  }
}

TEST_CASE("a saved simulation goes on bit for bit before, at and after the end of its first integrator", "[analysis][checkpoint]") {
  for (const auto& [first, then] : {std::pair("path_average", "shi"), std::pair("generalized_alpha", "tr_bdf2")}) {
    INFO(first << ", then " << then);
    Scene scene = prepared(test::tumbling_blocks(), "soft");
    scene.method.first_integrator = first;
    scene.method.first_integrator_time = 60.0 * scene.step.dt;
    scene.method.integrator = then;
    for (const int at : {0, 59, 60, 61}) check_goes_on(scene, at, at + 60);
  }
}

TEST_CASE("saving leaves a simulation as it is", "[analysis][checkpoint]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    const Scene scene = prepared(test::tumbling_blocks(), method);
    Simulation watched(scene), alone(scene);
    for (int i = 0; i < 200; ++i) {
      REQUIRE(watched.advance(scene.step.dt));
      REQUIRE(alone.advance(scene.step.dt));
      state_of(watched);
    }
    CHECK(state_of(watched) == state_of(alone));
  }
}

TEST_CASE("a state with numbers that are none is refused", "[analysis][checkpoint]") {
  const NonStop non_stop;
  const double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  const auto require_refused = [](Simulation& simulation) {
    Simulation other(simulation.scene());
    Archive state(state_of(simulation));
    CHECK_THROWS_AS(state(other), DamagedState);
  };
  for (const std::string& method : all_methods) {
    INFO(method);
    const Scene scene = prepared(test::falling_block(), method);
    for (const double wrong : {none, endless}) {
      Simulation energy(scene), speed(scene), both(scene);
      // What no step leaves, but a damaged file can hold.
      const_cast<EnergyLedger&>(energy.ledger()).scheme = wrong;
      require_refused(energy);
      speed.change_system().set_velocity(0, Motion::Unknowns(0.0, wrong, 0.0));
      require_refused(speed);
      both.set_velocity(0, Motion::Unknowns(wrong, 0.0, 0.0));
      require_refused(both);
    }
  }
}

TEST_CASE("a run goes on from each of its checkpoints", "[analysis][checkpoint]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = prepared(test::block_on_incline(20.0 * test::degree), method);
    scene.method.start = Start::settled;
    scene.run_strength_reduction_factor = 2.0;
    scene.end_time = 0.35;
    scene.output_every = 0.01;
    scene.checkpoint_every = 0.07;
    scene.milestones = {0.003, 0.02};
    scene.snapshot_times = {0.1, 0.2};
    scene.base_motion.emplace();
    scene.base_motion->kind = BaseMotionKind::harmonic;
    scene.base_motion->amplitude = {1.0, 0.5};
    scene.base_motion->frequency = 5.0;

    Simulation whole(scene);
    std::vector<std::string> checkpoints, snapshots;
    std::vector<double> rows;
    RunObserver observer;
    observer.output = [&](const Simulation& s) { rows.push_back(s.time()); };
    observer.snapshot = [&](const std::string& name, const Simulation&) { snapshots.push_back(name); };
    observer.checkpoint = [&](Archive& state, const Simulation&) { checkpoints.push_back(state.bytes()); };
    const RunResult result = run(whole, observer);
    REQUIRE(result.converged);
    REQUIRE(result.milestones.size() == 2);
    REQUIRE(snapshots.size() == 4);
    REQUIRE(checkpoints.size() == 5);  // the last one at the end

    for (std::size_t c = 0; c < checkpoints.size(); ++c) {
      Simulation rest(scene);
      RunObserver other;
      std::vector<double> later_rows;
      std::string last;
      other.output = [&](const Simulation& s) { later_rows.push_back(s.time()); };
      other.checkpoint = [&](Archive& state, const Simulation&) { last = state.bytes(); };
      Archive state(checkpoints[c]);
      const RunResult resumed = ResumedRun(rest, state).go_on(other);
      CHECK(resumed.converged);
      CHECK(resumed.ended_by == "end.time_s");
      CHECK(rest.time() == whole.time());
      CHECK(later_rows == std::vector<double>(rows.end() - 7 * (4 - static_cast<long>(c)), rows.end()));
      CHECK(rest.system().displacement(1) == whole.system().displacement(1));
      CHECK(rest.ledger().friction == whole.ledger().friction);
      CHECK(resumed.settling.steps == result.settling.steps);
      // The worst is that of the whole run, whichever part of it has shown it.
      CHECK(resumed.watch.depth == result.watch.depth);
      CHECK(resumed.watch.penetration == result.watch.penetration);
      CHECK(resumed.watch.created_energy == result.watch.created_energy);
      CHECK(resumed.watch.checks == result.watch.checks);
      REQUIRE(resumed.milestones.size() == 2);
      for (int i : {0, 1}) CHECK(resumed.milestones[i].time == result.milestones[i].time);
      CHECK(resumed.warnings.empty());
    }
  }
}

TEST_CASE("a run whose start is stopped while it settles goes on bit for bit", "[analysis][checkpoint]") {
  const std::string method = GENERATE("soft", "hard", "shi", "dem");
  CAPTURE(method);
  Scene scene = prepared(test::column_of_blocks(10), method);
  scene.joints[0].cohesion = 1e4;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  scene.method.start = Start::settled;
  if (method == "dem") scene.settled_by = "soft";
  scene.settle.first_dt = 1e-4;  // many steps
  scene.end_time = 0.02;
  scene.output_every = 0.01;
  struct End {
    std::string state;
    int steps;
  };
  const auto end_of = [](const Simulation& simulation, const RunResult& result) {
    REQUIRE(result.converged);
    Archive state;
    state(const_cast<Simulation&>(simulation));
    return End{state.bytes(), result.settling.steps};
  };
  Simulation whole(scene);
  const End expected = end_of(whole, run(whole, {}));
  REQUIRE(expected.steps > 3);
  for (int at = 1; at <= expected.steps; ++at) {
    INFO("stopped after step " << at);
    std::string saved;
    int steps = 0;
    RunObserver observer;
    observer.settling = [&](double) {
      if (++steps == at) throw Stopped();
    };
    observer.checkpoint = [&](Archive& state, const Simulation&) { saved = state.bytes(); };
    Simulation stopped(scene);
    const RunResult result = run(stopped, observer);
    CHECK(result.stopped);
    CHECK_FALSE(result.converged);
    CHECK_FALSE(result.has_start);
    CHECK(result.settling.steps == at);
    Simulation again(scene);
    Archive archive(saved);
    ResumedRun resumed(again, archive);
    CHECK(archive.at_end());
    CHECK_FALSE(resumed.has_start());
    const End end = end_of(again, resumed.go_on({}));
    CHECK(end.steps == expected.steps);
    CHECK((end.state == expected.state));
  }
}

TEST_CASE("a saved start that settles is refused by a scene whose start does not, or not in static steps", "[analysis][checkpoint]") {
  Scene scene = prepared(test::column_of_blocks(3), "soft");
  scene.method.start = Start::settled;
  std::string saved;
  RunObserver observer;
  observer.settling = [](double) { throw Stopped(); };
  observer.checkpoint = [&](Archive& state, const Simulation&) { saved = state.bytes(); };
  Simulation stopped(scene);
  REQUIRE(run(stopped, observer).stopped);
  const auto reads = [&](const std::string& bytes) {
    Simulation again(scene);
    Archive archive(bytes);
    try {
      ResumedRun resumed(again, archive);
      return true;
    } catch (const DamagedState&) {
      return false;
    }
  };
  CHECK(reads(saved));
  SECTION("unloaded") {
    scene.method.start = Start::unloaded;
    CHECK_FALSE(reads(saved));
  }
  SECTION("the paper's steps in time") {
    scene.settle.criterion = SettleCriterion::paper;
    CHECK_FALSE(reads(saved));
  }
  SECTION("a step without a length") {
    const double none = 0.0;
    Simulation other(scene);
    StartSearch start(other);
    Archive archive(saved.substr(1));  // without the switch in front of it
    archive(start);
    Archive again;
    again(start);
    std::string bytes = saved.substr(0, 1) + again.bytes();
    CHECK(bytes == saved);
    const std::size_t at = bytes.size() - [&] {
      Archive end;
      SettleCourse course;
      course.start.resize(4);
      course.result = start.settling();
      end(course);
      return end.bytes().size();
    }() + 2;  // behind its two switches
    bytes.replace(at, sizeof none, reinterpret_cast<const char*>(&none), sizeof none);
    CHECK_FALSE(reads(bytes));
  }
}

TEST_CASE("a start that is settled explicitly is not gone on with", "[analysis][checkpoint]") {
  Scene scene = prepared(test::column_of_blocks(3), "dem");
  scene.method.start = Start::settled;
  Simulation simulation(scene);
  RunObserver observer;
  observer.settling = [](double) { throw Stopped(); };
  observer.checkpoint = [](Archive&, const Simulation&) { FAIL("a checkpoint"); };
  CHECK_THROWS_AS(run(simulation, observer), Stopped);
}

TEST_CASE("a run that goes on from its end ends as it did", "[analysis][checkpoint]") {
  Scene scene = prepared(test::falling_block(), "soft");
  scene.checkpoint_every = 1.0;
  scene.snapshot_times = {0.0, 5.0};
  std::string key = "end.time_s";
  SECTION("by time, in the middle of a step") {
    scene.end_time = 0.0305;
  }
  SECTION("by time") {
    scene.end_time = 0.03;
  }
  SECTION("by time, of which whole steps lack one unit in the last place") {
    scene.step.dt = 0.03;
    scene.end_time = 0.33;
    REQUIRE(11.0 * scene.step.dt < scene.end_time);
  }
  SECTION("by displacement") {
    scene.end_time = 1.0;
    scene.end_displacement = 0.001;
    key = "end.displacement_m";
  }
  for (const double every : {0.001, 0.002, 0.004, 0.015, 1.0}) {
    INFO(every);
    scene.output_every = every;
    struct Seen {
      std::vector<double> rows;
      std::string checkpoint;
      std::size_t rows_before = 0;  ///< the checkpoint
    };
    const auto watch = [](Seen& seen) {
      RunObserver observer;
      observer.output = [&](const Simulation& s) { seen.rows.push_back(s.time()); };
      observer.checkpoint = [&](Archive& state, const Simulation&) {
        seen.checkpoint = state.bytes();
        seen.rows_before = seen.rows.size();
      };
      return observer;
    };
    Seen first, second;
    Simulation whole(scene), again(scene);
    const RunResult result = run(whole, watch(first));
    REQUIRE(result.ended_by == key);
    REQUIRE(first.rows.back() == whole.time());
    Archive state(first.checkpoint);
    const RunResult resumed = ResumedRun(again, state).go_on(watch(second));
    CHECK(resumed.converged);
    CHECK(resumed.ended_by == key);
    CHECK(resumed.warnings == result.warnings);
    CHECK(second.rows == std::vector<double>(first.rows.begin() + static_cast<long>(first.rows_before), first.rows.end()));
    CHECK(second.checkpoint == first.checkpoint);
  }
}

TEST_CASE("checkpoints come on request only", "[analysis][checkpoint]") {
  Scene scene = prepared(test::falling_block(), "soft");
  scene.end_time = 0.01;
  int count = 0;
  RunObserver observer;
  observer.checkpoint = [&](Archive&, const Simulation&) { ++count; };
  Simulation simulation(scene);
  REQUIRE(run(simulation, observer).converged);
  CHECK(count == 0);
}

TEST_CASE("a run that ended within a step, or did not converge, goes on where it stood", "[analysis][checkpoint]") {
  Scene scene = prepared(test::falling_block(), "soft");
  scene.step.dt = 0.01;
  scene.step.max_displacement = 1.0;
  scene.end_time = 0.035;
  scene.checkpoint_every = 1.0;
  std::string saved;
  RunObserver observer;
  observer.checkpoint = [&](Archive& state, const Simulation&) { saved = state.bytes(); };
  double to = 0.1;
  SECTION("ended") {
    Simulation first(scene);
    REQUIRE(run(first, observer).converged);
  }
  SECTION("not converged") {
    // From rest by 1.7 mm a step at most: it gets stuck where 9.81 m/s2 would make it more.
    scene.end_time = 0.1;
    scene.step.max_displacement = 1.7e-3;
    scene.step.smallest_fraction = 1.0;
    Simulation first(scene);
    REQUIRE_FALSE(run(first, observer).converged);
    REQUIRE(first.time() < 0.03);
    scene.step.smallest_fraction = 1e-6;
    to = 0.05;
  }
  scene.end_time = to;
  Simulation second(scene);
  Archive state(saved);
  const RunResult result = ResumedRun(second, state).go_on({});
  CHECK(result.converged);
  CHECK(second.time() == to);
  CHECK(second.system().displacement(0)[1] == Approx(-0.5 * 9.81 * to * to).epsilon(1e-13));
}

TEST_CASE("a wrong number anywhere in a saved state is refused, or goes on as some number", "[analysis][checkpoint]") {
  const std::string method = GENERATE("soft", "hard", "shi", "dem");
  CAPTURE(method);
  const Scene scene = prepared(test::tumbling_blocks(), method);
  Simulation simulation(scene);
  for (int i = 0; i < 300; ++i) REQUIRE(simulation.advance(scene.step.dt));
  const std::string saved = state_of(simulation);
  const NonStop non_stop;
  // As a whole number beyond every list, as the upper half of a real one 2. Runs and searches are forged by tests/fuzz/every_number.cpp.
  constexpr char wrong[] = {'\xff', '\xff', '\xff', '\x3f'};
  int refused = 0;
  for (std::size_t at = 0; at + sizeof wrong <= saved.size(); ++at) {
    std::string forged = saved;
    forged.replace(at, sizeof wrong, wrong, sizeof wrong);
    Simulation again(scene);
    Archive archive(forged);
    try {
      archive(again);
    } catch (const DamagedState&) {
      ++refused;
      continue;
    }
    // A wrong stiffness may make the steps of dem as short as it likes.
    again.advance(0.01 * scene.step.dt);
  }
  CHECK(refused > 0);
}

TEST_CASE("a snapshot with a number that is none is of no simulation", "[analysis][checkpoint]") {
  const NonStop non_stop;
  Simulation simulation(prepared(test::tumbling_blocks(), "soft"));
  const Simulation::Snapshot sound = simulation.save();
  CHECK(simulation.fits(sound));
  const double none = std::numeric_limits<double>::quiet_NaN();
  Simulation::Snapshot wrong = sound;
  wrong.blocks.displacement[1].y() = none;
  CHECK_FALSE(simulation.fits(wrong));
  wrong = sound;
  wrong.blocks.velocity[1].x() = none;
  CHECK_FALSE(simulation.fits(wrong));
  wrong = sound;
  wrong.blocks.arm[2].x() = none;
  CHECK_FALSE(simulation.fits(wrong));
}
