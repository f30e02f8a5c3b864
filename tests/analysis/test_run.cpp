#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/hard_springs.h"
#include "openclose/scene/reader.h"
#include "overhanging_bricks.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::all_methods;

namespace {

std::vector<double> output_times(const Scene& scene) {
  Simulation simulation(scene);
  std::vector<double> times;
  RunObserver observer;
  observer.output = [&](const Simulation& s) { times.push_back(s.time()); };
  REQUIRE(run(simulation, observer).converged);
  return times;
}

}  // namespace

TEST_CASE("output comes at the start, at its interval and at the end", "[analysis][run]") {
  Scene scene = test::falling_block();
  scene.step.dt = 0.01;
  scene.end_time = 0.1;
  SECTION("every step") {
    const auto times = output_times(scene);
    REQUIRE(times.size() == 11);
    for (int i = 0; i <= 10; ++i) CHECK(times[i] == i * 0.01);
  }
  SECTION("every third step") {
    scene.output_every = 0.03;
    const auto times = output_times(scene);
    REQUIRE(times.size() == 5);
    CHECK(times[1] == 3 * 0.01);
    CHECK(times[4] == 10 * 0.01);
  }
  SECTION("a step that does not divide the end by rounding alone is not one more") {
    scene.step.dt = 0.1;
    scene.end_time = 0.3;
    CHECK(output_times(scene).size() == 4);
  }
}

TEST_CASE("the last step ends at the end time", "[analysis][run]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = test::falling_block();
    scene.method.contact = method;
    scene.step.dt = 0.03;
    scene.step.max_displacement = 1.0;
    scene.end_time = 0.1;
    CHECK(output_times(scene) == std::vector<double>{0.0, 0.03, 0.06, 0.09, 0.1});
    Simulation simulation(scene);
    REQUIRE(run(simulation, {}).converged);
    CHECK(simulation.system().displacement(0)[1] == Approx(-0.5 * 9.81 * 0.01).epsilon(1e-13));
    CHECK(simulation.velocity(0)[1] == Approx(-0.981).epsilon(1e-13));
  }
}

TEST_CASE("what a run tells while it goes on", "[analysis][run]") {
  Scene scene = test::block_on_base();
  scene.method.start = Start::settled;
  scene.end_time = 0.01;
  Simulation simulation(scene);
  std::vector<std::string> order;
  std::vector<double> fractions;
  RunObserver observer;
  observer.started = [&](const Simulation& s) {
    order.emplace_back("started");
    CHECK(s.time() == 0.0);
    CHECK(s.ledger().turnover == 0.0);
    CHECK(s.system().displacement(1)[1] < 0.0);
  };
  observer.output = [&](const Simulation&) { order.emplace_back("output"); };
  observer.progress = [&](double f) { fractions.push_back(f); };
  const RunResult result = run(simulation, observer);
  CHECK(result.converged);
  CHECK(result.reason.empty());
  CHECK(result.settling.settled);
  REQUIRE(order.size() == 12);
  CHECK(order[0] == "started");
  CHECK(order[1] == "output");
  REQUIRE(fractions.size() == 10);
  CHECK(fractions.front() == Approx(0.1));
  CHECK(fractions.back() == 1.0);
}

TEST_CASE("a settled start that does not exist ends the run with its reason", "[analysis][run]") {
  Scene scene = test::block_on_incline(40.0 * test::degree);
  scene.method.start = Start::settled;
  scene.settle.failure_displacement = 0.01;
  scene.end_time = 1.0;
  scene.snapshot_times = {0.0};
  scene.milestones = {0.5};
  Simulation simulation(scene);
  int outputs = 0, steps = 0;
  RunObserver observer;
  observer.output = [&](const Simulation&) { ++outputs; };
  observer.progress = [&](double) { ++steps; };
  const RunResult result = run(simulation, observer);
  CHECK_FALSE(result.converged);
  CHECK(result.reason ==
        "no static equilibrium to start from (displacement, limited by settle.failure_displacement_m): \"block\" slides along its joint with "
        "\"base\" towards (0.77, -0.64) (friction above 40 degrees under its weight alone, cohesion_pa or a [[support]] would hold it); "
        "method.start = \"unloaded\" starts in motion");
  CHECK(outputs == 1);
  CHECK(steps == 0);
  CHECK(result.warnings == std::vector<std::string>{"milestone 0.5 m not reached: the run had no state to start from",
                                                    "no snapshot at t = 0 s: the run had no state to start from"});
}

TEST_CASE("a search that is given up names the key that limits it", "[analysis][run]") {
  Scene scene = test::block_on_incline(40.0 * test::degree);
  scene.method.start = Start::settled;
  scene.settle.failure_displacement = 1e9;
  scene.settle.max_steps = scene.settle.max_explicit_steps = scene.settle.max_time_steps = 2;
  scene.end_time = 1.0;
  const auto reason = [&](const std::string& method, SettleCriterion criterion) {
    scene.method.contact = method;
    scene.settle.criterion = criterion;
    Simulation simulation(scene);
    return run(simulation, {}).reason;
  };
  CHECK_THAT(reason("soft", SettleCriterion::unbalanced_force), ContainsSubstring("(steps, limited by settle.max_steps)"));
  CHECK_THAT(reason("dem", SettleCriterion::unbalanced_force), ContainsSubstring("(steps, limited by settle.max_explicit_steps)"));
  for (const char* method : {"soft", "dem"})
    CHECK_THAT(reason(method, SettleCriterion::paper), ContainsSubstring("(steps, limited by settle.max_time_steps)"));
  scene.settle.max_explicit_steps = 10000;
  scene.settle.failure_displacement = 0.01;
  CHECK_THAT(reason("dem", SettleCriterion::unbalanced_force), ContainsSubstring("(displacement, limited by settle.failure_displacement_m)"));
}

TEST_CASE("what comes at longer intervals than the run takes does not come within it", "[analysis][run]") {
  for (const double interval : {0.011, 1e10, 1e20, 1e300}) {
    INFO(interval);
    Scene scene = test::falling_block();
    scene.end_time = 0.01;
    scene.output_every = scene.checkpoint_every = interval;
    Simulation simulation(scene);
    std::vector<double> rows, checkpoints;
    RunObserver observer;
    observer.output = [&](const Simulation& s) { rows.push_back(s.time()); };
    observer.checkpoint = [&](Archive&, const Simulation& s) { checkpoints.push_back(s.time()); };
    REQUIRE(run(simulation, observer).converged);
    CHECK(rows == std::vector<double>{0.0, simulation.time()});
    CHECK(checkpoints == std::vector<double>{simulation.time()});
  }
}

TEST_CASE("a run that gets stuck keeps what it has", "[analysis][run]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.blocks[1].vertices = test::rectangle(0.0, 0.001, 2.0, 1.0);
  scene.method.max_open_close_iterations = 1;
  scene.step.smallest_fraction = 0.5;
  scene.end_time = 1.0;
  Simulation simulation(scene);
  double last = -1.0;
  RunObserver observer;
  observer.output = [&](const Simulation& s) { last = s.time(); };
  const RunResult result = run(simulation, observer);
  CHECK_FALSE(result.converged);
  CHECK(result.reason == "open-close iterations did not settle");
  CHECK(last == simulation.time());
  // It fell for sqrt(2 * 1 mm / g) = 14.3 ms.
  CHECK(last == Approx(0.0143).margin(0.001));
}

TEST_CASE("settled blocks start with the velocities of the scene", "[analysis][run]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = test::block_on_base();
    scene.method.contact = method;
    scene.method.start = Start::settled;
    scene.blocks[1].velocity = {0.5, 0.0};
    Simulation simulation(scene);
    REQUIRE(prepare_start(simulation).converged);
    CHECK(simulation.velocity(1) == Eigen::Vector3d(0.5, 0.0, 0.0));
    CHECK(simulation.system().velocity(1) == Eigen::Vector3d(0.5, 0.0, 0.0));
    CHECK(simulation.time() == 0.0);
  }
}

TEST_CASE("without measured points the centroids of free blocks are", "[analysis][run]") {
  Simulation simulation(test::tumbling_blocks());
  const MeasuredPoints points(simulation);
  for (int i = 0; i < 100; ++i) REQUIRE(simulation.advance(1e-3));
  const auto motions = points.motions();
  REQUIRE(motions.size() == 3);
  const char* names[] = {"left", "right", "top"};
  for (int i = 0; i < 3; ++i) {
    CHECK(motions[i].name == names[i]);
    const auto d = simulation.system().displacement(i + 1), v = simulation.velocity(i + 1);
    CHECK((motions[i].displacement - d.head<2>()).norm() < 1e-14);
    CHECK((motions[i].velocity - v.head<2>()).norm() < 1e-13);
    CHECK(motions[i].rotation == d[2]);
  }
}

TEST_CASE("a measured point goes round with its block", "[analysis][run]") {
  Scene scene = test::empty_scene();
  scene.gravity = {0.0, 0.0};
  // Far from zero, so that a forgotten origin shows.
  scene.blocks = {test::free_block("block", test::rectangle(100.0, 50.0, 2.0, 1.0))};
  scene.blocks[0].angular_velocity = 0.5 * std::numbers::pi;
  scene.blocks[0].velocity = {0.3, 0.0};
  scene.measured_points = {{"corner", 0, {102.0, 51.0}}};
  Simulation simulation(scene);
  MeasuredPoints points(simulation);
  for (int i = 0; i < 1000; ++i) REQUIRE(simulation.advance(1e-3));
  // A quarter turn takes the arm (1, 0.5) to (-0.5, 1).
  const PointMotion m = points.motions().at(0);
  CHECK(m.name == "corner");
  CHECK((m.displacement - Vec2(0.3 - 1.5, 0.5)).norm() < 1e-11);
  CHECK(m.rotation == Approx(0.5 * std::numbers::pi).epsilon(1e-12));
  CHECK((m.velocity - Vec2(0.3 - 0.5 * std::numbers::pi, -0.25 * std::numbers::pi)).norm() < 1e-11);
  CHECK(points.largest_displacement() == Approx(std::hypot(1.2, 0.5)).epsilon(1e-11));

  SECTION("and counts from where it was restarted") {
    points.restart();
    CHECK(points.largest_displacement() == 0.0);
    for (int i = 0; i < 1000; ++i) REQUIRE(simulation.advance(1e-3));
    CHECK((points.motions().at(0).displacement - Vec2(0.3 - 0.5, -1.5)).norm() < 1e-11);
    CHECK(points.motions().at(0).rotation == Approx(0.5 * std::numbers::pi).epsilon(1e-12));
  }
}

namespace {

constexpr double slope = 20.0 * test::degree;

/// Holds with its own friction of 30 degrees, slides with half of it.
Scene reduced_slider(Start start) {
  Scene scene = test::block_on_incline(slope);
  scene.method.start = start;
  scene.run_strength_reduction_factor = 2.0;
  scene.end_time = 0.4;
  return scene;
}

double sliding_distance(double time) {
  return 0.5 * 9.81 * (std::sin(slope) - 0.5 * std::tan(30.0 * test::degree) * std::cos(slope)) * time * time;
}

}  // namespace

TEST_CASE("a run with reduced strength settles with the full one and slides with the reduced one", "[analysis][run]") {
  for (const std::string method : {"soft", "hard"}) {
    INFO(method);
    Scene scene = reduced_slider(Start::settled);
    scene.method.contact = method;
    Simulation simulation(scene);
    MeasuredPoints points(simulation);
    RunObserver observer;
    observer.started = [&](const Simulation& s) {
      points.restart();
      CHECK(s.ledger().turnover == 0.0);
    };
    const RunResult result = run(simulation, observer);
    REQUIRE(result.converged);
    CHECK(result.settling.settled);
    // The shear springs that held the block let go in the first hundredth of a second: W sin(slope)/ks is less than 0.1 mm.
    CHECK(points.largest_displacement() == Approx(sliding_distance(0.4)).margin(5e-4));
    CHECK(std::abs(simulation.ledger().imbalance()) < 1e-10 * simulation.ledger().turnover);
  }
}

TEST_CASE("what settling may leave unbalanced sets nothing in motion", "[analysis][run]") {
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml", {"method.contact=\"soft\""});
  scene.run_strength_reduction_factor = 1.0;
  scene.end_displacement.reset();
  scene.milestones.clear();
  scene.end_time = 10 * scene.step.dt;
  Simulation simulation(scene);
  long iterations_of_start = 0;
  std::vector<Eigen::Vector3d> settled;
  RunObserver observer;
  observer.started = [&](const Simulation& s) {
    iterations_of_start = s.state().counters.iterations;
    settled = s.system().state().displacement;
  };
  const RunResult result = run(simulation, observer);
  REQUIRE(result.converged);
  REQUIRE(result.settling.unbalanced_fraction > tolerance::rest);
  CHECK(simulation.state().counters.iterations == iterations_of_start);
  CHECK(simulation.system().state().displacement == settled);
}

TEST_CASE("what the paper takes for equilibrium is where a run starts that asks for it", "[analysis][run]") {
  Scene scene = test::block_on_base();
  scene.settle.criterion = SettleCriterion::paper;
  scene.method.start = Start::settled;
  scene.end_time = scene.step.dt;
  Simulation simulation(scene);
  long steps_of_start = 0;
  RunObserver observer;
  observer.started = [&](const Simulation& s) { steps_of_start = s.state().counters.steps; };
  const RunResult result = run(simulation, observer);
  REQUIRE(result.converged);
  REQUIRE(result.settling.steps > 0);
  CHECK(steps_of_start == result.settling.steps);
}

TEST_CASE("a run starts from the equilibrium of the method that settles it, and stays there", "[analysis][run]") {
  // What friction holds in a slope depends on the way to its equilibrium.
  const auto scene_of = [](const std::string& contact, const std::string& by) {
    Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml");
    scene.method.contact = contact;
    scene.settled_by = by;
    scene.run_strength_reduction_factor = 1.0;
    scene.end_displacement.reset();
    scene.milestones.clear();
    scene.end_time = 0.1;
    return scene;
  };
  struct Way {
    std::vector<Eigen::Vector3d> settled;
    double moved = 0.0;  // [m] since, at most
  };
  const auto follow = [&](const Scene& scene) {
    Simulation simulation(scene);
    Way way;
    RunObserver observer;
    observer.started = [&](const Simulation& s) { way.settled = s.system().state().displacement; };
    REQUIRE(run(simulation, observer).converged);
    for (std::size_t b = 0; b < way.settled.size(); ++b) {
      const Eigen::Vector3d moved = simulation.system().state().displacement[b] - way.settled[b];
      way.moved = std::max(way.moved, moved.head<2>().norm());
    }
    return way;
  };
  const auto largest_difference = [](const Way& a, const Way& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.settled.size(); ++i) largest = std::max(largest, (a.settled[i] - b.settled[i]).head<2>().norm());
    return largest;
  };
  const Way soft = follow(scene_of("soft", "soft")), dem = follow(scene_of("dem", "dem"));
  Scene with_integrator = scene_of("soft", "dem");
  with_integrator.method.integrator = "path_average";  // dem has none
  Scene in_statics = scene_of("soft", "dem");
  in_statics.method.statics = true;  // dem knows none
  const Way soft_by_dem = follow(with_integrator), statics_by_dem = follow(in_statics), dem_by_soft = follow(scene_of("dem", "soft"));
  CHECK(largest_difference(soft, dem) > 1e-4);
  CHECK(largest_difference(soft, dem_by_soft) == 0.0);
  CHECK(largest_difference(dem, soft_by_dem) == 0.0);
  CHECK(largest_difference(dem, statics_by_dem) == 0.0);
  for (const Way& way : {soft, dem, soft_by_dem, statics_by_dem, dem_by_soft}) CHECK(way.moved < 1e-6);
}

TEST_CASE("only methods with springs of the joints share their equilibria", "[analysis][run]") {
  Scene scene = test::block_on_base();
  scene.settled_by_where = {"scene.toml", 9};
  const auto refusal = [&](const std::string& contact, const std::string& by) {
    scene.method.contact = contact;
    scene.settled_by = by;
    try {
      Simulation simulation(scene);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const std::string contact : {"soft", "dem"}) {
    for (const std::string by : {"soft", "dem"}) CHECK(refusal(contact, by).empty());
    for (const std::string by : {"hard", "shi", "softer"})
      CHECK_THAT(refusal(contact, by), ContainsSubstring("scene.toml:9: run.settled_by: no equilibrium of \"" + by + "\" is one for"));
    CHECK_THAT(refusal("hard", contact), ContainsSubstring("run.settled_by"));
  }
  CHECK(refusal("hard", "hard").empty());
}

TEST_CASE("starts that do not settle have the reduced strength from the beginning", "[analysis][run]") {
  const Start start = GENERATE(Start::unloaded, Start::normal_balanced, Start::steady_sliding, Start::settled);
  Simulation simulation(reduced_slider(start));
  REQUIRE(prepare_start(simulation).converged);
  CHECK(simulation.joints().joint(0).friction_angle == Approx(std::atan(0.5 * std::tan(30.0 * test::degree))).epsilon(1e-15));
}

TEST_CASE("steady sliding goes on as it starts with reduced strength, too", "[analysis][run]") {
  Simulation simulation(reduced_slider(Start::steady_sliding));
  MeasuredPoints points(simulation);
  RunObserver observer;
  observer.started = [&](const Simulation&) { points.restart(); };
  REQUIRE(run(simulation, observer).converged);
  CHECK(points.largest_displacement() == Approx(sliding_distance(0.4)).epsilon(1e-9));
}

TEST_CASE("a run ends by displacement or by time and says which", "[analysis][run]") {
  Scene scene = test::falling_block();
  scene.end_displacement = 1.0;
  const double fall = std::sqrt(2.0 / 9.81);
  SECTION("far enough") {
    scene.end_time = 10.0;
    scene.output_every = 0.1;
    Simulation simulation(scene);
    double last_output = 0.0, last_share = 0.0;
    RunObserver observer;
    observer.output = [&](const Simulation& s) { last_output = s.time(); };
    observer.progress = [&](double share) { last_share = share; };
    const RunResult result = run(simulation, observer);
    CHECK(result.converged);
    CHECK(result.ended_by == "end.displacement_m");
    CHECK(result.warnings.empty());
    CHECK(simulation.time() >= fall);
    CHECK(simulation.time() < fall + scene.step.dt);
    CHECK(last_output == simulation.time());
    CHECK(last_share == 1.0);
  }
  SECTION("not before its time") {
    scene.end_time = 0.4;
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    CHECK(result.converged);
    CHECK(result.ended_by == "end.time_s");
    REQUIRE(result.warnings.size() == 1);
    CHECK_THAT(result.warnings[0], ContainsSubstring("the run ended at t = 0.4 s, before any measured point had moved 1 m: farthest 0.7848 m"));
  }
}

TEST_CASE("milestones are timed within the step", "[analysis][run]") {
  Scene scene = test::falling_block();
  scene.milestones = {0.1, 0.1001, 0.5, 2.0};
  scene.end_time = 0.5;
  Simulation simulation(scene);
  std::vector<std::string> states;
  RunObserver observer;
  observer.snapshot = [&](const std::string& state, const Simulation&) { states.push_back(state); };
  const RunResult result = run(simulation, observer);
  REQUIRE(result.milestones.size() == 4);
  double cpu = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Milestone& m = result.milestones[i];
    CHECK(m.displacement == scene.milestones[i]);
    const double exact = std::sqrt(2.0 * m.displacement / 9.81);
    // Constant acceleration is integrated exactly; a chord of the parabola lies g dt^2/8 at most beside it.
    REQUIRE(m.time);
    CHECK(*m.time == Approx(exact).margin(scene.step.dt * scene.step.dt / (8.0 * exact) * 1.01));
    CHECK(m.reason.empty());
    CHECK(m.cpu_of_motion >= cpu);
    CHECK(m.cpu_of_program >= m.cpu_of_motion);
    cpu = m.cpu_of_motion;
  }
  CHECK(result.cpu_of_motion >= cpu);
  CHECK_FALSE(result.milestones[3].time);
  CHECK(result.milestones[3].reason == "the run ended at t = 0.5 s with the first measured point moved by 1.22625 m");
  CHECK(result.warnings == std::vector<std::string>{"milestone 2 m not reached: " + result.milestones[3].reason});
  CHECK(states == std::vector<std::string>{"moved 0.1 m", "moved 0.1001 m", "moved 0.5 m"});
}

TEST_CASE("an end by displacement does not stop the explicit loop in every step", "[analysis][run]") {
  Scene scene = test::block_on_incline(40.0 * test::degree);
  scene.method.contact = "dem";
  scene.measured_points = {{"corner", 1, scene.blocks[1].vertices[0]}};
  scene.milestones = {0.01, 0.02};
  scene.end_displacement = 0.04;
  scene.output_every = 0.05;
  scene.end_time = 5.0;
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).ended_by == "end.displacement_m");
  CHECK(simulation.state().counters.steps > 100);
  CHECK(simulation.state().counters.loads < 20);
}

TEST_CASE("snapshots are taken after the nearest step", "[analysis][run]") {
  Scene scene = test::falling_block();
  scene.step.dt = 0.03;
  scene.step.max_displacement = 1.0;
  scene.end_time = 0.1;
  scene.snapshot_times = {0.0, 0.044, 0.046, 0.0949, 0.1, 0.11};
  Simulation simulation(scene);
  std::vector<std::pair<std::string, double>> taken;
  RunObserver observer;
  observer.snapshot = [&](const std::string& state, const Simulation& s) { taken.emplace_back(state, s.time()); };
  const RunResult result = run(simulation, observer);
  const std::vector<std::pair<std::string, double>> expected{{"t=0", 0.0}, {"t=0.044", 0.03}, {"t=0.046", 0.06}, {"t=0.0949", 0.09}, {"t=0.1", 0.1}};
  CHECK(taken == expected);
  CHECK(result.warnings == std::vector<std::string>{"no snapshot at t = 0.11 s: the run ended at t = 0.1 s"});
}

TEST_CASE("a run that does not start has no milestones and says so", "[analysis][run]") {
  Scene scene = test::block_on_incline(40.0 * test::degree);
  scene.method.start = Start::settled;
  scene.settle.failure_displacement = 0.01;
  scene.end_time = 1.0;
  scene.milestones = {1.0};
  scene.snapshot_times = {0.5};
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  CHECK_FALSE(result.converged);
  CHECK(result.ended_by.empty());
  REQUIRE(result.milestones.size() == 1);
  CHECK_FALSE(result.milestones[0].time);
  CHECK_FALSE(result.milestones[0].reason.empty());
  CHECK(result.warnings.size() == 2);
}

TEST_CASE("settling tells how far it is", "[analysis][run]") {
  Scene scene = test::column_of_blocks(3);
  scene.method.start = Start::settled;
  scene.settle.criterion = GENERATE(SettleCriterion::unbalanced_force, SettleCriterion::paper);
  Simulation simulation(scene);
  std::vector<double> shares;
  const RunResult result = prepare_start(simulation, [&](double share) { shares.push_back(share); });
  REQUIRE(result.converged);
  CHECK(static_cast<int>(shares.size()) == result.settling.steps);
  for (double share : shares) CHECK((share >= 0.0 && share <= 1.0));
  CHECK(shares.back() == 1.0);
}

TEST_CASE("hard takes a slope that gravity meets at once in long steps", "[analysis][run][hard]") {
  // Thousands of contacts change their states in the first steps.
  const auto counters = [](const std::string& contact) {
    Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml");
    scene.method.contact = contact;
    scene.method.start = Start::unloaded;
    scene.step.dt = 0.02;
    scene.end_time = 0.5;
    Simulation simulation(scene);
    REQUIRE(run(simulation, {}).converged);
    if (contact == "hard") CHECK(simulation.max_penetration() < (kept_penetration + incompatible_gaps) * scene.method.gap_tolerance);
    return simulation.state().counters;
  };
  const StepCounters hard = counters("hard"), soft = counters("soft");
  CHECK(hard.iterations < 2 * soft.iterations);  // an iteration of hard, without dashpots and with fewer contacts closed, is the cheaper one
}

TEST_CASE("hard takes slopes of a thousand and more blocks that gravity meets at once in steps that are hardly cut", "[analysis][run][hard]") {
  // Columns of twenty blocks, whose multipliers no passes of the first step find; ramps of the cohesion on which Newton's method gets lost.
  const double spacing = GENERATE(0.84, 0.68, 0.44);  // [-] of that of the paper's slope: 625, 978 and 2,252 blocks
  Scene scene = read_scene(std::string(OPENCLOSE_PAPER_SCENES) + "/example_3_4_post_failure.toml",
                           {fmt::format("joint_set[0].spacing_m={}", 40.0 * spacing), fmt::format("joint_set[1].spacing_m={}", 10.0 * spacing)});
  scene.method.contact = "hard";
  scene.method.start = Start::unloaded;
  scene.end_time = 0.3;
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).converged);
  const StepCounters& counters = simulation.state().counters;
  CHECK(counters.eased <= 1);
  CHECK(counters.steps < 2 * 30);
  CHECK(counters.iterations < scene.method.max_iterations * 30);  // the price of one attempt in vain for each step
  CHECK(simulation.max_penetration() < 5e-6);
  CHECK(std::abs(simulation.ledger().imbalance()) < 1e-10 * simulation.ledger().turnover);
}

TEST_CASE("a run of shi says how far the friction of sliding contacts lags behind", "[analysis][run]") {
  const auto result_of = [](Scene scene, double& lag) {
    scene.method.contact = "shi";
    test::use_joint_springs_as_penalty(scene);
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    lag = simulation.friction_lag();
    CHECK((result.converged || result.refused));  // by the watch: blocks that hit each other gain energy in steps of this length
    return result.warnings;
  };
  double lag = 0.0;
  SECTION("not where the normal force stays as it is") {
    Scene scene = test::block_on_incline(0.6);
    scene.joints[0].friction_angle = 0.3;
    scene.method.start = Start::steady_sliding;
    scene.end_time = 0.1;
    CHECK(result_of(scene, lag).empty());
    CHECK(lag < 1e-3);
  }
  SECTION("nor where blocks hit each other") {
    Scene scene = test::tumbling_blocks();
    scene.end_time = 0.4;
    // What friction drives is another matter, see Watch.
    CHECK(std::ranges::none_of(result_of(scene, lag), [](const std::string& words) { return words.starts_with("friction of sliding contacts"); }));
    CHECK(lag < 0.01);
  }
  SECTION("but where friction does not settle") {
    // The tip of a rod that is pushed is jammed by its friction: the more there is, the larger the normal force.
    Scene scene = test::empty_scene();
    scene.joints[0].friction_angle = 80.0 * test::degree;
    scene.blocks = {test::fixed_block("base", test::rectangle(-20.0, -1.0, 40.0, 1.0)),
                    test::free_block("rod", test::placed(test::rectangle(0.0, 0.0, 2.0, 0.06), 155.0 * test::degree, {0.0, 0.06}))};
    scene.blocks[1].velocity = {-10.0, 0.0};
    scene.method.start = Start::unloaded;
    scene.end_time = 0.5;
    const std::vector<std::string> warnings = result_of(scene, lag);
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], ContainsSubstring("friction of sliding contacts") && ContainsSubstring("method.contact = \"soft\" would be a remedy"));
    CHECK(lag > 0.01);
  }
}

TEST_CASE("blocks of shi slide by the friction of their own normal forces", "[analysis][run]") {
  // Pushed up a slope: the block comes to rest after v^2 / (2 g (sin + tan(phi) cos)), if its friction is that of its weight.
  Scene scene = test::block_on_incline(30.0 * test::degree);
  scene.joints[0].friction_angle = 35.0 * test::degree;
  scene.method.contact = "shi";
  scene.method.start = Start::normal_balanced;
  scene.blocks[1].velocity = {-4.0 * std::cos(30.0 * test::degree), 4.0 * std::sin(30.0 * test::degree)};
  scene.end_time = 1.0;
  const double exact = 16.0 / (2.0 * 9.81 * (std::sin(30.0 * test::degree) + std::tan(35.0 * test::degree) * std::cos(30.0 * test::degree)));
  for (const double dt : {5e-3, 2e-3, 5e-4}) {
    scene.step.dt = dt;
    Simulation simulation(scene);
    CHECK(run(simulation, {}).converged);
    const double way = Motion::translation(simulation.system().displacement(1)).norm();
    CHECK(way == Approx(exact).epsilon(0.01));
    CHECK(simulation.friction_lag() < 0.01);
  }
}

TEST_CASE("what a small block of shi misses of its friction does not hide behind what a large one works", "[analysis][run]") {
  Scene scene = test::scene_with({test::fixed_block("base", test::rectangle(-10.0, -1.0, 40.0, 1.0)),
                                  test::free_block("heavy", test::rectangle(0.0, 0.0, 10.0, 2.0)),
                                  test::free_block("light", test::rectangle(15.0, 0.0, 0.5, 0.5))});
  scene.joints[0].friction_angle = 40.0 * test::degree;
  scene.blocks[1].velocity = {6.0, 0.0};
  scene.blocks[2].velocity = {1.5, 0.0};
  scene.method.contact = "shi";
  scene.end_time = 0.5;
  for (const double dt : {1e-2, 2e-3}) {
    scene.step.dt = dt;
    Simulation simulation(scene);
    CHECK(run(simulation, {}).converged);
    CHECK(simulation.system().displacement(2)[0] == Approx(1.5 * 1.5 / (2.0 * 9.81 * std::tan(40.0 * test::degree))).epsilon(0.01));
  }
}

TEST_CASE("a motion of shi by a friction of other normal forces is refused", "[analysis][run]") {
  Scene scene = test::block_on_incline(0.6);
  scene.joints[0].friction_angle = 0.3;
  scene.method.contact = "shi";
  scene.method.start = Start::steady_sliding;
  scene.end_time = 0.1;
  Simulation as_it_is(scene);
  REQUIRE(run(as_it_is, {}).converged);
  const double energy = as_it_is.ledger().turnover;
  const auto with_missed = [&](double share_of_energy) {
    Simulation simulation(scene);
    // The passes of the method miss little; what is asked here is what the run makes of much.
    RunObserver observer;
    observer.started = [&](const Simulation& begun) {
      const_cast<SimulationState&>(begun.state()).lagging_friction_work = share_of_energy * energy;
      const_cast<SimulationState&>(begun.state()).friction_work = energy;
    };
    return run(simulation, observer);
  };
  const RunResult little = with_missed(0.09), much = with_missed(0.11);
  CHECK(little.converged);
  REQUIRE(little.warnings.size() == 1);
  CHECK(much.refused);
  CHECK(much.ended_by.empty());
  CHECK_THAT(much.reason, ContainsSubstring("friction of sliding contacts") && ContainsSubstring("method.contact = \"soft\" would be a remedy"));
}

TEST_CASE("steps that are long for the slip-weakening distance are worth a warning, adaptive ones are short enough", "[analysis][run]") {
  // Thrown over its base, 1 m/s: friction falls within a slip of 2 cm.
  Scene scene = test::block_on_base();
  scene.blocks[1].velocity = {1.0, 0.0};
  scene.blocks[1].rotation_locked = true;
  scene.method.start = Start::normal_balanced;
  scene.joints[0].residual_friction_angle = 0.5 * scene.joints[0].friction_angle;
  scene.joints[0].slip_weakening_distance = 0.02;
  scene.step.dt = 0.01;
  scene.end_time = 0.1;
  const auto weakening = [](const Scene& s) {
    Simulation simulation(s);
    const RunResult result = run(simulation, {});
    REQUIRE(result.converged);
    const double most = simulation.state().fastest_weakening;
    const auto is_of_it = [](const std::string& warning) { return warning.find("slip_weakening_distance_m") != std::string::npos; };
    CHECK(std::ranges::any_of(result.warnings, is_of_it) == (most > 0.1));
    return most;
  };
  CHECK(weakening(scene) > 0.4);  // 1 cm of 2 at most
  CHECK(weakening(scene) <= 0.5);
  scene.step.dt = 1e-3;
  CHECK(weakening(scene) == Approx(0.05).epsilon(0.05));
  scene.step.dt = 0.01;
  scene.step.adaptive = true;
  CHECK(weakening(scene) < 0.02 * 1.001);
  // What breaks at the first slip does so in any step.
  scene.step.adaptive = false;
  scene.joints[0].slip_weakening_distance = 0.0;
  CHECK(weakening(scene) == 0.0);
}

TEST_CASE("integrators whose dashpots converge to another motion say so", "[analysis][run]") {
  // A block that hits the base flat: with dashpots of 0.3 it rebounds at 0.35 of its speed.
  const std::string integrator = GENERATE("theta", "generalized_alpha", "tr_bdf2", "shi", "path_average");
  const double damping = GENERATE(0.0, 0.3);
  CAPTURE(integrator, damping);
  Scene scene = test::block_on_base();
  scene.gravity.setZero();
  scene.blocks[1].velocity = {0.0, -1.0};
  scene.blocks[1].rotation_locked = true;
  scene.joints[0].damping_ratio = damping;
  scene.method.integrator = integrator;
  if (integrator == "theta") scene.method.theta = 0.5;
  scene.step.dt = 1e-5;
  scene.end_time = 0.01;
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  REQUIRE(result.converged);
  const bool exact = integrator == "shi" || integrator == "path_average";
  const auto warnings = std::ranges::count_if(result.warnings, [](const std::string& words) { return words.starts_with("dashpots took "); });
  CHECK(warnings == (exact || damping == 0.0 ? 0 : 1));
  // The contact ends where k x + c v = 0; two of half the length give the block a damping of its own of the root of two times the joint's.
  if (exact && damping > 0.0) CHECK(simulation.velocity(1).y() == Approx(0.3460).epsilon(0.01));
}

TEST_CASE("a run of rigid contacts does not start from forces that nothing has brought about", "[analysis][run]") {
  Scene scene;
  SECTION("where steps are cut on the way to them") {
    scene = test::overhanging_bricks();
  }
  SECTION("where joints have a tensile strength, too") {
    const double leaning = 2.0 * test::degree;
    scene =
        test::overhanging_bricks(2, {9.81 * std::sin(leaning), -9.81 * std::cos(leaning)}, test::frictional_joint(1e12, 1e11, 35.0 * test::degree));
    scene.joints[0].tensile_strength = 1.0;
  }
  SECTION("where blocks move on in one pass") {
    scene = test::overhanging_bricks(3, {1.17790118279283, -9.739027097383767},
                                     test::frictional_joint(364255631.41326445, 72851126.2826529, 19.637598603552853 * test::degree));
    scene.materials[0].density = 2874.0765943510937;
    scene.loads = {{4, {1.0, 1.0999999999999999}, {243.74627937717378, -12473.221123731833}}};
  }
  scene.method.start = Start::settled;
  for (const std::string& method : all_methods) {
    INFO(method);
    scene.method.contact = method;
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    CHECK_FALSE(result.converged);
    CHECK_THAT(result.reason, Catch::Matchers::StartsWith("no static equilibrium to start from"));
  }
}

TEST_CASE("a brick topples off a ledge in steps however short", "[analysis][run]") {
  // About the edge that it rests on, 0.3 m below its middle, with I / m = 1.36 / 12 + 0.09: from rest (tan 6 deg) (cosh (lambda t) - 1), up to the
  // cube of that angle.
  constexpr double end = 0.1, gyration = 1.36 / 12.0 + 0.09;
  const double leaning = 6.0 * test::degree, lambda = std::sqrt(9.81 * std::cos(leaning) * 0.3 / gyration);
  const double exact = -std::tan(leaning) * (std::cosh(lambda * end) - 1.0);
  for (const std::string method : {"soft", "hard"}) {
    for (const double dt : {1e-3, 2e-4}) {
      CAPTURE(method, dt);
      Scene scene = test::overhanging_bricks();
      scene.joints[0] = test::frictional_joint(1e12, 1e11, 35.0 * test::degree);
      scene.method.contact = method;
      scene.step.dt = dt;
      scene.end_time = end;
      Simulation simulation(scene);
      REQUIRE(run(simulation, {}).converged);
      // A motion that is late by one step of 1 ms has turned by 2 % less.
      CHECK(Motion::rotation(simulation.system().displacement(4)) == Approx(exact).epsilon(2.0 * 1e-3 / end));
    }
  }
}

namespace {

constexpr double sliding_step = 1e-3;  // [s]

/// [m] Along x, of the first block, which begins to slide from where it hangs on its strength.
double way_from_steady_sliding(Scene scene, const std::string& method, double end) {
  scene.method.contact = method;
  scene.method.start = Start::steady_sliding;
  scene.step.dt = sliding_step;
  scene.end_time = end;
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).converged);
  return Motion::translation(simulation.system().displacement(0)).x();
}

}  // namespace

TEST_CASE("cohesion in a motion acts where faces touch, whole ground or cut", "[analysis][run]") {
  // The ground falls away by 3 degrees under 45 % of the block, where it does not touch. With cohesion along the whole of its lower side it would
  // stand.
  constexpr double end = 0.3, width = 4.0, height = 0.5, touching = 0.55 * width, factor = 0.85;
  const double dip = 25.0 * test::degree, friction = 1.0 * test::degree, fall = std::tan(3.0 * test::degree) * (20.0 - touching);
  const std::vector<Vec2> left{{-20.0, -6.0}, {1.0, -6.0}, {touching, 0.0}, {-20.0, 0.0}},
      right{{1.0, -6.0}, {20.0, -6.0}, {20.0, -fall}, {touching, 0.0}};
  for (const bool is_cut : {false, true}) {
    for (const std::string& method : all_methods) {
      CAPTURE(method, is_cut);
      std::vector<BlockInput> blocks;
      blocks.push_back(test::free_block("block", test::rectangle(0.0, 0.0, width, height)));
      if (is_cut) {
        blocks.push_back(test::fixed_block("left", left));
        blocks.push_back(test::fixed_block("right", right));
      } else {
        blocks.push_back(test::fixed_block("ground", {left[0], right[1], right[2], left[2], left[3]}));
      }
      Scene scene = test::scene_with(blocks);
      scene.gravity = {9.81 * std::sin(dip), -9.81 * std::cos(dip)};
      scene.joints[0] = test::frictional_joint(1e10, 4e9, friction);
      const double weight = 9.81 * scene.materials[0].density * width * height;
      scene.joints[0].cohesion = weight * (factor * std::sin(dip) - std::cos(dip) * std::tan(friction)) / touching;
      // As it slides it loses half of its way of the face that carries its cohesion, and one step may go by before it moves.
      const double slid = way_from_steady_sliding(scene, method, end);
      const double exact = 0.5 * 9.81 * std::sin(dip) * (1.0 - factor) * end * end;
      CHECK(slid == Approx(exact).epsilon(factor / (1.0 - factor) * 0.5 * exact / touching + 2.0 * sliding_step / end));
    }
  }
}

TEST_CASE("the bond of a block that slides on to more of a face stays that of the drawing", "[analysis][run]") {
  // Drawn on 0.8 m of its 1 m, and pushed up the ground by nine eighths of what its cohesion carries there; with what it carries along the whole of
  // its lower side the block would stop.
  constexpr double end = 0.8, touching = 0.8, push = 4.0;
  for (const std::string& method : all_methods) {
    for (const CohesionBehaviour behaviour : {CohesionBehaviour::lost_on_opening, CohesionBehaviour::ductile}) {
      CAPTURE(method, static_cast<int>(behaviour));
      Scene scene = test::scene_with({test::free_block("block", test::rectangle(0.0, 0.0, 1.0, 0.2)),
                                      test::fixed_block("ground", test::rectangle(-5.0, -1.0, 5.0 + touching, 1.0))});
      scene.gravity = {-push, -9.0};
      scene.joints[0] = test::frictional_joint(1e9, 1e9, 0.0);
      const double mass = scene.materials[0].density * 0.2;
      scene.joints[0].cohesion = mass * push * 8.0 / 9.0 / touching;
      scene.joints[0].cohesion_behaviour = behaviour;
      const double slid = -way_from_steady_sliding(scene, method, end);
      // Ductile cohesion acts along what touches: x'' = push (1 - 8/9 (1 + x/0.8)), a harmonic half wave.
      const double rate = std::sqrt(push * 8.0 / 9.0 / touching), swing = touching / 8.0;
      const double exact = behaviour == CohesionBehaviour::ductile ? swing * (1.0 - std::cos(rate * end)) : 0.5 * push / 9.0 * end * end;
      // One step may go by before it moves, and lengths are found anew once it has moved by the skin: cohesion, eight times as much as what drives
      // the block, is that of the length before.
      const double behind = behaviour == CohesionBehaviour::ductile ? 8.0 * tolerance::contact_skin_m / touching : 0.0;
      CHECK(slid == Approx(exact).epsilon(2.0 * sliding_step / end + behind));
    }
  }
}

TEST_CASE("adaptive steps do not wait for a spring that is relieved at once", "[analysis][run]") {
  // With less strength than what its spring carries a slab slips by the rest of the spring's stretch however short the step is: 0.2 mm of 1.
  Scene scene = test::block_on_base();
  scene.gravity = {4.0, -10.0};
  scene.method.start = Start::settled;
  scene.joints[0].shear_stiffness = 1e7;
  scene.joints[0].residual_friction_angle = 0.9 * scene.joints[0].friction_angle;
  scene.joints[0].slip_weakening_distance = 1e-3;
  scene.run_strength_reduction_factor = 1.6;
  scene.step.dt = 0.01;
  scene.step.adaptive = true;
  scene.end_time = 0.1;
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  INFO(result.reason);
  CHECK(result.converged);
  CHECK(simulation.time() == Approx(0.1));
}

TEST_CASE("who takes no adaptive steps is not advised to", "[analysis][run]") {
  for (const std::string method : {"soft", "hard"}) {
    Scene scene = test::block_on_base();
    scene.method.contact = method;
    scene.blocks[1].velocity = {1.0, 0.0};
    scene.method.start = Start::normal_balanced;
    scene.joints[0].residual_friction_angle = 0.5 * scene.joints[0].friction_angle;
    scene.joints[0].slip_weakening_distance = 0.02;
    scene.step.dt = 0.01;
    scene.end_time = 0.05;
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    const auto names = [&](const char* words) {
      return std::ranges::any_of(result.warnings, [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
    };
    INFO(method);
    CHECK(names("slip_weakening_distance_m"));
    CHECK(names("step.adaptive") == (method == "soft"));
  }
}

TEST_CASE("a motion that stands on joints that would crack where they are bent says so", "[analysis][run]") {
  // An overhang of 2 m x 1 m: 6 M/L^2 at the wall; each of its two ends bears three times that. What touches goes by the size of the blocks: of
  // blocks 50 times larger the ends part by centimetres.
  const double size = GENERATE(1.0, 50.0);
  const bool skip_resting = GENERATE(false, true);
  for (const std::string& method : test::all_methods) {
    CAPTURE(method, size, skip_resting);
    Scene scene = test::scene_with({test::fixed_block("wall", test::rectangle(-size, -size, size, 3.0 * size)),
                                    test::free_block("beam", test::rectangle(0.0, 0.0, 2.0 * size, size))});
    scene.method.contact = method;
    scene.method.skip_resting = skip_resting;
    scene.method.start = Start::settled;
    scene.end_time = skip_resting ? 0.2 : 0.01;
    const double at_edge = 6.0 * test::block_weight * size;
    scene.joints[0].cohesion = 1e3 * at_edge;
    const auto warning = [&](double tension) -> std::string {
      scene.joints[0].tensile_strength = tension;
      Simulation simulation(scene);
      const RunResult result = run(simulation, {});
      CHECK(result.converged);
      CHECK((simulation.state().counters.block_steps_skipped > 0) == skip_resting);
      for (const std::string& w : result.warnings) {
        if (w.find("crack") != std::string::npos) return w;
      }
      return "";
    };
    CHECK(warning(1.2 * at_edge).empty());
    // A joint that just bears its load is no crack; at rest forces are out of balance by 1e-8 of the largest.
    CHECK(warning((1.0 + 5e-7) * at_edge).empty());
    CHECK(warning(0.5 * at_edge).find("at 1 contacts joints are bent by up to 2 times") == 0);
  }
}
