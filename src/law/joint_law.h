// What a joint can carry (strength) and how its springs get there (spring-slider). The springs' stiffness and rest position are chosen by the
// enforcement: real joint stiffness for `soft`, a penalty for `shi`, a penalty shifted by a multiplier for `hard`.
#pragma once

#include "openclose/contact/contact.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// Strength of one contact: Mohr-Coulomb with tension cut-off, per metre of thickness.
struct ContactStrength {
  double friction = 0.0;  ///< [-] tan(friction angle)
  double cohesion = 0.0;  ///< [N] cohesion times tributary length, 0 once lost
  double tension = 0.0;   ///< [N] tensile strength times tributary length, 0 once lost

  ContactStrength(const JointProperties& joint, const Contact& contact);

  struct ShearBound {
    double value;  ///< [N]
    double slope;  ///< [-] derivative by the normal force
  };
  /// Largest shear force at normal force n >= -tension. The cohesion comes in over a ramp, min(mu n + C, (mu + 1/eps)(n + tension)) with
  /// eps = tolerance::cohesion_ramp, because a jump from C to 0 at opening leaves steps without any solution.
  ShearBound shear_bound(double n) const;
};

/// Springs of one contact during one step. The normal force is shift - stiffness (gap - target), the shear force starts from initial_shear.
struct ContactSprings {
  double normal = 0.0;         ///< [N/m]
  double shear = 0.0;          ///< [N/m]
  double gap = 0.0;            ///< [m] start of the step
  double target = 0.0;         ///< [m]
  double shift = 0.0;          ///< [N]
  double initial_shear = 0.0;  ///< [N]
};

struct ContactForces {
  ContactStatus status = ContactStatus::open;
  double normal = 0.0;                                                  ///< [N] N
  double shear = 0.0;                                                   ///< [N] T
  double normal_by_gap = 0.0, shear_by_gap = 0.0, shear_by_slip = 0.0;  ///< [N/m] dN/dg, dT/dg, dT/ds
};

/// Forces when gap and slip have changed by these amounts [m] since the start of the step.
ContactForces spring_slider(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change);

/// Derivatives the springs would have in a given status; used before the first iteration, which starts from the states of the last step.
ContactForces tangent_for_status(const ContactSprings& springs, const ContactStrength& strength, ContactStatus status, double normal, double shear);

/// Whether cohesion and tensile strength survive a step that ended in this status.
bool stays_bonded(const JointProperties& joint, bool bonded, ContactStatus status);

}  // namespace openclose
