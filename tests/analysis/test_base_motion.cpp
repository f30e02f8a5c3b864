// A moving base with every method: what blocks feel, when it begins, what the ledger says.
#include <cmath>

#include "openclose/analysis/run.h"
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

void advance(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) REQUIRE(simulation.advance(simulation.scene().step.dt));
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
    scene.base_motion.emplace();
    scene.base_motion->kind = BaseMotionKind::harmonic;
    scene.base_motion->amplitude = {3.0, 0.0};
    scene.base_motion->frequency = 2.0;
    const double w = 4.0 * std::acos(-1.0), end = 0.3;
    const double exact = -3.0 / (w * w) * (w * end - std::sin(w * end));
    const auto error = [&](int n) {
      scene.step.dt = end / n;
      Simulation simulation(scene);
      simulation.start_base_motion();
      advance(simulation, n);
      return std::abs(simulation.system().displacement(0)[0] - exact);
    };
    CHECK(std::log2(error(100) / error(200)) == Approx(2.0).margin(0.05));
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
