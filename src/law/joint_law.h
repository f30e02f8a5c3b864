// The joint law: what a joint can carry (strength), when its bond breaks, and how its springs get there (spring-slider). The springs' stiffness and
// rest position are chosen by the enforcement: real joint stiffness for `soft` and `dem`, a penalty for `shi`, a penalty shifted by a multiplier for
// `hard`.
//
// Contact damping: dashpots parallel to the springs, c = 2 xi sqrt(k L m*), k the joint's own stiffness (not a penalty), L the tributary length and
// m* = m1 m2/(m1 + m2) of the two blocks. One block on one contact then has the damping ratio xi; on n equal contacts that share its stiffness
// sqrt(n) xi. Over a step the dashpots resist the change of gap and slip divided by the time; they never pull beyond the tensile strength, and
// friction is bounded by the whole normal force. Rigid contacts have no springs and impacts without rebound: damping has no meaning for `hard`.
#pragma once

#include <algorithm>
#include <cmath>

#include "openclose/contact/contact.h"
#include "openclose/contact/joint_table.h"
#include "openclose/core/tolerance.h"
#include "openclose/law/mohr_coulomb.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// [-] What a slip [m] takes of all that slip can take from a bonded joint that weakens along it, however much that has lost: linear slip weakening.
inline double weakening_by(const JointProperties& joint, double slip) {
  return slip / joint.slip_weakening_distance;
}

/// [-] How much slip has taken of what it takes from a bonded joint, 0 to 1.
inline double weakening(const JointProperties& joint, const JointState& state) {
  return joint.slip_weakening_distance > 0.0 ? std::min(1.0, weakening_by(joint, state.slip)) : 0.0;
}

/// Strength of one contact: Mohr-Coulomb with tension cut-off, per metre of thickness.
struct ContactStrength {
  double friction = 0.0;  ///< [-] tan(friction angle), what slip has left of it, the residual one once the bond is broken
  double cohesion = 0.0;  ///< [N] cohesion times what is joined of the tributary length, or bonded if it is not ductile; 0 once lost
  double tension = 0.0;   ///< [N] tensile strength times what is bonded, 0 once lost

  ContactStrength() = default;
  /// What the state of a joint leaves of its strength.
  /// \param length  [m] tributary
  ContactStrength(const TabulatedJoint& joint, double length, const JointState& state)
      : friction(state.bonded ? joint.friction : joint.residual_friction) {
    const double joined = state.joined * length, bonded = state.bonded ? std::min(joined, state.bonded_length) : 0.0;
    cohesion = joint.cohesion * (joint.cohesion_behaviour == CohesionBehaviour::ductile ? joined : bonded);
    tension = joint.tensile_strength * bonded;
    if (state.bonded && state.slip > 0.0) weaken(joint, weakening(joint, state));
  }
  /// Of a contact in its present state.
  ContactStrength(const TabulatedJoint& joint, const Contact& contact) : ContactStrength(joint, contact.length, contact.joint_state) {}

  void exchange(Archive& archive) {
    auto& [a, b, c] = *this;
    archive(a, b, c);
  }

  /// At normal force n >= -tension.
  ShearLimit<double> shear_bound(double n) const { return {friction, cohesion, tension, n, tolerance::cohesion_ramp}; }
  double largest_shear(double n) const { return shear_bound(n).value; }  ///< [N]

 private:
  void weaken(const TabulatedJoint& joint, double share) {
    friction += share * (joint.residual_friction - friction);
    if (joint.cohesion_behaviour == CohesionBehaviour::lost_on_slip) cohesion *= 1.0 - share;
  }
};

/// Springs of one contact during one step. The normal force is shift - stiffness (gap - target), the shear force starts from initial_shear.
struct ContactSprings {
  double normal = 0.0;         ///< [N/m]
  double shear = 0.0;          ///< [N/m]
  double gap = 0.0;            ///< [m] start of the step
  double target = 0.0;         ///< [m]
  double shift = 0.0;          ///< [N]
  double initial_shear = 0.0;  ///< [N]
  // Dashpots over the time in which gap and slip change.
  double normal_damping = 0.0;  ///< [N/m]
  double shear_damping = 0.0;   ///< [N/m]
  double dissipation = 0.0;     ///< [-] see path_average.h
};

struct CarriedForces {
  ContactStatus status = ContactStatus::open;
  double normal = 0.0;          ///< [N] N
  double shear = 0.0;           ///< [N] T
  double elastic_normal = 0.0;  ///< [N] part of N in the spring, the rest being the dashpot's
  double elastic_shear = 0.0;   ///< [N]
};

/// What springs and dashpots would carry if nothing bounded them [N].
struct ForceTrials {
  double elastic_normal, viscous_normal;
  double elastic_shear, viscous_shear;
};

/// Whether the normal spring carries nothing.
inline bool is_open(const ContactStrength& strength, double elastic_normal) {
  return spring_is_open(strength.tension, elastic_normal);
}

/// The joint law: what a contact carries of the trials. The elastic shear force is the contact's memory: the spring slips with the friction, the
/// dashpot does not count in it.
inline CarriedForces carry(const ContactStrength& strength, const ForceTrials& trial) {
  if (is_open(strength, trial.elastic_normal)) return {};
  const MohrCoulomb<double> carried(strength.friction, strength.cohesion, strength.tension, trial.elastic_normal + trial.viscous_normal,
                                    trial.elastic_shear + trial.viscous_shear, tolerance::cohesion_ramp);
  return {carried.is_sticking ? ContactStatus::sticking : ContactStatus::sliding, carried.normal, carried.shear, trial.elastic_normal,
          carried.limit.of(trial.elastic_shear)};
}

struct ContactForces : CarriedForces {
  double normal_by_gap = 0.0, shear_by_gap = 0.0, shear_by_slip = 0.0;  ///< [N/m] dN/dg, dT/dg, dT/ds
};

/// Springs of a joint's own stiffness over a contact's tributary length [N/m].
struct JointSprings {
  double normal, shear;
  JointSprings(const JointProperties& joint, double length) : normal(joint.normal_stiffness * length), shear(joint.shear_stiffness * length) {}
};

/// Dashpots of a contact [N s/m].
struct ContactDashpots {
  double normal = 0.0, shear = 0.0;
  ContactDashpots() = default;
  ContactDashpots(const JointProperties& joint, double length, double reduced_mass);
};

/// [N] of the normal dashpot, unbounded, when the gap has changed so much. It works as long as the spring does: -c (min(g1, g_o) - min(g0, g_o))/dt
/// for gaps g1 below the opening g_o, at which the spring pulls with the tensile strength.
inline double viscous_normal(const ContactSprings& springs, const ContactStrength& strength, double gap_change) {
  if (springs.normal_damping == 0.0) return 0.0;
  const double parted = (springs.gap - springs.target) - (springs.shift + strength.tension) / springs.normal;
  return -springs.normal_damping * (std::max(0.0, parted) + gap_change);
}

/// Forces when gap and slip have changed by these amounts [m] since the start of the step.
inline ContactForces spring_slider(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change) {
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

/// Derivatives the springs would have in a given status; used before the first iteration, which starts from the states of the last step.
ContactForces tangent_for_status(const ContactSprings& springs, const ContactStrength& strength, ContactStatus status, double normal, double shear);

/// The same with the forces: the linear piece of the law that holds in this status around these forces, prolonged to where gap and slip have changed
/// by so much. A closed contact may pull there and a sticking one carry more than its strength; an open one carries nothing.
ContactForces prolonged(const ContactSprings& springs, const ContactStrength& strength, ContactStatus status, double normal, double shear,
                        double gap_change, double slip_change);

/// Whether a joint in this state has strength that it can lose: tensile strength, cohesion that is not ductile, or friction above the residual one.
bool can_lose_strength(const JointProperties& joint, const JointState& state);

/// Whether a joint in this state loses strength along its slip, and not with the first one.
bool weakens_along_slip(const JointProperties& joint, const JointState& state);

/// The state of a joint after a step, or after a way to equilibrium.
/// \param status  at its end
/// \param slip    [m] by how much friction gave way, the shear spring's own stretch left out; counts if the contact slides
JointState state_after(const JointProperties& joint, const JointState& before, ContactStatus status, double slip);

/// [-] Share of what a joint can lose that it has lost between two states: 1 with its bond, negative if it has gained some.
double loss(const JointProperties& joint, const JointState& before, const JointState& after);

}  // namespace openclose
