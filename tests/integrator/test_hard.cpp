#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "openclose/analysis/run.h"
#include "openclose/analysis/settle.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/registry.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

struct Outcome {
  Vec2 displacement;
  double rotation;
  double penetration;
};

Outcome outcome(Scene scene, const std::string& method, double stiffness_factor) {
  scene.method.contact = method;
  scene.joints[0].normal_stiffness *= stiffness_factor;
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).converged);
  const auto d = simulation.system().displacement(1);
  return {d.head<2>(), d[2], simulation.max_penetration()};
}

/// A block that slides down with rotation free; steps so long that the joint's stiffness would show.
Scene sliding() {
  Scene scene = test::block_on_incline(30.0 * test::degree);
  scene.joints[0].friction_angle = 15.0 * test::degree;
  scene.step.dt = 1e-2;
  scene.end_time = 0.5;
  return scene;
}

Scene settling() {
  Scene scene = test::block_on_base();
  scene.method.start = Start::settled;
  scene.end_time = 0.01;
  return scene;
}

/// Blocks on each other, on which gravity comes at once: a column of n blocks yields n^2 times as much as one of them.
Scene column(int blocks, double dt, int steps) {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base", test::rectangle(-5.0, -1.0, 10.0, 1.0))};
  for (int i = 0; i < blocks; ++i) scene.blocks.push_back(test::free_block("block " + std::to_string(i), test::rectangle(0.0, i, 2.0, 1.0)));
  scene.method.contact = "hard";
  scene.method.gap_tolerance = 3e-7;
  scene.step.dt = dt;
  scene.end_time = steps * dt;
  return scene;
}

/// Boxes of 0.30 to 0.40 m, turned a little, that fall between two walls. As soon as they touch by a face cohesion acts, some 60 times their weight.
Scene cohesive_boxes() {
  constexpr int columns = 8, rows = 9;
  constexpr double cell = 0.6, width = columns * cell, height = rows * cell;
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("floor", test::rectangle(-1.0, -1.0, width + 2.0, 1.0)),
                  test::fixed_block("left", test::rectangle(-1.0, 0.0, 1.0, height)),
                  test::fixed_block("right", test::rectangle(width, 0.0, 1.0, height))};
  for (int k = 0; k < columns * rows; ++k) {
    const auto scattered = [&](int step) { return std::sin(step * k + 2.0); };
    const double a = 0.175 + 0.025 * scattered(3), b = 0.175 + 0.025 * scattered(5), turn = 0.05 * scattered(7);
    const Vec2 centre(cell * (k % columns + 0.5), cell * (k / columns + 0.5)), along(a, a * turn), up(-b * turn, b);
    scene.blocks.push_back(
        test::free_block("box " + std::to_string(k), {centre - along - up, centre + along - up, centre + along + up, centre - along + up}));
  }
  scene.joints[0].friction_angle = 15.0 * test::degree;
  scene.joints[0].cohesion = 5.2e5;
  scene.method.contact = "hard";
  scene.method.gap_tolerance = 3e-7;
  scene.step.dt = 0.005;
  scene.end_time = 1.0;
  return scene;
}

}  // namespace

TEST_CASE("hard is not soft with a larger number", "[integrator][hard]") {
  const double factor = GENERATE(0.5, 10.0, 1000.0);
  SECTION("sliding") {
    const Outcome a = outcome(sliding(), "hard", 1.0), b = outcome(sliding(), "hard", factor);
    // A closed gap and a sticking place may be off by the tolerance, in each of 50 steps.
    CHECK((a.displacement - b.displacement).norm() < 50 * test::gap_tolerance);
    CHECK(std::abs(a.rotation - b.rotation) < 50 * test::gap_tolerance);
    CHECK(std::abs(a.penetration - b.penetration) < test::gap_tolerance);
    CHECK(a.displacement.norm() > 0.3);
  }
  SECTION("settled") {
    const Outcome a = outcome(settling(), "hard", 1.0), b = outcome(settling(), "hard", factor);
    CHECK(a.penetration < test::gap_tolerance);
    CHECK(b.penetration < test::gap_tolerance);
    CHECK((a.displacement - b.displacement).norm() < 2 * test::gap_tolerance);
  }
}

TEST_CASE("hard contacts keep to the tolerance that is asked for", "[integrator][hard]") {
  // Blocks that fall on one another; each closed contact may keep half the tolerance and miss it by a whole one.
  std::vector<long> solves;
  for (const double tolerance : {1e-10, 1e-7, 1e-4}) {
    Scene scene = test::tumbling_blocks();
    scene.method.contact = "hard";
    scene.method.gap_tolerance = tolerance;
    scene.end_time = 0.5;
    Simulation simulation(scene);
    REQUIRE(run(simulation, {}).converged);
    CHECK(simulation.max_penetration() < 1.5 * tolerance);
    solves.push_back(simulation.state().counters.iterations);
  }
  // How many impacts there are to be found again with softer springs decides among coarse ones.
  CHECK(solves[0] > solves[1]);
  CHECK(solves[0] > solves[2]);
}

TEST_CASE("how rigid contacts share forces does not depend on the stiffness", "[integrator][hard]") {
  // A leaning column: the two corners in each of its joints could share what goes along it in many ways.
  Scene scene = test::column_of_blocks(3);
  for (BlockInput& block : scene.blocks) block.vertices = test::placed(block.vertices, -15.0 * test::degree);
  scene.method.contact = "hard";
  std::vector<std::vector<double>> forces;
  for (const double factor : {1.0, 0.1, 10.0}) {
    Scene other = scene;
    other.joints[0].normal_stiffness *= factor;
    other.joints[0].shear_stiffness *= factor;
    Simulation simulation(other);
    REQUIRE(settle(simulation).settled);
    forces.emplace_back();
    for (const Contact& c : simulation.change_contacts()) forces.back().insert(forces.back().end(), {c.normal_force, c.shear_force});
  }
  // The second pass has gone a ten-thousandth of the way of the first, of which turning by 1e-4 rad has a share.
  const double sharing = 1e-7;
  for (const auto& other : {forces[1], forces[2]}) {
    REQUIRE(other.size() == forces[0].size());
    for (std::size_t i = 0; i < other.size(); ++i) CHECK(other[i] == Approx(forces[0][i]).margin(sharing * test::block_weight));
  }
}

TEST_CASE("the slack of a rigid contact at rest is the gap that springs would leave", "[integrator][hard]") {
  // A plank whose weight lies near the end of its support tilts on springs and parts from the other one.
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("left", test::rectangle(0.0, -1.0, 1.0, 1.0)), test::fixed_block("right", test::rectangle(1.5, -1.0, 0.5, 1.0)),
                  test::free_block("plank", test::rectangle(-2.2, 0.0, 4.6, 0.5))};
  std::vector<std::vector<Contact>> contacts;
  for (const std::string method : {"soft", "hard"}) {
    scene.method.contact = method;
    Simulation simulation(scene);
    REQUIRE(settle(simulation).settled);
    contacts.push_back(simulation.change_contacts());
  }
  const auto &soft = contacts[0], &hard = contacts[1];
  REQUIRE(soft.size() == hard.size());
  int parted = 0;
  for (std::size_t i = 0; i < soft.size(); ++i) {
    CHECK(hard[i].status == soft[i].status);
    if (soft[i].status != ContactStatus::open) continue;
    ++parted;
    CHECK(std::abs(hard[i].gap) < test::gap_tolerance);
    // To the square of the tilt.
    CHECK(hard[i].slack == Approx(soft[i].gap).epsilon(1e-3));
  }
  CHECK(parted == 2);
}

TEST_CASE("a closed contact that penetrates is pushed out by no more than passes may miss", "[integrator][hard]") {
  Scene scene = settling();
  scene.method.contact = "hard";
  Simulation simulation(scene);
  REQUIRE(settle(simulation).settled);
  const StepProblem problem = simulation.problem(scene.step.dt, false);
  Contact contact = problem.contacts.front();
  REQUIRE(contact.status != ContactStatus::open);
  const auto push = [&](double gap) {
    contact.gap = gap;
    const ContactSprings springs = simulation.enforcement().springs(problem, contact);
    return springs.target - springs.gap;
  };
  const double tolerance = scene.method.gap_tolerance;
  CHECK(push(-0.4 * tolerance) == 0.0);
  CHECK(push(-0.7 * tolerance) == Approx(0.2 * tolerance).epsilon(1e-9));  // back to what it may keep, half the tolerance
  CHECK(push(-100.0 * tolerance) == Approx(0.5 * tolerance).epsilon(1e-9));
}

TEST_CASE("a force that grows drives a closed contact in no deeper than it is", "[integrator][hard]") {
  Scene scene = settling();
  scene.method.contact = "hard";
  Simulation simulation(scene);
  REQUIRE(settle(simulation).settled);
  const StepProblem present = simulation.problem(scene.step.dt, false);
  std::vector<Contact> contacts = present.contacts;
  for (Contact& c : contacts) {
    // Less by this than what the block weighs: the first pass misses its target by no more than what is tolerated.
    const double lacking = 0.75 * test::gap_tolerance;
    c.gap = -3.0 * test::gap_tolerance;
    c.normal_force -= lacking * simulation.enforcement().springs(present, c).normal;
  }
  const StepProblem problem{present.system, present.external, present.joints, contacts, present.method, present.dt, false, present.inertia};
  StepSolution solution;
  make_enforcement(scene.method)->solve(problem, solution);
  REQUIRE(solution.converged);
  int closed = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].status == ContactStatus::open) continue;
    ++closed;
    CHECK(solution.contacts[c].pose.gap_change >= 0.0);
  }
  CHECK(closed == 2);
}

TEST_CASE("springs of rigid contacts become stiffer where they are too soft for a column", "[integrator][hard]") {
  Simulation simulation(column(200, 1e-2, 10));
  for (int i = 0; i < 10; ++i) REQUIRE(simulation.advance(1e-2));  // as run() does, which would cut steps for the energy of gravity at once, too
  CHECK(simulation.state().counters.steps == 10);                  // none of them in parts, as where the passes that a step may take are too few
}

TEST_CASE("passes of rigid contacts grow in number no faster than the column that they carry", "[integrator][hard]") {
  // An error that falls with the square of the number of passes, of multipliers that grow with the square of the blocks. Without momentum both
  // columns have a ratio of more than two.
  const auto iterations = [](int blocks) {
    Simulation simulation(column(blocks, 0.01, 1));
    REQUIRE(run(simulation, {}).converged);
    REQUIRE(simulation.state().counters.steps == 1);
    return simulation.state().counters.iterations;
  };
  CHECK(iterations(400) <= 2 * iterations(200));
}

TEST_CASE("a step of which the passes do not find the multipliers is cut to what their error tells", "[integrator][hard]") {
  Scene scene = column(1000, 0.1, 1);
  scene.method.gap_tolerance = 1e-8;
  Simulation simulation(scene);
  SECTION("not by halves") {
    prepare_start(simulation);
    const StepResult step = simulation.step(scene.step.dt, false);
    CHECK_FALSE(step.accepted);
    CHECK(step.part > 0.0);
    CHECK(step.part < 0.5);
  }
  SECTION("and goes on") {
    REQUIRE(run(simulation, {}).converged);
    CHECK(simulation.state().counters.cuts > 0);
  }
}

TEST_CASE("steps of which the passes find no multipliers are cut before blocks pass into each other", "[integrator][hard]") {
  const int blocks = 1000, steps = 2;
  const double dt = 0.02;
  Scene scene = column(blocks, dt, steps);
  scene.method.gap_tolerance = 1e-10;  // which passes through so many blocks do not reach
  Simulation simulation(scene);
  prepare_start(simulation);  // the watch would refuse a run that misses its tolerance so far
  for (int i = 0; i < steps; ++i) REQUIRE(simulation.advance(dt));
  CHECK(simulation.state().counters.cuts > 0);
  // Springs of 300 times the inertia under the weight of the column would close by a thousand times as much in a whole step.
  CHECK(simulation.max_penetration() < 10.0 * tolerance::rounding_of_ways_m);
}

TEST_CASE("what is pushed back has a speed, in steps however short", "[integrator][hard]") {
  // A block that has been left ten tolerances deep. Pushed back by half of one in a step, it would go at 150 m/s.
  Scene scene = test::block_on_base();
  scene.method.contact = "hard";
  scene.method.gap_tolerance = 3e-7;
  scene.gravity = {0.0, 0.0};
  for (Vec2& v : scene.blocks[1].vertices) v.y() -= 10.0 * scene.method.gap_tolerance;
  Simulation simulation(scene);
  for (int i = 0; i < 5; ++i) {
    REQUIRE(simulation.step(1e-9, false).accepted);
    CHECK(simulation.velocity(1).norm() < 2.0 * tolerance::hard_recovery_m_per_s);
  }
}

TEST_CASE("soft contacts close by what their stiffness says", "[integrator][soft]") {
  const Outcome a = outcome(settling(), "soft", 1.0), b = outcome(settling(), "soft", 0.5);
  const double closure = test::block_weight / (1e9 * test::block_edge);
  CHECK(a.penetration == Approx(closure).epsilon(1e-7));
  CHECK(b.penetration == Approx(2.0 * closure).epsilon(1e-7));
}

TEST_CASE("a hard block slides as a rigid one from the first step", "[integrator][hard]") {
  const double slope = 30.0 * test::degree, mu = std::tan(15.0 * test::degree);
  const Outcome o = outcome(sliding(), "hard", 1.0);
  const double exact = 0.5 * 9.81 * (std::sin(slope) - mu * std::cos(slope)) * 0.5 * 0.5;
  CHECK(o.displacement.dot(test::downhill(slope)) == Approx(exact).epsilon(1e-9));
  CHECK(std::abs(o.displacement.dot(test::off_slope(slope))) < 50 * test::gap_tolerance);
}

TEST_CASE("a hard block that falls stays where it lands", "[integrator][hard]") {
  Scene scene = test::block_on_base();
  scene.blocks[1].vertices = test::rectangle(0.0, 0.05, 2.0, 1.0);
  scene.method.contact = "hard";
  scene.end_time = 0.3;
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).converged);
  CHECK(simulation.system().displacement(1)[1] == Approx(-0.05).margin(100 * test::gap_tolerance));
  CHECK(simulation.velocity(1).norm() < 1e-6);
}

TEST_CASE("boxes that fall on each other with strong cohesion come to the end of their motion", "[integrator][hard]") {
  Simulation simulation(cohesive_boxes());
  const RunResult result = run(simulation, {});
  INFO(result.reason);
  CHECK(result.converged);
}

TEST_CASE("saved springs that there are not are refused", "[integrator][hard]") {
  MethodInput method;
  method.contact = "hard";
  Archive saved;
  make_enforcement(method)->exchange(saved);
  struct Springs {
    std::uint64_t level;
    int failed_trials, steps_since_trial;
  };
  static_assert(sizeof(Springs) == 16);
  REQUIRE(saved.bytes().size() >= sizeof(Springs));
  /// They are the last of what is saved.
  const auto reads = [&](const Springs& springs) {
    std::string bytes = saved.bytes();
    std::memcpy(bytes.data() + bytes.size() - sizeof springs, &springs, sizeof springs);
    Archive archive(bytes);
    try {
      make_enforcement(method)->exchange(archive);
      return archive.at_end();
    } catch (const DamagedState&) {
      return false;
    }
  };
  CHECK(reads({0, 0, 0}));
  CHECK(reads({2, 4, 15}));
  CHECK_FALSE(reads({3, 0, 0}));
  CHECK_FALSE(reads({0, -1, 0}));
  CHECK_FALSE(reads({0, 5, 0}));
  CHECK_FALSE(reads({0, 0, -1}));
  CHECK_FALSE(reads({2, 4, 16}));
  CHECK_FALSE(reads({2, 1, 2}));
}
