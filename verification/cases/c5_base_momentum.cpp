// C5: a block without friction on a shaken base: nothing but the base's inertia acts along it, so that it keeps its place in space. Every scheme must
// give it exactly the change of the base's velocity, and its place with order 2.
#include <cmath>
#include <numbers>
#include <vector>

#include "harness.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double end = 0.3;  // [s]

analytical::BlockOnPlane block_without_friction() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = 0.0;
  return data;
}

/// \param steps  to the end
Scene scene_of(const Scheme& scheme, int steps) {
  Scene scene = block_on_plane(block_without_friction());
  set_scheme(scene, scheme);
  scene.method.start = Start::normal_balanced;
  scene.step.dt = end / steps;
  scene.end_time = end;
  scene.output_every = end;
  scene.base_motion.emplace();
  use_joint_springs_as_penalty(scene);
  return scene;
}

Motion::Unknowns velocity_at_end(Simulation& simulation) {
  return history(simulation).empty() ? Motion::Unknowns(Motion::Unknowns::Constant(not_measured())) : simulation.velocity(1);
}

/// Shorter than a step, wherever in it, over its end, too: schemes that weigh the forces of a step or take them at some time of it would make more or
/// less of it.
void pulses(Report& report, const Scheme& scheme) {
  constexpr int steps = 60;
  constexpr double change = 0.1;  // [m/s]
  double worst = 0.0;
  for (const double part : {0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.7, 0.9}) {
    Scene scene = scene_of(scheme, steps);
    const double duration = 0.2 * scene.step.dt;
    scene.base_motion->pulses = {{(20.0 + part) * scene.step.dt, duration, {change / duration, 0.0}}};
    Simulation simulation = report.simulate(scene);
    worst = larger(worst, std::abs(velocity_at_end(simulation)[0] / -change - 1.0));
    if (part == 0.4) check_ledger(report, with_variant("pulse within a step", scheme), scheme.contact, simulation, !std::isnan(worst));
  }
  report.against(Reference::conservation)
      .near(with_variant("velocity after a pulse within a step, largest error over the base's", scheme), scheme.contact, 0.0, worst, 1e-11, "-",
            "momentum: minus the change of the base's velocity; the rounding of 60 steps, and of contact forces of m g in a step over the change");
}

void shaking(Report& report, const Scheme& scheme) {
  constexpr double amplitude = 3.0, frequency = 2.0, w = 2.0 * std::numbers::pi * frequency;
  const double exact = -amplitude / (w * w) * (w * end - std::sin(w * end)), exact_velocity = -amplitude / w * (1.0 - std::cos(w * end));
  // Velocities at mid-steps are taken to the end of the step with the acceleration about it.
  const bool has_midsteps = scheme.contact == "hard" || scheme.contact == "dem";
  std::vector<double> steps, errors, velocity_errors;
  // Longer steps are above the critical one of `dem`, which would take more of them.
  for (const int n : {80, 160, 320, 640}) {
    Scene scene = scene_of(scheme, n);
    scene.base_motion->kind = BaseMotionKind::harmonic;
    scene.base_motion->amplitude = {amplitude, 0.0};
    scene.base_motion->frequency = frequency;
    Simulation simulation = report.simulate(scene);
    steps.push_back(scene.step.dt);
    velocity_errors.push_back(std::abs(velocity_at_end(simulation)[0] / exact_velocity - 1.0));
    errors.push_back(std::abs(simulation.system().displacement(1)[0] - exact));
  }
  report.order(with_variant("place on a base that swings", scheme), scheme.contact, steps, errors, 1.9, 2.1, "-(A/w^2) (w t - sin w t); order 2");
  if (has_midsteps) return;
  report.near(with_variant("velocity on a base that swings, largest error over the base's", scheme), scheme.contact, 0.0, largest(velocity_errors),
              1e-11, "-", "-(A/w) (1 - cos w t), exact at every step; rounding of 640 steps");
}

void base_momentum(Report& report) {
  for (const Scheme& scheme : schemes()) {
    pulses(report, scheme);
    shaking(report, scheme);
  }
}

const Registered<Case> registered{{"C5", "block without friction on a shaken base: exactly its momentum", &base_momentum}};

}  // namespace
}  // namespace openclose::verification
