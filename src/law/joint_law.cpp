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

ContactForces spring_slider(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change) {
  ContactForces f;
  const double n = springs.shift - springs.normal * ((springs.gap - springs.target) + gap_change);
  const bool open = strength.tension > 0.0 ? n < -strength.tension : n <= 0.0;
  if (open) return f;
  f.normal = n;
  f.normal_by_gap = -springs.normal;
  const double trial = springs.initial_shear - springs.shear * slip_change;
  const auto bound = strength.shear_bound(n);
  if (std::abs(trial) <= bound.value) {
    f.status = ContactStatus::sticking;
    f.shear = trial;
    f.shear_by_slip = -springs.shear;
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
  f.normal_by_gap = -springs.normal;
  if (status == ContactStatus::sticking) {
    f.shear_by_slip = -springs.shear;
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
