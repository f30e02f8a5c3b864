// Each entry of the ledger against a calculation of its own, and the imbalance where everything happens at once.
#include <cmath>
#include <string>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/integrator/integrators.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;
using openclose::test::block_weight;

namespace {

constexpr double g = 9.81;

/// Velocities at mid-steps: the books are closed half a step before the end.
bool closes_at_midstep(const std::string& method) {
  return method == "hard" || method == "dem";
}

double relative_imbalance(const EnergyLedger& l) {
  return std::abs(l.imbalance()) / l.turnover;
}

void advance(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) REQUIRE(simulation.advance(simulation.scene().step.dt));
}

/// Sum of m g . u over the free blocks.
double work_of_gravity(const Simulation& simulation) {
  double work = 0.0;
  for (int b : simulation.system().free_blocks()) {
    work += simulation.system().block(b).mass[0] * simulation.scene().gravity.dot(simulation.system().displacement(b).head<2>());
  }
  return work;
}

Scene tumbling(const std::string& method, double theta) {
  Scene scene = test::tumbling_blocks();
  scene.method.contact = method;
  scene.method.theta = theta;
  if (method == "shi") test::use_joint_springs_as_penalty(scene);
  return scene;
}

}  // namespace

TEST_CASE("the loss by the integrator is the scheme's entry over the energy moved", "[analysis][energy]") {
  EnergyLedger ledger;
  CHECK(ledger.integrator_loss() == 0.0);
  ledger.scheme = -3.0;
  ledger.turnover = 12.0;
  CHECK(ledger.integrator_loss() == -0.25);
}

TEST_CASE("ledger of a fall", "[analysis][energy]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = test::falling_block();
    scene.method.contact = method;
    Simulation simulation(scene);
    advance(simulation, 200);
    const double t = 0.2, fall = 0.5 * g * t * t;
    const EnergyLedger& l = simulation.ledger();
    if (!closes_at_midstep(method)) {
      CHECK(l.gravity == Approx(-block_weight * fall).epsilon(1e-12));
      CHECK(l.kinetic == Approx(block_weight * fall).epsilon(1e-12));
      CHECK(l.turnover == Approx(2.0 * block_weight * fall).epsilon(1e-12));
    } else {
      const double v = g * (t - 0.5 * scene.step.dt);
      CHECK(l.kinetic == Approx(0.5 * test::block_mass * v * v).epsilon(1e-12));
      CHECK(l.gravity == Approx(-0.5 * test::block_mass * v * v).epsilon(1e-12));
    }
    for (double other : {l.contact_springs, l.support_springs, l.loads, l.friction, l.impact, l.redefinition}) CHECK(other == 0.0);
    CHECK(std::abs(l.scheme) < 1e-12 * l.turnover);
    CHECK(relative_imbalance(l) < 1e-14);
  }
}

TEST_CASE("ledger of a support: W^2/2k stored, as much lost on the way to rest", "[analysis][energy]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = test::falling_block();
    scene.method.contact = method;
    const double k = 1e7;
    scene.supports = {{0, {1.0, 0.5}, {k, k}}};
    Simulation simulation(scene);
    REQUIRE(settle(simulation).settled);
    const EnergyLedger& l = simulation.ledger();
    const double stored = 0.5 * block_weight * block_weight / k;
    // The sink is right to the fraction of the weight that settling leaves, 1e-8.
    CHECK(l.support_springs == Approx(stored).epsilon(3e-8));
    if (method == "dem") {
      // The first half step from rest lacks a quarter of the path of its first step.
      CHECK(l.gravity == Approx(-stored - l.mass_damping).epsilon(3e-8));
      CHECK(l.mass_damping > 0.5 * stored);
    } else {
      CHECK(l.gravity == Approx(-2.0 * stored).epsilon(3e-8));
      CHECK(l.scheme == Approx(stored).epsilon(3e-8));
    }
    CHECK(l.kinetic == 0.0);
    CHECK(relative_imbalance(l) < 1e-14);
  }
}

TEST_CASE("ledger of a vibration on a support: the scheme takes (theta - 1/2) k times the squares of the steps", "[analysis][energy]") {
  Scene scene = test::falling_block();
  scene.method.theta = GENERATE(0.5, 0.6, 1.0);
  const double k = 1e8;
  scene.supports = {{0, {1.0, 0.5}, {0.0, k}}};
  Simulation simulation(scene);
  double lost = 0.0, before = 0.0;
  for (int i = 0; i < 300; ++i) {
    advance(simulation, 1);
    const double y = simulation.system().displacement(0)[1];
    lost += (*scene.method.theta - 0.5) * k * (y - before) * (y - before);
    before = y;
  }
  const EnergyLedger& l = simulation.ledger();
  CHECK(l.scheme == Approx(lost).epsilon(1e-10).margin(1e-13 * l.turnover));
  CHECK(l.support_springs == Approx(0.5 * k * before * before).epsilon(1e-10));
  CHECK(relative_imbalance(l) < 1e-13);
}

TEST_CASE("ledger of contact springs", "[analysis][energy]") {
  for (const std::string method : {"soft", "shi"}) {
    INFO(method);
    Scene scene = test::block_on_base();
    scene.method.contact = method;
    test::use_joint_springs_as_penalty(scene);
    Simulation simulation(scene);
    REQUIRE(settle(simulation).settled);
    simulation.change_contacts();
    const EnergyLedger& l = simulation.ledger();
    const double k = 1e9 * test::block_edge, stored = 0.5 * block_weight * block_weight / k;
    CHECK(l.contact_springs == Approx(stored).epsilon(1e-7));
    CHECK(l.contact_springs == Approx(simulation.state().stored_contact_energy()).epsilon(1e-12));
    CHECK(l.gravity == Approx(-2.0 * stored).epsilon(1e-7));
    CHECK(l.friction == Approx(0.0).margin(1e-12 * stored));
  }
}

TEST_CASE("ledger of sliding: mu N s", "[analysis][energy]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    const double slope = 30.0 * test::degree, phi = 20.0 * test::degree;
    Scene scene = test::block_on_incline(slope);
    scene.method.contact = method;
    scene.method.start = Start::steady_sliding;
    scene.joints[0].friction_angle = phi;
    Simulation simulation(scene);
    prepare_start(simulation);
    const auto start = simulation.system().displacement(1);
    advance(simulation, 300);
    Eigen::Vector3d moved = simulation.system().displacement(1) - start;
    const double whole_path = moved.head<2>().dot(test::downhill(slope));
    // The path up to where the books are closed.
    const double step = simulation.is_explicit() ? simulation.state().counters.longest_step : scene.step.dt;
    if (closes_at_midstep(method)) moved -= 0.5 * step * 0.5 * (simulation.velocity(1) + simulation.system().velocity(1));
    const double s = moved.head<2>().dot(test::downhill(slope));
    const EnergyLedger& l = simulation.ledger();
    CHECK(s > 0.05);
    // What soft contacts dissipate goes with their slip, up to the end of the step.
    CHECK(l.friction == Approx(std::tan(phi) * block_weight * std::cos(slope) * (method == "dem" ? whole_path : s)).epsilon(1e-8));
    CHECK(l.gravity == Approx(-block_weight * std::sin(slope) * s).epsilon(1e-8));
    CHECK(std::abs(l.impact) < 1e-8 * l.turnover);
    CHECK(relative_imbalance(l) < 1e-10);
  }
}

TEST_CASE("what springs of a joint hold that breaks while it pulls is released", "[analysis][energy]") {
  // A block on a wall is pulled off and falls, at once: its joint slips where it is stretched, and lets go.
  std::vector<std::string> integrators = {""};
  for (const IntegratorEntry& entry : openclose::integrators()) integrators.emplace_back(entry.name);
  for (const std::string method : {"soft", "shi"}) {
    for (const std::string& integrator : method == "soft" ? integrators : std::vector<std::string>{""}) {
      CAPTURE(method, integrator);
      Scene scene = test::scene_with(
          {test::fixed_block("wall", test::rectangle(-1.0, -5.0, 1.0, 10.0)), test::free_block("block", test::rectangle(0.0, 0.0, 1.0, 1.0))});
      scene.method.contact = method;
      if (!integrator.empty()) scene.method.integrator = integrator;
      scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = 1e6;
      scene.joints[0].friction_angle = 0.0;
      scene.joints[0].tensile_strength = 1e6;
      scene.joints[0].cohesion = 1.6 * 0.5 * block_weight;
      scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
      if (method == "shi") test::use_joint_springs_as_penalty(scene);
      scene.loads = {{1, {0.5, 0.5}, {1e4, 0.0}}};
      scene.step.dt = 1e-4;
      Simulation simulation(scene);
      prepare_start(simulation);
      double stored = 0.0;
      for (int i = 0; i < 5000; ++i) {
        REQUIRE(simulation.advance(scene.step.dt));
        stored = std::max(stored, simulation.ledger().contact_springs);
      }
      for (const Contact& c : simulation.contacts()) CHECK(c.status == ContactStatus::open);
      const EnergyLedger& l = simulation.ledger();
      CHECK(stored > 100.0);
      CHECK(std::abs(l.contact_springs) < 1e-9 * stored);
      CHECK(l.redefinition > 10.0);
      CHECK(relative_imbalance(l) < 1e-10);
    }
  }
}

TEST_CASE("ledger of a load", "[analysis][energy]") {
  const double theta = GENERATE(0.5, 1.0);
  Scene scene = test::falling_block();
  scene.method.theta = theta;
  scene.gravity = {0.0, 0.0};
  SECTION("through the centroid") {
    scene.loads = {{0, {1.0, 0.5}, {3000.0, -4000.0}}};
    Simulation simulation(scene);
    advance(simulation, 100);
    const double work = Vec2(3000.0, -4000.0).dot(simulation.system().displacement(0).head<2>());
    CHECK(work == Approx(0.5 * 5000.0 * 5000.0 / test::block_mass * 0.01).epsilon(1e-10));
    CHECK(simulation.ledger().loads == Approx(-work).epsilon(1e-12));
    CHECK(simulation.ledger().kinetic == Approx(work).epsilon(1e-12));
    CHECK(simulation.ledger().turnover == Approx(2.0 * work).epsilon(1e-12));
  }
  SECTION("at a corner of a block that turns: force times the path of the corner") {
    scene.loads = {{0, {2.0, 1.0}, {30000.0, 90000.0}}};
    Simulation simulation(scene);
    const int corner = simulation.change_system().follow_point(0, {2.0, 1.0});
    const Vec2 before = simulation.system().point_position(corner);
    advance(simulation, 300);
    const double work = Vec2(30000.0, 90000.0).dot(simulation.system().point_position(corner) - before);
    CHECK(std::abs(simulation.system().displacement(0)[2]) > 0.3);
    CHECK(simulation.ledger().loads == Approx(-work).epsilon(1e-12));
    CHECK(simulation.ledger().kinetic == Approx(simulation.system().kinetic_energy()).epsilon(1e-12));
    CHECK(relative_imbalance(simulation.ledger()) < 1e-13);
  }
}

TEST_CASE("the ledger closes with loads and supports that turn a block, with every method", "[analysis][energy]") {
  const std::string method = GENERATE(from_range(all_methods));
  INFO(method);
  Scene scene = test::falling_block();
  scene.method.contact = method;
  scene.step.dt = 0.01;
  scene.loads = {{0, {2.0, 1.0}, {3000.0, -2000.0}}};
  scene.supports = {{0, {0.0, 0.0}, {1e6, 1e6}}};
  Simulation simulation(scene);
  advance(simulation, 50);
  CHECK(std::abs(simulation.system().displacement(0)[2]) > 0.1);
  CHECK(relative_imbalance(simulation.ledger()) < 1e-12);
}

TEST_CASE("the ledger closes with a surcharge that spins a block, and has all of its work", "[analysis][energy]") {
  const std::string method = GENERATE(from_range(all_methods));
  INFO(method);
  Scene scene = test::falling_block();
  scene.gravity.setZero();
  scene.method.contact = method;
  scene.step.dt = 0.01;
  scene.surcharges = {{0, scene.blocks[0].vertices[2], 0.5 * (scene.blocks[0].vertices[2] + scene.blocks[0].vertices[3]), 3000.0, -2000.0}};
  Simulation simulation(scene);
  advance(simulation, 50);
  CHECK(std::abs(simulation.system().displacement(0)[2]) > 0.1);
  const EnergyLedger& ledger = simulation.ledger();
  CHECK(relative_imbalance(ledger) < 1e-12);
  CHECK(ledger.kinetic > 0.0);
  // What the scheme adds falls with the step: the work turns into motion.
  CHECK(ledger.loads == Approx(-ledger.kinetic).epsilon(0.05));
}

TEST_CASE("ledger of a stiff impact: all that was fallen is lost", "[analysis][energy]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "hard";
  scene.joints[0].friction_angle = 0.0;
  scene.blocks[1].vertices = test::rectangle(0.0, 0.05, 2.0, 1.0);
  scene.blocks[1].velocity = {1.0, 0.0};
  Simulation simulation(scene);
  advance(simulation, 200);
  const EnergyLedger& l = simulation.ledger();
  // Of the path of mid-step velocities the first half step lacks its g dt^2 / 8.
  const double fallen = block_weight * (0.05 - g * scene.step.dt * scene.step.dt / 8.0);
  CHECK(l.gravity == Approx(-fallen).epsilon(1e-9));
  CHECK(l.impact == Approx(fallen).epsilon(1e-9));
  CHECK(std::abs(l.kinetic) < 1e-7 * l.turnover);
  CHECK(std::abs(l.friction) < 1e-12 * l.turnover);
  CHECK(l.contact_springs == 0.0);
  CHECK(relative_imbalance(l) < 1e-10);
}

TEST_CASE("ledger of a contact that loses length under load", "[analysis][energy]") {
  // Rotation locked and no friction: the block slides off the end of its base, the springs of the length left behind are gone.
  Scene scene = test::block_on_base();
  scene.joints[0].friction_angle = 0.0;
  scene.blocks[0].vertices = test::rectangle(-10.0, -1.0, 11.5, 1.0);
  scene.blocks[1].rotation_locked = true;
  scene.blocks[1].velocity = {1.0, 0.0};
  scene.method.start = Start::settled;
  Simulation simulation(scene);
  REQUIRE(prepare_start(simulation).converged);
  const auto length = [&] {
    double sum = 0.0;
    for (const Contact& c : simulation.change_contacts()) sum += c.length;
    return sum;
  };
  double released = 0.0, before = length();
  CHECK(before == Approx(1.5).epsilon(1e-12));
  for (int i = 0; i < 500; ++i) {
    advance(simulation, 1);
    const double now = length(), gap = simulation.change_contacts().front().gap;
    released += 0.5 * 1e9 * gap * gap * (before - now);
    before = now;
  }
  CHECK(before == Approx(1.0).epsilon(1e-9));
  CHECK(released > 0.0);
  CHECK(simulation.ledger().redefinition == Approx(released).epsilon(1e-9));
  CHECK(relative_imbalance(simulation.ledger()) < 1e-12);
}

TEST_CASE("the ledger closes when blocks tumble and collide", "[analysis][energy]") {
  struct Case {
    std::string method;
    double theta;
  };
  const Case c = GENERATE(values<Case>({{"soft", 1.0}, {"soft", 0.6}, {"soft", 0.5}, {"shi", 1.0}, {"hard", 1.0}}));
  INFO(c.method << ", theta = " << c.theta);
  Simulation simulation(tumbling(c.method, c.theta));
  const double kinetic_start = simulation.system().kinetic_energy();
  advance(simulation, 500);
  simulation.change_contacts();
  const EnergyLedger& l = simulation.ledger();
  CHECK(relative_imbalance(l) < 1e-10);

  // What is a state can be asked for at the end, however it was reached.
  CHECK(l.kinetic == Approx(simulation.system().kinetic_energy() - kinetic_start).margin(1e-12 * l.turnover));
  CHECK(l.contact_springs == Approx(simulation.state().stored_contact_energy()).margin(1e-12 * l.turnover));
  if (c.method != "hard") CHECK(l.gravity == Approx(-work_of_gravity(simulation)).margin(1e-12 * l.turnover));

  // The scene asks something of every account that is not left out.
  CHECK(std::abs(simulation.system().displacement(1)[2]) > 0.2);
  CHECK(std::abs(l.friction) > 1e-4 * l.turnover);
  if (c.method == "hard") {
    CHECK(l.impact > 1e-2 * l.turnover);
    CHECK(l.contact_springs == 0.0);
  } else {
    CHECK(l.impact == 0.0);
    CHECK(std::abs(l.redefinition) > 1e-6 * l.turnover);
    CHECK(std::abs(l.scheme) > 1e-6 * l.turnover);
  }
  if (c.theta == 1.0) CHECK(l.scheme > -1e-6 * l.turnover);
}

TEST_CASE("the ledger closes with contact damping", "[analysis][energy]") {
  struct Case {
    std::string method;
    double theta;
  };
  const Case c = GENERATE(values<Case>({{"soft", 1.0}, {"soft", 0.6}, {"soft", 0.5}, {"shi", 1.0}}));
  INFO(c.method << ", theta = " << c.theta);
  Scene scene = tumbling(c.method, c.theta);
  scene.joints[0].damping_ratio = 0.3;
  Simulation simulation(scene);
  advance(simulation, 500);
  const EnergyLedger& l = simulation.ledger();
  CHECK(relative_imbalance(l) < 1e-10);
  CHECK(l.contact_damping > 1e-2 * l.turnover);
}

TEST_CASE("damping takes the kinetic energy of a block that comes to rest on its joint", "[analysis][energy]") {
  for (const std::string method : {"soft", "shi"}) {
    INFO(method);
    Scene scene = test::block_on_base();
    test::use_joint_springs_as_penalty(scene);
    scene.method.contact = method;
    scene.joints[0].damping_ratio = 0.5;
    scene.joints[0].friction_angle = 80.0 * test::degree;
    scene.method.theta = method == "soft" ? 0.5 : 1.0;
    scene.method.start = Start::settled;
    scene.settle.unbalanced_fraction = 1e-12;
    // Slow enough for the contacts to stay closed and to stick.
    scene.blocks[1].velocity = {2e-3, 3e-3};
    Simulation simulation(scene);
    REQUIRE(prepare_start(simulation).converged);
    advance(simulation, 500);
    const EnergyLedger& l = simulation.ledger();
    const double kinetic = 0.5 * test::block_mass * scene.blocks[1].velocity.squaredNorm();
    CHECK(std::abs(l.friction) < 1e-10 * kinetic);
    // Geometry changes by (amplitude / block) squared and the settled state by its tolerance; Shi's scheme takes a share of its own.
    CHECK(l.contact_damping == Approx(kinetic - l.scheme).epsilon(1e-6));
    if (method == "soft") CHECK(std::abs(l.scheme) < 1e-3 * kinetic);
  }
}

TEST_CASE("energy that comes from outside shows", "[analysis][energy]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Simulation simulation(tumbling(method, 1.0));
    advance(simulation, 50);
    const double kinetic_start = simulation.system().kinetic_energy() - simulation.ledger().kinetic;
    const double before = simulation.system().kinetic_energy();
    simulation.change_system().set_velocity(1, 1.1 * simulation.system().velocity(1));
    const double brought_in = simulation.system().kinetic_energy() - before;
    advance(simulation, 50);
    const EnergyLedger& l = simulation.ledger();
    const double unexplained = l.imbalance() + (simulation.system().kinetic_energy() - kinetic_start - l.kinetic);
    CHECK(unexplained == Approx(brought_in).epsilon(1e-9));
    CHECK(brought_in > 1e-2 * l.turnover);
  }
}
