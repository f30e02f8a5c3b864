// Blocks at rest are left alone, and nothing that happens to them is lost.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/integrators.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;
using openclose::test::degree;

namespace {

/// With dashpots, so that what drops by its closure comes to rest soon; the scheme of `shi` sees to that alone.
Scene prepared(Scene scene, const std::string& method, bool skips) {
  scene.joints[0].damping_ratio = method == "shi" ? 0.0 : 0.5;
  scene.method.contact = method;
  scene.method.gap_tolerance = 3e-7;
  scene.method.penetration_tolerance = 0.1;
  scene.method.max_open_close_iterations = 40;
  if (method == "shi") test::use_joint_springs_as_penalty(scene);
  scene.method.step_fraction = 0.1;  // dem: steps that resolve impacts, so that their number does not matter
  scene.method.skip_resting = skips;
  return scene;
}

struct Follower {
  explicit Follower(const Scene& scene) : simulation(scene) { simulation.allow_resting(); }

  void go(double seconds) {
    const double dt = simulation.scene().step.dt;
    for (long i = 0; i < std::lround(seconds / dt); ++i) {
      const bool advanced = simulation.advance(dt);
      INFO(simulation.reason());
      REQUIRE(advanced);
    }
  }
  // Asked as a constant: others wake what rests.
  const BlockSystem& system() const { return simulation.system(); }
  int resting() const { return static_cast<int>(system().resting_blocks().size()); }
  Vec2 way(int b) const { return Motion::translation(system().displacement(b)); }
  double speed(int b) const { return Motion::translation(simulation.velocity(b)).norm(); }

  Simulation simulation;
};

/// [m/s] The velocity that the rule may deny a block.
double denied_velocity(const RestInput& rest) {
  return rest.acceleration * rest.time;
}

/// Three columns of three blocks side by side, and one that comes sliding over a shelf, at 4 m/s to begin with.
Scene slide_over_columns() {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base", test::rectangle(-10.0, -1.0, 30.0, 1.0))};
  for (int i = 0; i < 9; ++i)
    scene.blocks.push_back(test::free_block("column " + std::to_string(i), test::rectangle(2.0 * (i / 3), i % 3, 2.0, 1.0)));
  scene.blocks.push_back(test::free_block("slider", test::rectangle(-3.4, 3.0, 1.0, 1.0)));
  scene.blocks.push_back(test::fixed_block("shelf", test::rectangle(-10.0, 2.0, 10.0, 1.0)));
  scene.blocks[10].velocity = {4.0, 0.0};
  scene.joints[0].friction_angle = std::atan(0.2);
  return scene;
}
constexpr int slider = 10;
constexpr double sliding_time = 4.0 / (0.2 * 9.81);  // [s]

}  // namespace

TEST_CASE("what moves over blocks at rest moves as over others", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    std::array<double, 2> way{}, below{};
    for (const bool skips : {false, true}) {
      const Scene scene = prepared(slide_over_columns(), method, skips);
      Follower run(scene);
      run.go(0.5);
      CHECK(run.resting() == (skips ? 9 : 0));
      run.go(0.5);
      const bool follows = method == "soft";  // with the others it hops by microns, or the column with it
      // By now it is on the first column, whose uppermost block is not left alone as long as it slides there.
      int far_rests = 0;
      for (int i = 0; i < 80; ++i) {
        run.go(0.01);
        far_rests += run.system().is_at_rest(9);
        CHECK_FALSE(run.system().is_at_rest(slider));
        if (follows) CHECK_FALSE(run.system().is_at_rest(3));
      }
      if (follows) CHECK((far_rests > 40) == skips);
      run.go(1.4);  // what a block falls asleep on may wake for some more rounds of rest.time
      way[skips] = run.way(slider).x();
      below[skips] = run.way(3).norm();
      CHECK(run.resting() == (skips ? 10 : 0));
    }
    const Scene scene = prepared(slide_over_columns(), method, true);
    CHECK(way[0] == Approx(2.0 * sliding_time).epsilon(0.01));
    CHECK(way[1] == Approx(way[0]).margin(denied_velocity(scene.rest) * sliding_time));
    CHECK(std::abs(below[1] - below[0]) < scene.rest.displacement);
  }
}

TEST_CASE("a block at rest that is hit moves as if it had not been", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    std::array<Vec2, 2> way;
    for (const bool skips : {false, true}) {
      // Uphill of the block.
      Scene scene = test::block_on_incline(20.0 * degree);
      scene.blocks.push_back(test::free_block("stone", test::placed(test::rectangle(-3.0, 0.0, 1.0, 1.0), -20.0 * degree)));
      scene.blocks[2].velocity = 5.0 * test::downhill(20.0 * degree);
      scene = prepared(scene, method, skips);
      Follower run(scene);
      run.go(0.4);
      CHECK(run.resting() == (skips ? 1 : 0));
      const Vec2 before = run.way(1);
      run.go(1.0);
      way[skips] = run.way(1) - before;
    }
    CHECK(way[0].norm() > 0.1);
    CHECK((way[1] - way[0]).norm() < 0.01 * way[0].norm());
  }
}

TEST_CASE("a push goes through a chain at rest", "[analysis][resting]") {
  // Implicit steps bring the force to the last block before any has moved: every block but those that move already is woken within one step.
  constexpr int n = 12;
  for (const std::string& method : all_methods) {
    INFO(method);
    std::array<double, 2> last{}, first{};
    for (const bool skips : {false, true}) {
      Scene scene = test::empty_scene();
      scene.blocks = {test::fixed_block("base", test::rectangle(-10.0, -1.0, 40.0, 1.0))};
      for (int i = 0; i < n; ++i) scene.blocks.push_back(test::free_block("link " + std::to_string(i), test::rectangle(i, 0.0, 1.0, 1.0)));
      scene.blocks.push_back(test::free_block("ram", test::rectangle(-6.3, 0.0, 1.5, 1.0)));
      scene.blocks[n + 1].velocity = {8.0, 0.0};
      scene.joints[0].friction_angle = 5.0 * degree;
      scene = prepared(scene, method, skips);
      // Steps of the blow whose friction does not settle are cut, other ones with all blocks in the system than with few: 1 % of the way at 1e-3 s.
      if (method == "shi") scene.step.dt = 5e-4;
      Follower run(scene);
      run.go(0.5);
      CHECK(run.resting() == (skips ? n : 0));
      run.go(0.7);
      last[skips] = run.way(n).x();
      first[skips] = run.way(1).x();
      if (skips && method != "dem") CHECK(run.simulation.state().counters.repeated_to_wake > 0);
      if (skips) CHECK(run.simulation.state().counters.woken >= n);
    }
    CHECK(last[0] > 0.05);
    const double missed = 0.5 * denied_velocity(RestInput());  // [m] half a second after the hit it still slides
    CHECK(last[1] == Approx(last[0]).margin(missed));
    CHECK(first[1] == Approx(first[0]).margin(missed));
  }
}

namespace {

/// Blocks in a row, of which every other one is at rest, and the contacts between them, which carry nothing.
struct Row {
  static constexpr double dt = 1e-3;  // [s]

  Row() : system(scene()), resting(RestInput(), system) {
    JointTable joints(scene());
    Detector detector(0.05);
    detector.update(system, joints, contacts);
    for (Contact& c : contacts.moving) c.status = ContactStatus::sticking;
    const std::vector<int> at_rest{0, 2, 4, 6};
    system.put_to_rest(at_rest);
    resting.keep_forces(system, at_rest, contacts);
    resting.divide(system, {});
  }
  static Scene scene() {
    Scene scene = test::empty_scene();
    for (int i = 0; i < 7; ++i) scene.blocks.push_back(test::free_block("block", test::rectangle(i, 0.0, 1.0, 1.0)));
    return scene;
  }
  /// Blocks that are woken when those at rest feel these parts of what wakes one.
  std::vector<int> woken(const std::array<double, 4>& parts, Resting::Urgency urgency) {
    const RestInput rest;
    auto& pushes = resting.pushes(system);
    for (std::size_t i = 0; i < parts.size(); ++i)
      pushes[i].x() = parts[i] * rest.acceleration * system.block(system.resting_blocks()[i]).mass[0] / -std::expm1(-dt / rest.time);
    resting.judge(system, dt);
    std::vector<int> list = resting.woken(system, contacts, urgency);
    std::sort(list.begin(), list.end());
    return list;
  }

  BlockSystem system;
  ContactSet contacts;
  Resting resting;
};

}  // namespace

TEST_CASE("blocks that are nearly woken are woken along with others", "[analysis][resting]") {
  using Urgency = Resting::Urgency;
  CHECK(Row().woken({0.8, 0.8, 0.8, 0.8}, Urgency::any).empty());
  CHECK(Row().woken({1.01, 0.8, 0.5, 0.8}, Urgency::any) == std::vector<int>{0, 2, 6});
  CHECK(Row().woken({1.01, 0.8, 0.5, 0.8}, Urgency::in_haste).empty());
}

TEST_CASE("a step that has to be repeated wakes farther and farther blocks, also behind those that move", "[analysis][resting]") {
  using Urgency = Resting::Urgency;
  Row row;
  CHECK(row.woken({9.0, 0.0, 0.0, 0.0}, Urgency::in_haste) == std::vector<int>{0});
  CHECK(row.woken({9.0, 0.0, 0.0, 0.0}, Urgency::in_haste) == std::vector<int>{0, 2});
  CHECK(row.woken({9.0, 0.0, 0.0, 0.0}, Urgency::in_haste) == std::vector<int>{0, 2, 4});
  CHECK(row.woken({9.0, 0.0, 0.0, 0.0}, Urgency::in_haste) == std::vector<int>{0, 2, 4, 6});
  row.resting.accept(row.system);
  CHECK(row.woken({9.0, 0.0, 0.0, 0.0}, Urgency::in_haste) == std::vector<int>{0});
}

TEST_CASE("a block at the top of its flight is not at rest", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = prepared(test::falling_block(), method, true);
    scene.blocks[0].velocity = {0.0, 9.81 * 0.1};
    Follower usual(scene);
    usual.go(0.3);
    CHECK(usual.simulation.state().counters.put_to_rest == 0);
    // Nothing that touches nothing is held.
    scene.rest.acceleration = 1e3;
    scene.rest.displacement = 1e3;
    Follower careless(scene);
    careless.go(0.3);
    CHECK(careless.simulation.state().counters.put_to_rest == 0);
    CHECK(careless.way(0).y() == Approx(0.5 * 9.81 * (0.01 - 0.04)).epsilon(1e-9));
  }
}

TEST_CASE("a block that starts to slide is not at rest", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    // Beyond its angle of friction by 5 degrees. In the time given it does not go far: its acceleration of 1 m/s2 tells.
    Scene scene = prepared(test::block_on_incline(35.0 * degree), method, true);
    scene.rest.time = 0.01;
    scene.rest.displacement = 1e-2;
    Follower run(scene);
    run.go(0.2);
    CHECK(run.simulation.state().counters.put_to_rest == 0);
    CHECK(run.speed(1) > 0.15);
  }
}

TEST_CASE("a block that slides slowly is not at rest, however short its steps", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    // On ice at 0.05 m/s: half of rest.displacement_m in a step, fifty times as much in rest.time_s. Nothing changes its velocity.
    Scene scene = prepared(test::block_on_incline(0.0), method, true);
    scene.joints[0].friction_angle = 0.0;
    scene.blocks[1].velocity = {0.05, 0.0};
    scene.step.dt = 1e-3;
    Follower run(scene);
    run.go(1.0);
    CHECK(run.simulation.state().counters.put_to_rest == 0);
    CHECK(run.way(1).x() == Approx(0.05).epsilon(1e-9));
  }
}

TEST_CASE("whoever changes a scene wakes it", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Follower run(prepared(test::block_on_incline(20.0 * degree), method, true));
    run.go(0.5);
    REQUIRE(run.resting() == 1);
    run.simulation.change_joints().reduce_strength(3.0);
    CHECK(run.resting() == 0);
    run.go(0.2);
    // tan 30 deg / 3 against tan 20 deg.
    const double a = 9.81 * (std::sin(20.0 * degree) - std::tan(30.0 * degree) / 3.0 * std::cos(20.0 * degree));
    CHECK(run.speed(1) == Approx(0.2 * a).epsilon(0.02));
  }
}

TEST_CASE("no block rests while the base shakes", "[analysis][resting]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    std::array<double, 2> way{};
    for (const bool skips : {false, true}) {
      Scene scene = prepared(test::block_on_base(), method, skips);
      BaseMotionInput pulse;
      pulse.kind = BaseMotionKind::pulses;
      pulse.pulses = {{0.5, 0.2, {-8.0, 0.0}}, {0.9, 0.4, {-0.5, 0.0}}};
      scene.base_motion = pulse;
      Follower run(scene);
      run.simulation.start_base_motion();
      run.go(0.45);
      CHECK(run.resting() == (skips ? 1 : 0));
      run.go(0.1);
      CHECK(run.resting() == 0);
      run.go(0.35);
      // The second pulse, by which it does not slip.
      const long rests = run.simulation.state().counters.put_to_rest;
      run.go(0.35);
      CHECK(run.resting() == 0);
      CHECK(run.simulation.state().counters.put_to_rest == rests);
      way[skips] = run.way(1).x();
      run.go(0.4);
      CHECK(run.resting() == (skips ? 1 : 0));
    }
    CHECK(way[0] > 0.03);
    CHECK(way[1] == Approx(way[0]).margin(RestInput().displacement));
  }
}

TEST_CASE("dem: a shaking base wakes blocks before the length of the step is chosen", "[analysis][resting]") {
  // At rest there is nothing that would limit the step. Beside a block that flies, contacts are listed as far as that one comes in a step: the one at
  // rest could be pressed into its base as far, and the step would not be refused.
  std::array<double, 2> damped{};
  for (const bool skips : {false, true}) {
    Scene scene = prepared(test::block_on_base(), "dem", skips);
    scene.blocks.push_back(test::free_block("flier", test::rectangle(0.0, 100.0, 1.0, 1.0)));
    scene.step.dt = 0.05;
    BaseMotionInput pulse;
    pulse.kind = BaseMotionKind::pulses;
    pulse.pulses = {{0.5, 0.3, {0.0, 3.0}}};
    scene.base_motion = pulse;
    Follower run(scene);
    run.simulation.start_base_motion();
    run.go(0.45);
    REQUIRE(run.resting() == (skips ? 1 : 0));
    run.go(0.1);
    CHECK(run.resting() == 0);
    damped[skips] = run.simulation.ledger().contact_damping;
    run.go(0.4);
    CHECK(run.way(1).norm() < 1e-3);
  }
  // Dashpots take what it comes back with, a hundred times of what comes of gravity at the start.
  REQUIRE(damped[0] > 0.0);
  CHECK(damped[1] == Approx(damped[0]).epsilon(0.1));
}

TEST_CASE("no block rests in pseudo-time or before it may", "[analysis][resting]") {
  Scene scene = prepared(test::block_on_base(), "soft", true);
  Simulation waits(scene);
  for (int i = 0; i < 500; ++i) REQUIRE(waits.advance(1e-3));
  CHECK(waits.state().counters.block_steps_skipped == 0);
  scene.method.statics = true;
  Follower still(scene);
  still.go(0.5);
  CHECK(still.simulation.state().counters.block_steps_skipped == 0);
  Follower run(prepared(test::block_on_base(), "soft", true));
  run.go(0.5);
  REQUIRE(run.resting() == 1);
  REQUIRE(run.simulation.step(1.0, true).accepted);
  CHECK(run.resting() == 0);
}

TEST_CASE("energies stay in balance when blocks rest and wake, and steps are counted", "[analysis][resting]") {
  const auto check = [](const Scene& scene) {
    Follower run(scene);
    run.go(3.0);
    const StepCounters& now = run.simulation.state().counters;
    CHECK(now.put_to_rest > 10);
    CHECK(now.woken == now.put_to_rest - run.resting());
    CHECK(now.block_steps_skipped > 3 * now.steps);
    CHECK(now.block_steps + now.block_steps_skipped == 10 * now.steps);
    CHECK(run.resting() == 10);
    CHECK(run.simulation.ledger().kinetic == Approx(-0.5 * 2500.0 * 16.0).epsilon(1e-12));
    CHECK(std::abs(run.simulation.ledger().imbalance()) < 1e-10 * run.simulation.ledger().turnover);
    const double stored = std::as_const(run.simulation).state().stored_contact_energy();
    CHECK(run.simulation.state().stored_contact_energy() == stored);
    run.simulation.change_contacts();
    CHECK(run.simulation.state().stored_contact_energy() == Approx(stored).epsilon(1e-9));
  };
  for (const std::string& method : all_methods) {
    if (method == "shi") continue;  // its friction lags behind
    INFO(method);
    check(prepared(slide_over_columns(), method, true));
  }
  for (const auto& entry : integrators()) {
    INFO(entry.name);
    Scene scene = prepared(slide_over_columns(), "soft", true);
    scene.method.integrator = entry.name;
    check(scene);
  }
}

TEST_CASE("a saved simulation goes on bit for bit while blocks are at rest", "[analysis][resting][checkpoint]") {
  std::vector<Scene> scenes;
  for (const std::string& method : all_methods) scenes.push_back(prepared(slide_over_columns(), method, true));
  for (const auto& entry : integrators()) {
    scenes.push_back(prepared(slide_over_columns(), "soft", true));
    scenes.back().method.integrator = entry.name;
  }
  for (Scene& scene : scenes) {
    INFO(scene.method.contact << " " << scene.method.integrator.value_or(""));
    Follower first(scene);
    bool rests = false;
    for (int i = 0; i < 25; ++i) {
      Archive saved;
      saved(first.simulation);
      Follower second(scene);
      Archive archive(saved.bytes());
      archive(second.simulation);
      CHECK(archive.at_end());
      rests |= second.resting() > 0;
      first.go(0.1);
      second.go(0.1);
      for (int b = 0; b < first.system().block_count(); ++b) {
        CHECK(second.system().displacement(b) == first.system().displacement(b));
        CHECK(second.system().is_at_rest(b) == first.system().is_at_rest(b));
      }
      CHECK(second.simulation.ledger().imbalance() == first.simulation.ledger().imbalance());
      CHECK(second.simulation.state().counters.woken == first.simulation.state().counters.woken);
    }
    CHECK(rests);
    CHECK(first.simulation.state().counters.woken > 0);
  }
}

TEST_CASE("what is known of blocks at rest is refused where it is of others", "[analysis][resting]") {
  const Scene few = test::column_of_blocks(2), many = test::column_of_blocks(5);
  const BlockSystem system(few), other(many);
  const auto fits = [&](const BlockSystem& saved) {
    Archive archive;
    Resting of_saved(RestInput{}, saved);
    archive(of_saved);
    Archive state(archive.bytes());
    Resting read(RestInput{}, system);
    state(read);
    return read.fits(system);
  };
  CHECK(fits(system));
  CHECK_FALSE(fits(other));
}
