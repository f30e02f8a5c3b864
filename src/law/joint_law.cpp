#include "openclose/law/joint_law.h"

#include <algorithm>
#include <cmath>

#include "openclose/core/tolerance.h"

namespace openclose {

ContactStrength::ContactStrength(const JointProperties& joint, const Contact& contact) : friction(std::tan(joint.friction_angle)) {
  const bool intact = contact.bonded || joint.cohesion_behaviour == CohesionBehaviour::ductile;
  cohesion = intact ? joint.cohesion * contact.length : 0.0;
  tension = contact.bonded ? joint.tensile_strength * contact.length : 0.0;
}

ContactStrength::ShearBound ContactStrength::shear_bound(double n) const {
  const double full = friction * n + cohesion;
  const double steep = friction + 1.0 / tolerance::cohesion_ramp;
  const double ramp = steep * (n + tension);
  if (ramp < full) return {std::max(0.0, ramp), ramp > 0.0 ? steep : 0.0};
  return {std::max(0.0, full), full > 0.0 ? friction : 0.0};
}

ContactDashpots::ContactDashpots(const JointProperties& joint, double length, double reduced_mass)
    : normal(2.0 * joint.damping_ratio * std::sqrt(joint.normal_stiffness * length * reduced_mass)),
      shear(2.0 * joint.damping_ratio * std::sqrt(joint.shear_stiffness * length * reduced_mass)) {}

double viscous_normal(const ContactSprings& springs, const ContactStrength& strength, double gap_change) {
  const double opening = springs.target + (springs.shift + strength.tension) / springs.normal;
  return -springs.normal_damping * (std::max(0.0, springs.gap - opening) + gap_change);
}

ContactForces spring_slider(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change) {
  ContactForces f;
  const double n = springs.shift - springs.normal * ((springs.gap - springs.target) + gap_change);
  const bool open = strength.tension > 0.0 ? n < -strength.tension : n <= 0.0;
  if (open) return f;
  const double with_dashpot = n + viscous_normal(springs, strength, gap_change);
  const bool carries = with_dashpot > -strength.tension || springs.normal_damping == 0.0;
  f.elastic_normal = n;
  f.normal = carries ? with_dashpot : -strength.tension;
  f.normal_by_gap = carries ? -(springs.normal + springs.normal_damping) : 0.0;
  const double elastic_trial = springs.initial_shear - springs.shear * slip_change;
  const double trial = elastic_trial - springs.shear_damping * slip_change;
  const auto bound = strength.shear_bound(f.normal);
  f.elastic_shear = std::clamp(elastic_trial, -bound.value, bound.value);
  if (std::abs(trial) <= bound.value) {
    f.status = ContactStatus::sticking;
    f.shear = trial;
    f.shear_by_slip = -(springs.shear + springs.shear_damping);
  } else {
    f.status = ContactStatus::sliding;
    f.shear = std::copysign(bound.value, trial);
    f.shear_by_gap = std::copysign(bound.slope, trial) * f.normal_by_gap;
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

bool stays_bonded(const JointProperties& joint, bool bonded, ContactStatus status) {
  if (status == ContactStatus::open) return false;
  return bonded && !(joint.cohesion_behaviour == CohesionBehaviour::lost_on_slip && status == ContactStatus::sliding);
}

}  // namespace openclose
