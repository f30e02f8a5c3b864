#include "openclose/law/joint_law.h"

namespace openclose {

ContactDashpots::ContactDashpots(const JointProperties& joint, double length, double reduced_mass) {
  const JointSprings springs(joint, length);
  const auto dashpot = [&](double stiffness) { return 2.0 * joint.damping_ratio * std::sqrt(stiffness * reduced_mass); };
  normal = dashpot(springs.normal);
  shear = joint.shear_stiffness == joint.normal_stiffness ? normal : dashpot(springs.shear);
}

ContactForces tangent_for_status(const ContactSprings& springs, const ContactStrength& strength, ContactStatus status, double normal, double shear) {
  ContactForces f;
  f.status = status;
  if (status == ContactStatus::open) return f;
  f.normal_by_gap = -(springs.normal + springs.normal_damping);
  if (status == ContactStatus::sticking) {
    f.shear_by_slip = -(springs.shear + springs.shear_damping);
  } else {
    f.shear_by_gap = std::copysign(strength.shear_bound(normal).slope, shear) * f.normal_by_gap;
  }
  return f;
}

ContactForces prolonged(const ContactSprings& springs, const ContactStrength& strength, ContactStatus status, double normal, double shear,
                        double gap_change, double slip_change) {
  ContactForces f = tangent_for_status(springs, strength, status, normal, shear);
  if (status == ContactStatus::open) return f;
  f.elastic_normal = springs.shift - springs.normal * ((springs.gap - springs.target) + gap_change);
  f.normal = f.elastic_normal + viscous_normal(springs, strength, gap_change);
  f.elastic_shear = springs.initial_shear - springs.shear * slip_change;
  if (status == ContactStatus::sticking) {
    f.shear = f.elastic_shear - springs.shear_damping * slip_change;
  } else {
    const ShearLimit<double> bound = strength.shear_bound(normal);
    f.shear = std::copysign(1.0, shear) * (bound.value + bound.slope * (f.normal - normal));
  }
  return f;
}

bool can_lose_strength(const JointProperties& joint, const JointState& state) {
  return state.bonded &&
         (joint.softens() || joint.tensile_strength > 0.0 || (joint.cohesion > 0.0 && joint.cohesion_behaviour != CohesionBehaviour::ductile));
}

bool weakens_along_slip(const JointProperties& joint, const JointState& state) {
  return state.bonded && joint.slip_weakening_distance > 0.0;
}

JointState state_after(const JointProperties& joint, const JointState& before, ContactStatus status, double slip) {
  JointState after = before;
  if (status == ContactStatus::open) {
    after.bonded = false;
  } else if (status == ContactStatus::sliding && before.bonded && joint.weakens_by_slip()) {
    after.slip = std::min(before.slip + slip, joint.slip_weakening_distance);
    after.bonded = after.slip < joint.slip_weakening_distance;
  }
  return after;
}

double loss(const JointProperties& joint, const JointState& before, const JointState& after) {
  const auto lost = [&](const JointState& state) { return state.bonded ? weakening(joint, state) : 1.0; };
  return before.bonded && !after.bonded ? 1.0 : lost(after) - lost(before);
}

}  // namespace openclose
