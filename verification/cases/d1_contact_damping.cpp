// D1, contact damping: a block that cannot turn stands with one corner on a fixed base. Its single contact has the springs k_n L, k_s L and dashpots
// of the joint's damping ratio; the base is infinitely heavy, so that m* is the block's own mass and both motions have exactly that ratio.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/single_spring.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double side = 1.0;                  // [m] of a square on its corner
constexpr double stiffness = 2e8;             // [Pa/m] normal; shear half of it
const double length = side / std::sqrt(2.0);  // [m] tributary: half the projections of both sides
constexpr double density = 2500.0;            // [kg/m3]

Scene scene_of(const std::string& method, double theta, double ratio, double dt) {
  Scene scene = empty_scene();
  scene.materials[0].density = density;
  scene.joints[0].normal_stiffness = stiffness;
  scene.joints[0].shear_stiffness = 0.5 * stiffness;
  scene.joints[0].friction_angle = 60.0 * analytical::degree;
  scene.joints[0].damping_ratio = ratio;
  scene.blocks = {fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)),
                  free_block("block", {{0.0, 0.0}, {length, length}, {0.0, 2.0 * length}, {-length, length}})};
  scene.blocks[1].rotation_locked = true;
  scene.method.contact = method;
  scene.method.theta = theta;
  scene.method.penalty = stiffness;
  scene.method.penalty_shear_ratio = 0.5;
  scene.method.penetration_tolerance = 1.0;
  scene.settle.unbalanced_fraction = 1e-12;
  scene.step.dt = dt;
  return scene;
}

double frequency(bool along) {
  return std::sqrt((along ? 0.5 : 1.0) * stiffness * length / (density * side * side));
}

/// Displacement along or normal to the base, some steps after a push out of the settled state.
double follow(RigidSimulation& simulation, bool along, double velocity, int steps) {
  if (!settle(simulation).settled) return not_measured();
  const Vec2 rest = simulation.system().centroid(1);
  simulation.set_velocity(1, along ? Eigen::Vector3d(velocity, 0.0, 0.0) : Eigen::Vector3d(0.0, -velocity, 0.0));
  simulation.restart_clock();
  for (int i = 0; i < steps; ++i) {
    if (!simulation.step(simulation.scene().step.dt, false).accepted) return not_measured();
  }
  const Vec2 moved = simulation.system().centroid(1) - rest;
  return along ? moved.x() : -moved.y();
}

/// [m/s] For a tenth of the closure under the weight: the contact stays closed and sticks.
double push(bool along) {
  return 0.1 * 9.81 / (frequency(false) * frequency(false)) * frequency(along);
}

void order(Report& report, const std::string& method, double theta, double ratio, bool along) {
  const double w = frequency(along), end = 2.0 / w, velocity = push(along);
  std::vector<double> steps, errors;
  for (const int n : {80, 160, 320, 640}) {
    steps.push_back(end / n);
    const double exact = velocity * analytical::damped_vibration(w, ratio, end);
    RigidSimulation simulation = report.simulate(scene_of(method, theta, ratio, end / n));
    errors.push_back(std::abs(follow(simulation, along, velocity, n) - exact) / velocity * w);
  }
  const double expected = theta == 0.5 ? 2.0 : 1.0;
  const std::string name = text("order, damping ratio {}", ratio) + (along ? ", shear" : ", normal") + text(", theta = {}", theta);
  report.order(name, method, steps, errors, expected - 0.1, expected + 0.1, "damped oscillator, m* = mass of the block on a fixed base");
}

void ledger(Report& report, const std::string& method, double theta, bool along) {
  constexpr double ratio = 0.1;
  constexpr int steps = 200;
  RigidSimulation simulation = report.simulate(scene_of(method, theta, ratio, 10.0 / frequency(along) / steps));
  const bool done = !std::isnan(follow(simulation, along, push(along), steps));
  check_ledger(report, std::string("damping ratio 0.1, ") + (along ? "shear" : "normal") + text(", theta = {}", theta), method, simulation, done);
}

}  // namespace

void contact_damping(Report& report) {
  for (const double ratio : {0.1, 1.0, 2.0}) {
    for (const bool along : {false, true}) {
      for (const double theta : {1.0, 0.5}) order(report, "soft", theta, ratio, along);
      order(report, "shi", 1.0, ratio, along);
      // The velocity of its dashpots is half a step old.
      order(report, "dem", 1.0, ratio, along);
    }
  }
  for (const bool along : {false, true}) {
    for (const double theta : {1.0, 0.5}) ledger(report, "soft", theta, along);
    ledger(report, "shi", 1.0, along);
    ledger(report, "dem", 1.0, along);
  }
  report.leave_out("contact damping", "hard", "rigid contacts have no springs and impacts without rebound");
}

}  // namespace openclose::verification
