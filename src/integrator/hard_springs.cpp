#include "openclose/integrator/hard_springs.h"

#include <algorithm>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] Springs of contacts that are short beside their block, at least, over those of a contact that is half as long as the block's radius: what has
/// to hold by softer ones alone takes many passes. A stiffer one takes more than its share while it is shorter than that, and keeps the pressure.
constexpr double softest_of_short_contacts = 1e-3;

/// The heavier one of its blocks that are not fixed.
const BlockSystem::Block& heavier_block(const StepProblem& problem, const Contact& contact) {
  const auto &one = problem.system.block(contact.vertex_block), &other = problem.system.block(contact.edge_block);
  if (one.equation < 0) return other;
  return other.equation >= 0 && other.mass[0] > one.mass[0] ? other : one;
}

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
  return problem.inertia * heavier_block(problem, contact).mass[0];
}

double held_gap(const StepProblem& problem, const Contact& contact) {
  const double level = -kept_penetration * problem.method.gap_tolerance;
  if (contact.gap >= level) return contact.gap;
  const double recovered = recovered_penetration * problem.method.gap_tolerance;
  return std::min(level, contact.gap + (problem.statics ? recovered : std::min(recovered, tolerance::hard_recovery_m_per_s * problem.dt)));
}

ContactSprings hard_springs_of_inertia(const StepProblem& problem, const Contact& contact, double ratio) {
  const double relative = std::max(softest_of_short_contacts, contact.length / (0.5 * heavier_block(problem, contact).radius));
  const double stiffness = ratio * relative * inertia_at(problem, contact);
  return with_stiffness(problem, contact, stiffness, stiffness);
}

ContactSprings hard_springs_of_joint(const StepProblem& problem, const Contact& contact, double factor, double least) {
  const JointProperties& joint = problem.joints.joint(contact.joint);
  const JointSprings own(joint, contact.length);
  if (factor * own.normal >= least) return with_stiffness(problem, contact, factor * own.normal, factor * own.shear);
  return with_stiffness(problem, contact, least, least * (joint.shear_stiffness / joint.normal_stiffness));
}

}  // namespace openclose
