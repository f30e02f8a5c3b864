// B3: the smallest cohesion that holds a block on a plane steeper than its friction angle, bracketed by bisection, every trial from a settled start.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/cohesion_threshold.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

bool holds(const Report& report, const analytical::BlockOnPlane& data, const std::string& method, CohesionBehaviour behaviour, double cohesion) {
  Scene scene = block_on_plane(data);
  scene.joints[0].cohesion = cohesion;
  scene.joints[0].cohesion_behaviour = behaviour;
  scene.method.contact = method;
  scene.step.dt = 0.01;
  use_joint_springs_as_penalty(scene);
  Simulation simulation = report.simulate(scene);
  return settle(simulation).settled;
}

/// Largest cohesion [Pa] that does not hold, to `width`; NaN if the bracket does not hold above and fail below.
double threshold(const Report& report, const analytical::BlockOnPlane& data, const std::string& method, CohesionBehaviour behaviour, double low,
                 double high, double width) {
  if (holds(report, data, method, behaviour, low) || !holds(report, data, method, behaviour, high)) return not_measured();
  while (high - low > width) {
    const double middle = 0.5 * (low + high);
    (holds(report, data, method, behaviour, middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

void cohesion_threshold(Report& report) {
  const analytical::BlockOnPlane data;
  const double ductile = analytical::ductile_cohesion_threshold(data);
  for (const std::string& method : all_methods) {
    for (const auto behaviour : {CohesionBehaviour::ductile, CohesionBehaviour::lost_on_opening}) {
      const double measured = threshold(report, data, method, behaviour, 0.9 * ductile, 1.1 * ductile, 1e-7 * ductile);
      report.relative(behaviour == CohesionBehaviour::ductile ? "threshold, ductile" : "threshold, lost on opening", method, ductile, measured, 1e-6,
                      "Pa", "c b = W (sin alpha - mu cos alpha); forces along the plane only, so no tilt enters");
    }
  }

  const double brittle = analytical::brittle_cohesion_threshold(data);
  double error_of_soft = not_measured();
  for (const std::string method : {"soft", "shi"}) {
    std::vector<double> compliance, errors;
    for (const double factor : {1.0, 4.0, 16.0}) {
      analytical::BlockOnPlane stiffer = data;
      stiffer.normal_stiffness *= factor;
      stiffer.shear_stiffness *= factor;
      compliance.push_back(1.0 / stiffer.normal_stiffness);
      const double measured = threshold(report, stiffer, method, CohesionBehaviour::lost_on_slip, 0.9 * brittle, 1.1 * brittle, 1e-8 * brittle);
      errors.push_back(std::abs(measured / brittle - 1.0));
    }
    if (method == "soft") error_of_soft = errors.front();
    report.order("threshold, lost on slip, error over compliance", method, compliance, errors, 0.9, 1.1, "rigid limit; elastic tilt: order 1 in 1/kn",
                 compliance_name);
  }
  // The same springs and so the same tilt as with `soft`, whose error it is; that of equal shares after swinging comes on top.
  const double by_steps = threshold(report, data, "dem", CohesionBehaviour::lost_on_slip, 0.9 * brittle, 1.1 * brittle, 1e-6 * brittle);
  report.relative("threshold, lost on slip", "dem", brittle, by_steps, 2.0 * error_of_soft, "Pa", "equal shares of T; twice the error of soft, by elastic tilt");
  const double measured = threshold(report, data, "hard", CohesionBehaviour::lost_on_slip, 0.9 * brittle, 1.1 * brittle, 1e-7 * brittle);
  // How two rigid sticking corners share T is open; `hard` shares it as springs do that are linear in the motion of the block, and both corners lie
  // on one line along which they slip alike.
  report.relative("threshold, lost on slip", "hard", brittle, measured, 1e-6, "Pa", "equal shares of T; rigid: no tilt");
}

const Registered<Case> registered{{"B3", "cohesion threshold", &cohesion_threshold}};

}  // namespace
}  // namespace openclose::verification
