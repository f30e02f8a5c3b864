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

Scene scene_of(const Scheme& scheme, double ratio, double dt) {
  Scene scene = empty_scene();
  scene.materials[0].density = density;
  scene.joints[0].normal_stiffness = stiffness;
  scene.joints[0].shear_stiffness = 0.5 * stiffness;
  scene.joints[0].friction_angle = 60.0 * analytical::degree;
  scene.joints[0].damping_ratio = ratio;
  scene.blocks = {fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)),
                  free_block("block", {{0.0, 0.0}, {length, length}, {0.0, 2.0 * length}, {-length, length}})};
  scene.blocks[1].rotation_locked = true;
  set_scheme(scene, scheme);
  use_joint_springs_as_penalty(scene);
  scene.settle.unbalanced_fraction = 1e-12;
  scene.step.dt = dt;
  return scene;
}

double frequency(bool along) {
  return std::sqrt((along ? 0.5 : 1.0) * stiffness * length / (density * side * side));
}

/// Displacement along or normal to the base, some steps after a push out of the settled state.
double follow(Simulation& simulation, bool along, double velocity, int steps) {
  if (!settle(simulation).settled) return not_measured();
  const Vec2 rest = simulation.system().centroid(1);
  simulation.set_velocity(1, along ? Eigen::Vector3d(velocity, 0.0, 0.0) : Eigen::Vector3d(0.0, -velocity, 0.0));
  simulation.restart_clock();
  for (int i = 0; i < steps; ++i) {
    if (!simulation.advance(simulation.scene().step.dt)) return not_measured();
  }
  const Vec2 moved = simulation.system().centroid(1) - rest;
  return along ? moved.x() : -moved.y();
}

/// Where the dashpots' velocity does not belong to the moment of the other forces.
bool has_late_dashpots(const Scheme& scheme) {
  return scheme.contact == "dem" || scheme.integrator == "generalized_alpha" || scheme.integrator == "tr_bdf2";
}

void damping(Report& report, const Scheme& scheme, double ratio, bool along) {
  const double w = frequency(along), end = 2.0 / w;
  // A tenth of the closure under the weight: the contact stays closed and sticks.
  const double velocity = 0.1 * 9.81 / (frequency(false) * frequency(false)) * w;
  const std::string name = text("damping ratio {}", ratio) + (along ? ", shear" : ", normal");
  std::vector<double> steps, errors;
  // What late dashpots add is of order 1 and grows with their ratio; where that is small, the smooth error of order 2 may have the same size and the
  // other sign, as that of generalised alpha has at 73 steps of ratio 0.1. Sixteen times as many show the order.
  const int refined = scheme.integrator == "generalized_alpha" && ratio < 1.0 ? 16 : 1;
  for (const int n : {80 * refined, 160 * refined, 320 * refined, 640 * refined}) {
    steps.push_back(end / n);
    const double exact = velocity * analytical::damped_vibration(w, ratio, end);
    Simulation simulation = report.simulate(scene_of(scheme, ratio, end / n));
    errors.push_back(std::abs(follow(simulation, along, velocity, n) - exact) / velocity * w);
    if (n == 80 * refined) check_ledger(report, with_variant(name, scheme), scheme.contact, simulation, !std::isnan(errors.back()));
  }
  const double expected = has_late_dashpots(scheme) ? 1.0 : scheme.order;
  report.order(with_variant("order, " + name, scheme), scheme.contact, steps, errors, expected - 0.1, expected + 0.1,
               "damped oscillator, m* = mass of the block on a fixed base");
}

void contact_damping(Report& report) {
  for (const double ratio : {0.1, 1.0, 2.0}) {
    for (const bool along : {false, true}) {
      for (const Scheme& scheme : spring_schemes()) damping(report, scheme, ratio, along);
    }
  }
  report.leave_out("contact damping", "hard", "rigid contacts have no springs and impacts without rebound");
}

const Registered<Case> registered{{"D1c", "contact damping of one block on one contact", &contact_damping}};

}  // namespace
}  // namespace openclose::verification
