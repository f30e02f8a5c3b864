// A4: three blocks that collide in free space. Contact forces are equal and opposite, so linear momentum stays to rounding. They share their line of
// action at the end of the step, while the centroids move during the step: angular momentum about a fixed point changes by half the relative
// displacement of the centroids times the force in every step, which sums up to an error of first order in dt.
#include <algorithm>
#include <cmath>

#include "harness.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Momentum {
  Vec2 linear = Vec2::Zero();
  double angular = 0.0;
  double size = 0.0;  ///< sum of |m v|
};

Momentum momentum(const Simulation& simulation) {
  Momentum sum;
  const auto& system = simulation.system();
  for (int b : system.free_blocks()) {
    const auto p = system.block(b).mass.cwiseProduct(system.velocity(b)).eval();
    sum.linear += p.head<2>();
    sum.angular += cross(system.centroid(b), p.head<2>()) + p[2];
    sum.size += p.head<2>().norm();
  }
  return sum;
}

Scene cluster(const std::string& method, double dt) {
  analytical::BlockOnPlane data;
  data.normal_stiffness = data.shear_stiffness = 5e6;
  Scene scene = empty_scene(data);
  scene.gravity = Vec2::Zero();
  scene.method.contact = method;
  use_joint_springs_as_penalty(scene);
  scene.step = {dt, 1.0, 1e-6};
  scene.end_time = 0.3;
  BlockInput left = free_block("left", rectangle(0.0, 0.0, 2.0, 1.0));
  left.velocity = {1.0, 0.2};
  BlockInput right = free_block("right", rectangle(2.1, 0.3, 1.0, 2.0));
  right.velocity = {-1.0, -0.3};
  BlockInput top = free_block("top", {{0.2, 1.1}, {1.6, 1.2}, {0.9, 2.0}});
  top.velocity = {0.5, -1.0};
  scene.blocks = {left, right, top};
  return scene;
}

struct Drift {
  double linear_per_step;  ///< largest, over the sum of |m v|
  double angular;          ///< at the end, absolute
};

void ledger(Report& report, const Scheme& scheme) {
  constexpr double dt = 1e-3;
  Scene scene = cluster(scheme.contact, dt);
  set_scheme(scene, scheme);
  Simulation simulation = report.simulate(scene);
  const auto velocity = simulation.velocity(0);
  bool done = true;
  for (int i = 0; i < std::lround(scene.end_time / dt) && done; ++i) done = simulation.advance(dt);
  check_ledger(report, with_variant("cluster", scheme), scheme.contact, simulation, done && (simulation.velocity(0) - velocity).norm() > 0.1);
}

Drift drift(const Report& report, const std::string& method, double dt, const std::optional<std::string>& integrator = {}) {
  Scene scene = cluster(method, dt);
  scene.method.integrator = integrator;
  Simulation simulation = report.simulate(scene);
  const Momentum start = momentum(simulation);
  const auto velocity = simulation.velocity(0);
  Drift d{0.0, 0.0};
  Momentum before = start;
  for (int i = 0; i < std::lround(simulation.scene().end_time / dt); ++i) {
    if (!simulation.advance(dt)) return {not_measured(), not_measured()};
    const Momentum now = momentum(simulation);
    d.linear_per_step = larger(d.linear_per_step, (now.linear - before.linear).norm() / start.size);
    before = now;
  }
  d.angular = std::abs(before.angular - start.angular);
  const bool collided = (simulation.velocity(0) - velocity).norm() > 0.1;
  return collided ? d : Drift{not_measured(), not_measured()};
}

void momentum(Report& report) {
  for (const Scheme& scheme : schemes()) ledger(report, scheme);
  for (const double dt : {2e-3, 4e-4, 1e-4}) {
    const Drift d = drift(report, "soft", dt, "path_average");
    report.near(text("path_average: linear momentum, largest change in a step, dt = {} s", dt), "soft", 0.0, d.linear_per_step, 1e-13, "-",
                "action = reaction; relative to the sum of |m v|");
    report.near(text("path_average: angular momentum, dt = {} s", dt), "soft", 0.0, d.angular, 1e-12 * 1.6e4, "Nms",
                "forces act at the mean of the places before and after the step; rounding of sums of |m v| over 150 to 3000 steps");
  }
  for (const std::string& method : all_methods) {
    double worst = 0.0;
    std::vector<double> steps, errors;
    for (const double dt : {4e-4, 2e-4, 1e-4, 5e-5}) {
      const Drift d = drift(report, method, dt);
      worst = larger(worst, d.linear_per_step);
      steps.push_back(dt);
      errors.push_back(d.angular);
    }
    report.near("linear momentum, largest change in a step", method, 0.0, worst, 1e-13, "-", "action = reaction; relative to the sum of |m v|");
    if (method == "hard") {
      report.leave_out(
          "angular momentum, order in dt", method,
          "an impact takes one step; its part before the contact is a random fraction of dt, so the error of order dt does not fall smoothly");
      for (std::size_t i = 0; i < steps.size(); ++i) {
        // Half the relative displacement of a step (at most 2.5 m/s dt) times the impulses exchanged (at most the sum of |m v| = 1.6e4 Ns).
        report.near(text("angular momentum, dt = {} s", steps[i]), method, 0.0, errors[i], 0.5 * 2.5 * steps[i] * 1.6e4, "Nms",
                    "dt/2 times approach speed times impulse");
      }
    } else if (method == "dem") {
      // Forces and levers are those of one moment, where the step starts.
      double worst_angular = 0.0;
      for (const double e : errors) worst_angular = larger(worst_angular, e);
      report.near("angular momentum", method, 0.0, worst_angular, 1e-13 * 1.6e4, "Nms", "action = reaction on one line; rounding of sums of |m v|");
    } else {
      report.order("angular momentum, order in dt", method, steps, errors, 0.8, 1.2, "force at the end of the step: order 1");
    }
  }
}

const Registered<Case> registered{{"A4", "momentum of a free cluster", &momentum, Reference::conservation}};

}  // namespace
}  // namespace openclose::verification
