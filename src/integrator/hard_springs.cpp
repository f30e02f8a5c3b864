#include "openclose/integrator/hard_springs.h"

#include <algorithm>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// In motion a closed contact keeps the gap it has, so that standing still is always consistent, unless earlier steps have left more than they
/// should; an open one closes to zero, and a penetration found on closing is pushed out slowly. In statics every contact goes back to zero gap.
double target_gap(const StepProblem& problem, const Contact& contact) {
  if (problem.statics) return 0.0;
  if (contact.status == ContactStatus::open) return std::min(0.0, contact.gap + tolerance::hard_recovery_m_per_s * problem.dt);
  return held_gap(problem, contact);
}

ContactSprings with_stiffness(const StepProblem& problem, const Contact& contact, double normal, double shear) {
  ContactSprings s;
  s.normal = normal;
  s.shear = shear;
  s.gap = contact.gap;
  s.target = target_gap(problem, contact);
  s.shift = problem.statics && contact.status == ContactStatus::open ? -s.normal * contact.slack : contact.normal_force;
  s.initial_shear = contact.shear_force;
  return s;
}

}  // namespace

double inertia_at(const StepProblem& problem, const Contact& contact) {
  double mass = 0.0;
  for (int b : {contact.vertex_block, contact.edge_block}) {
    if (problem.system.block(b).equation >= 0) mass = std::max(mass, problem.system.block(b).mass[0]);
  }
  return problem.inertia * mass;
}

double held_gap(const StepProblem& problem, const Contact& contact) {
  const double level = -kept_penetration * problem.method.gap_tolerance;
  if (contact.gap >= level) return contact.gap;
  const double recovered = recovered_penetration * problem.method.gap_tolerance;
  return std::min(level, contact.gap + (problem.statics ? recovered : std::min(recovered, tolerance::hard_recovery_m_per_s * problem.dt)));
}

ContactSprings hard_springs_of_inertia(const StepProblem& problem, const Contact& contact, double ratio) {
  const double stiffness = ratio * inertia_at(problem, contact);
  return with_stiffness(problem, contact, stiffness, stiffness);
}

ContactSprings hard_springs_of_joint(const StepProblem& problem, const Contact& contact, double factor, double least) {
  const JointProperties& joint = problem.joints.joint(contact.joint);
  const JointSprings own(joint, contact.length);
  if (factor * own.normal >= least) return with_stiffness(problem, contact, factor * own.normal, factor * own.shear);
  return with_stiffness(problem, contact, least, least * (joint.shear_stiffness / joint.normal_stiffness));
}

}  // namespace openclose
