// A moving base with every method: what blocks feel, when it begins, what the ledger says.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/integrator/integrators.h"
#include "support/catch.h"
#include "support/plain_explicit.h"
#include "support/scenes.h"

using namespace openclose;
using openclose::test::all_methods;

namespace {

BaseMotionInput uneven_record() {
  BaseMotionInput motion;
  motion.kind = BaseMotionKind::record;
  // Jumps, pieces shorter than a step of 1 ms, and an end.
  motion.horizontal = {{0.0103, 0.05, 0.05, 0.0702, 0.0703, 0.0704, 0.1, 0.35}, {1.0, 6.0, -4.0, 3.0, 90.0, 2.0, -5.0, 4.0}};
  motion.vertical = {{0.0, 0.2, 0.3}, {-2.0, 2.0, 1.0}};
  return motion;
}

Scene with_method(Scene scene, const std::string& method) {
  scene.method.contact = method;
  if (method == "shi") test::use_joint_springs_as_penalty(scene);
  return scene;
}

/// `soft` with every integrator, generalized_alpha from where fast vibrations vanish in a step to where they stay.
std::vector<MethodInput> all_integrators(const MethodInput& others) {
  std::vector<MethodInput> list;
  for (const auto& entry : integrators()) {
    list.push_back(others);
    list.back().integrator = entry.name;
    if (std::string(entry.name) != "generalized_alpha") continue;
    for (const double rho : {0.0, 0.3, 0.9, 1.0}) {
      list.push_back(list.back());
      list.back().rho_inf = rho;
    }
  }
  return list;
}

std::string name_of(const MethodInput& method) {
  return *method.integrator + (method.rho_inf ? ", rho_inf = " + std::to_string(*method.rho_inf) : "");
}

Scene block_without_friction() {
  Scene scene = test::block_on_base();
  scene.joints[0].friction_angle = 0.0;
  scene.step.max_displacement = 1.0;
  return scene;
}

void advance(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) REQUIRE(simulation.advance(simulation.scene().step.dt));
}

/// How fast the error in the place of a block that nothing holds, on a base that swings, falls with the step.
double order_of_place(Scene scene, int block) {
  const double amplitude = 3.0, frequency = 2.0, end = 0.3;
  scene.base_motion.emplace();
  scene.base_motion->kind = BaseMotionKind::harmonic;
  scene.base_motion->amplitude = {amplitude, 0.0};
  scene.base_motion->frequency = frequency;
  const double w = 2.0 * std::acos(-1.0) * frequency, exact = -amplitude / (w * w) * (w * end - std::sin(w * end));
  const auto error = [&](int n) {
    scene.step.dt = end / n;
    Simulation simulation(scene);
    simulation.start_base_motion();
    advance(simulation, n);
    return std::abs(simulation.system().displacement(block)[0] - exact);
  };
  return std::log2(error(100) / error(200));
}

}  // namespace

TEST_CASE("a free block lags behind its base, exactly, whatever the step", "[analysis][base_motion]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = with_method(test::falling_block(), method);
    scene.gravity = Vec2::Zero();
    scene.base_motion = uneven_record();
    const BaseMotion base(scene.base_motion);
    for (const double dt : {1e-3, 7e-3, 0.05}) {
      scene.step.dt = dt;
      Simulation simulation(scene);
      simulation.start_base_motion();
      const bool midstep = method == "hard" || method == "dem";
      for (int i = 1; i <= 7; ++i) {
        advance(simulation, 1);
        const double t = (i - (midstep ? 0.5 : 0.0)) * dt;
        const Vec2 v = simulation.system().velocity(0).head<2>();
        CHECK((v + t * base.mean_acceleration(0.0, t)).norm() < 1e-14);
      }
      const EnergyLedger& l = simulation.ledger();
      CHECK(l.base_motion == Approx(-l.kinetic).epsilon(1e-12));
      CHECK(std::abs(l.imbalance()) < 1e-13 * l.turnover);
      CHECK(l.turnover > 0.0);
    }
  }
}

TEST_CASE("its place is of second order", "[analysis][base_motion]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = with_method(test::falling_block(), method);
    scene.gravity = Vec2::Zero();
    CHECK(order_of_place(std::move(scene), 0) == Approx(2.0).margin(0.05));
  }
}

TEST_CASE("a pulse anywhere in a step gives a block without friction the base's velocity, with every integrator", "[analysis][base_motion]") {
  Scene scene = block_without_friction();
  scene.step.dt = 5e-3;
  scene.base_motion.emplace();
  for (const MethodInput& method : all_integrators(scene.method)) {
    scene.method = method;
    for (const double part : {0.0, 0.2, 0.5, 0.6, 0.9}) {
      INFO(name_of(method) << ", a pulse " << part << " of a step after its start");
      scene.base_motion->pulses = {{(3.0 + part) * scene.step.dt, 0.3 * scene.step.dt, {200.0, 0.0}}};
      const BaseMotion base(scene.base_motion);
      const double change = 200.0 * 0.3 * scene.step.dt;
      Simulation simulation(scene);
      simulation.start_base_motion();
      for (int i = 1; i <= 12; ++i) {
        advance(simulation, 1);
        const double t = i * scene.step.dt;
        // Vertical contact forces have a part of rounding in the horizontal.
        CHECK(std::abs(simulation.velocity(1)[0] + t * base.mean_acceleration(0.0, t)[0]) < 1e-12 * change);
      }
      // The pulse is known to a step, in which the block has moved by no more than its velocity times the step.
      const double exact = -change * (12 - 3 - part - 0.15) * scene.step.dt;
      CHECK(std::abs(simulation.system().displacement(1)[0] - exact) < change * scene.step.dt);
    }
  }
}

TEST_CASE("the base's work is the energy of a block without friction, none is the scheme's, with every integrator",
          "[analysis][base_motion][energy]") {
  Scene scene = test::falling_block();
  scene.gravity = Vec2::Zero();
  scene.base_motion = uneven_record();
  for (const MethodInput& method : all_integrators(scene.method)) {
    INFO(name_of(method));
    scene.method = method;
    for (const double dt : {1e-3, 7e-3, 0.05}) {
      scene.step.dt = dt;
      Simulation simulation(scene);
      simulation.start_base_motion();
      advance(simulation, 7);
      const EnergyLedger& l = simulation.ledger();
      CHECK(l.turnover > 0.0);
      CHECK(std::abs(l.base_motion + l.kinetic) < 1e-12 * l.turnover);
      CHECK(std::abs(l.scheme) < 1e-12 * l.turnover);
    }
  }
}

TEST_CASE("the place of a block without friction on a shaken base is of second order, with every integrator", "[analysis][base_motion]") {
  Scene scene = block_without_friction();
  for (const MethodInput& method : all_integrators(scene.method)) {
    INFO(name_of(method));
    scene.method = method;
    CHECK(order_of_place(scene, 1) == Approx(2.0).margin(0.05));
  }
}

TEST_CASE("stiff contacts hold a block on a shaken base with forces of second order, by integrators that damp them", "[analysis][base_motion]") {
  // The longest step is 40 periods of the contacts: what they carry is what the scheme makes of the base, to (w_base/w_contacts)^2 = 1e-6.
  Scene scene = test::block_on_base();
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = 1e12;
  scene.joints[0].friction_angle = 60.0 * test::degree;
  scene.blocks[1].rotation_locked = true;
  scene.base_motion.emplace();
  scene.base_motion->kind = BaseMotionKind::harmonic;
  scene.base_motion->amplitude = {3.0, 0.0};
  scene.base_motion->frequency = 2.0;
  const double w = 4.0 * std::acos(-1.0), end = 1.0;
  for (const char* integrator : {"generalized_alpha", "tr_bdf2"}) {
    INFO(integrator);
    scene.method.integrator = integrator;
    const auto error = [&](int n) {
      scene.step.dt = end / n;
      Simulation simulation(scene);
      simulation.start_base_motion();
      double largest = 0.0;
      for (int i = 1; i <= n; ++i) {
        advance(simulation, 1);
        double shear = 0.0;
        for (const Contact& c : simulation.change_contacts()) shear += c.shear_force;
        const double exact = test::block_mass * 3.0 * std::sin(w * i * scene.step.dt);
        // By then the swings of the start are gone.
        if (2 * i > n) largest = std::max(largest, std::abs(std::abs(shear) - std::abs(exact)));
        // Nor does the block swing to and fro between the stages.
        if (2 * i > n) CHECK(std::abs(simulation.velocity(1)[0]) < 1e-4 * 3.0 * scene.step.dt);
      }
      return largest;
    };
    CHECK(std::log2(error(100) / error(200)) == Approx(2.0).margin(0.1));
  }
}

TEST_CASE("a steady acceleration of the base is another gravity", "[analysis][base_motion]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    const Vec2 a(2.0, -1.5);
    const auto after = [&](bool moving) {
      Scene scene = with_method(test::tumbling_blocks(), method);
      if (moving) {
        scene.base_motion.emplace();
        scene.base_motion->factor = 0.5;
        scene.base_motion->pulses = {{0.0, 100.0, 2.0 * a}};
      } else {
        scene.gravity -= a;
      }
      Simulation simulation(scene);
      simulation.start_base_motion();
      advance(simulation, 200);
      return simulation.system().state().displacement;
    };
    const auto moving = after(true), tilted = after(false);
    // Rounding grows with every collision.
    for (std::size_t b = 0; b < moving.size(); ++b) CHECK((moving[b] - tilted[b]).norm() < 1e-9);
    CHECK(moving[1].norm() > 0.1);
  }
}

TEST_CASE("the loop of dem takes the steps of dem", "[analysis][base_motion]") {
  Scene scene = with_method(test::tumbling_blocks(), "dem");
  scene.base_motion = uneven_record();
  scene.step.dt = 2e-4;
  constexpr int steps = 500;
  Simulation loop(scene);
  REQUIRE(loop.is_explicit());
  loop.start_base_motion();
  advance(loop, steps);
  test::PlainExplicit plain(scene);
  plain.start_base_motion();
  for (int i = 0; i < steps; ++i) plain.step(scene.step.dt);
  for (int b = 1; b <= 3; ++b) CHECK((loop.system().displacement(b) - plain.system().displacement(b)).norm() < 1e-9);
  CHECK(loop.ledger().base_motion == Approx(plain.ledger().base_motion).epsilon(1e-7));
  CHECK(std::abs(loop.ledger().base_motion) > 1e-3 * loop.ledger().turnover);
}

TEST_CASE("the ledger closes on a moving base", "[analysis][base_motion][energy]") {
  for (const std::string& method : all_methods) {
    for (const double theta : {1.0, 0.5}) {
      if (theta < 1.0 && method != "soft") continue;
      INFO(method << ", theta = " << theta);
      Scene scene = with_method(test::tumbling_blocks(), method);
      scene.method.theta = theta;
      scene.base_motion = uneven_record();
      Simulation simulation(scene);
      simulation.start_base_motion();
      advance(simulation, 400);
      const EnergyLedger& l = simulation.ledger();
      CHECK(std::abs(l.imbalance()) < 1e-10 * l.turnover);
      CHECK(std::abs(l.base_motion) > 1e-3 * l.turnover);
    }
  }
}

TEST_CASE("the ledger closes on a moving base with every integrator", "[analysis][base_motion][energy]") {
  Scene scene = test::tumbling_blocks();
  scene.base_motion = uneven_record();
  for (const MethodInput& method : all_integrators(scene.method)) {
    INFO(name_of(method));
    scene.method = method;
    Simulation simulation(scene);
    simulation.start_base_motion();
    advance(simulation, 400);
    const EnergyLedger& l = simulation.ledger();
    CHECK(std::abs(l.imbalance()) < 1e-10 * l.turnover);
    CHECK(std::abs(l.base_motion) > 1e-3 * l.turnover);
  }
}

TEST_CASE("the base moves from time 0 of a run on, not while it settles", "[analysis][base_motion]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = with_method(test::block_on_base(), method);
    scene.method.start = Start::settled;
    scene.base_motion.emplace();
    scene.base_motion->pulses = {{0.0, 100.0, {20.0, 0.0}}};
    Simulation simulation(scene);
    REQUIRE(prepare_start(simulation).converged);
    CHECK(std::abs(simulation.system().displacement(1)[0]) < 1e-9);
    CHECK(simulation.ledger().base_motion == 0.0);
    advance(simulation, 100);
    // Sliding back by (a - mu g) t^2/2.
    const double expected = -0.5 * (20.0 - std::tan(scene.joints[0].friction_angle) * 9.81) * 0.01;
    CHECK(simulation.system().displacement(1)[0] == Approx(expected).epsilon(0.02));
    CHECK(simulation.ledger().base_motion < 0.0);
  }
}

TEST_CASE("the cohesion of a shaken block does not hang on where its ground has joints", "[analysis][base_motion]") {
  // Ground of two or three rocks, on which rigid contacts share the block's weight in more than one way; those that carry nothing have no cohesion.
  // It slides to the left, over joints that lie under it and over some that it only comes to, with contacts that begin with next to no length.
  constexpr double pulse = 8.0, time = 0.5, friction = 0.1, cohesion = 3000.0, length = 1.0, height = 0.3, weight = 10.0, far = 4.0;
  const std::vector<double> joints = GENERATE(std::vector{0.4}, std::vector{0.7}, std::vector{0.95}, std::vector{0.98}, std::vector{0.02},
                                              std::vector{-0.3}, std::vector{-0.04, 0.37}, std::vector{-0.44, -0.41});
  CAPTURE(joints);
  std::vector<BlockInput> blocks;
  double begin = -far;
  for (std::size_t i = 0; i <= joints.size(); ++i) {
    const double end = i < joints.size() ? joints[i] : far;
    blocks.push_back(test::fixed_block("ground", test::rectangle(begin, -1.0, end - begin, 1.0)));
    blocks.back().material = static_cast<int>(i);
    begin = end;
  }
  blocks.push_back(test::free_block("block", test::rectangle(0.0, 0.0, length, height)));
  Scene scene = test::scene_with(blocks);
  scene.gravity = {0.0, -weight};
  JointProperties joint = test::frictional_joint(1e9, 5e8, std::atan(friction));
  joint.cohesion = cohesion;
  scene.joints = {joint};
  for (int i = 1; i <= static_cast<int>(joints.size()); ++i) {
    scene.materials.push_back(scene.materials[0]);
    scene.joints.push_back(joint);
    scene.joints.back().materials = {0, i};
  }
  scene.method.contact = "hard";
  scene.method.gap_tolerance = MethodInput().gap_tolerance;
  scene.method.start = Start::settled;
  scene.step.dt = GENERATE(2e-3, 4e-3);
  scene.end_time = 2.0;
  scene.base_motion.emplace();
  scene.base_motion->kind = BaseMotionKind::pulses;
  scene.base_motion->pulses = {{0.0, time, {pulse, 0.0}}};
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).converged);
  // Against its bound it comes to pulse - bound for so long, and to a stop by the bound alone; it begins and ends to slide within a step.
  const double bound = friction * weight + cohesion * length / (scene.materials[0].density * length * height), speed = (pulse - bound) * time;
  const double exact = -0.5 * speed * time - 0.5 * speed * speed / bound, of_a_step = pulse * scene.step.dt * scene.step.dt;
  CHECK(simulation.system().displacement(static_cast<int>(blocks.size()) - 1)[0] == Approx(exact).margin(of_a_step));
}
