// B3: the smallest cohesion that holds a block on a plane steeper than its friction angle, bracketed by bisection, every trial from a settled start.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/cohesion_threshold.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

/// 1 if it does, 0 if the block slides away, NaN for any other end.
double holds(const Report& report, const analytical::BlockOnPlane& data, const std::string& method, CohesionBehaviour behaviour, double cohesion) {
  Scene scene = block_on_plane(data);
  scene.joints[0].cohesion = cohesion;
  scene.joints[0].cohesion_behaviour = behaviour;
  scene.method.contact = method;
  scene.step.dt = 0.01;
  use_joint_springs_as_penalty(scene);
  // Far above what its springs give before it slides, a part of a millimetre.
  scene.settle.failure_displacement = 0.01;
  return stands(report, scene);
}

/// The smallest cohesion [Pa] that holds, between 0.9 and 1.1 of the expected one, to `width` of it.
double smallest_cohesion(const Report& report, const analytical::BlockOnPlane& data, const std::string& method, CohesionBehaviour behaviour,
                         double expected, double width) {
  return threshold(0.9 * expected, 1.1 * expected, width * expected,
                   [&](double cohesion) { return holds(report, data, method, behaviour, cohesion); });
}

void cohesion_threshold(Report& report) {
  const analytical::BlockOnPlane data;
  const double ductile = analytical::ductile_cohesion_threshold(data);
  for (const std::string& method : all_methods) {
    for (const auto behaviour : {CohesionBehaviour::ductile, CohesionBehaviour::lost_on_opening}) {
      const double measured = smallest_cohesion(report, data, method, behaviour, ductile, 1e-7);
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
      const double measured = smallest_cohesion(report, stiffer, method, CohesionBehaviour::lost_on_slip, brittle, 1e-8);
      errors.push_back(std::abs(measured / brittle - 1.0));
    }
    if (method == "soft") error_of_soft = errors.front();
    report.order("threshold, lost on slip, error over compliance", method, compliance, errors, 0.9, 1.1, "rigid limit; elastic tilt: order 1 in 1/kn",
                 compliance_name);
  }
  // The same springs and so the same tilt as with `soft`, whose error it is; that of equal shares after swinging comes on top.
  const double by_steps = smallest_cohesion(report, data, "dem", CohesionBehaviour::lost_on_slip, brittle, 1e-6);
  report.relative("threshold, lost on slip", "dem", brittle, by_steps, 2.0 * error_of_soft, "Pa",
                  "equal shares of T; twice the error of soft, by elastic tilt");
  const double measured = smallest_cohesion(report, data, "hard", CohesionBehaviour::lost_on_slip, brittle, 1e-7);
  // How two rigid sticking corners share T is open; `hard` shares it as springs do that are linear in the motion of the block, and both corners lie
  // on one line along which they slip alike.
  report.relative("threshold, lost on slip", "hard", brittle, measured, 1e-6, "Pa", "equal shares of T; rigid: no tilt");
}

const Registered<Case> registered{{"B3", "cohesion threshold", &cohesion_threshold}};

}  // namespace
}  // namespace openclose::verification
