#include "openclose/law/joint_law.h"

namespace openclose {

ContactStrength::ContactStrength(const JointProperties& joint, double tangent, const Contact& contact) : friction(tangent) {
  const bool intact = contact.bonded || joint.cohesion_behaviour == CohesionBehaviour::ductile;
  cohesion = intact ? joint.cohesion * contact.length : 0.0;
  tension = contact.bonded ? joint.tensile_strength * contact.length : 0.0;
}

void ContactStrength::break_bond(const JointProperties& joint) {
  if (joint.cohesion_behaviour != CohesionBehaviour::ductile) cohesion = 0.0;
  tension = 0.0;
}

ContactStrength::ShearBound ContactStrength::shear_bound(double n) const {
  const double value = largest_shear(n), steep = friction + 1.0 / tolerance::cohesion_ramp;
  const bool on_ramp = steep * (n + tension) < friction * n + cohesion;
  return {value, value > 0.0 ? (on_ramp ? steep : friction) : 0.0};
}

ContactDashpots::ContactDashpots(const JointProperties& joint, double length, double reduced_mass)
    : normal(2.0 * joint.damping_ratio * std::sqrt(joint.normal_stiffness * length * reduced_mass)),
      shear(2.0 * joint.damping_ratio * std::sqrt(joint.shear_stiffness * length * reduced_mass)) {}

double viscous_normal(const ContactSprings& springs, const ContactStrength& strength, double gap_change) {
  const double opening = springs.target + (springs.shift + strength.tension) / springs.normal;
  return -springs.normal_damping * (std::max(0.0, springs.gap - opening) + gap_change);
}

ContactForces spring_slider(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change) {
  ForceTrials trial;
  trial.elastic_normal = springs.shift - springs.normal * ((springs.gap - springs.target) + gap_change);
  trial.viscous_normal = viscous_normal(springs, strength, gap_change);
  trial.elastic_shear = springs.initial_shear - springs.shear * slip_change;
  trial.viscous_shear = -springs.shear_damping * slip_change;
  ContactForces f{carry(strength, trial)};
  if (f.status == ContactStatus::open) return f;
  const bool dashpot_outweighs = springs.normal_damping > 0.0 && f.normal <= -strength.tension;
  f.normal_by_gap = dashpot_outweighs ? 0.0 : -(springs.normal + springs.normal_damping);
  if (f.status == ContactStatus::sticking) {
    f.shear_by_slip = -(springs.shear + springs.shear_damping);
  } else {
    f.shear_by_gap = std::copysign(strength.shear_bound(f.normal).slope, trial.elastic_shear + trial.viscous_shear) * f.normal_by_gap;
  }
  return f;
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
    const ContactStrength::ShearBound bound = strength.shear_bound(normal);
    f.shear = std::copysign(1.0, shear) * (bound.value + bound.slope * (f.normal - normal));
  }
  return f;
}

bool can_lose_strength(const JointProperties& joint, bool bonded) {
  return bonded && (joint.tensile_strength > 0.0 || (joint.cohesion > 0.0 && joint.cohesion_behaviour != CohesionBehaviour::ductile));
}

bool stays_bonded(const JointProperties& joint, bool bonded, ContactStatus status) {
  if (status == ContactStatus::open) return false;
  return bonded && !(joint.cohesion_behaviour == CohesionBehaviour::lost_on_slip && status == ContactStatus::sliding);
}

}  // namespace openclose
