// What a contact inherits when the contacts of its pair are found anew, so that no change of geometry creates energy.
//
// Finding contacts anew changes tributary lengths, hence stiffnesses, and hands the history of a corner from edge to edge, while the springs are
// loaded. A spring that went on to read the gap would then change its energy, and energy that comes so is motion from nothing. So every contact has a
// rest gap r, and its normal spring reads the stretch s = gap - r. Let the length change from L to L':
//   - a loaded spring keeps its energy: s' = s sqrt(L/L'), u' = u sqrt(L/L') of the shear spring. Its closure -s' is no more than there is, -gap, so
//     that r' = gap - s' does not become positive; what it loses by that is released.
//   - a spring that pulls keeps its stretch where energy would make it longer: s' = s min(1, sqrt(L/L')). Only so may r' become positive.
//   - an open one begins to carry at the gap it has, r' = min(0, gap). So the offset fades as the contact opens.
//   - one that nothing precedes is born without force, r = min(0, gap), unless it is one of the drawing.
// Each spring that is kept or inherited has at most the energy it had and each that is born has none. Where lengths change to and fro the factors
// cancel: the rule has no drift of its own.
//
// The forces are those of the last step, but those of rigid contacts keep their pressure, F' = F L'/L. Rigid contacts have no springs that would tell
// how they share what equilibrium leaves open: as a block slides over a joint of the ground, what one contact has from before and another has not
// would stay so, until one that covers ground as before carries nothing, and has no cohesion.
#pragma once

#include <algorithm>
#include <cmath>

#include "openclose/contact/contact.h"

namespace openclose {

/// What becomes of the forces of a contact whose length changes.
enum class InheritedForces : unsigned char { as_they_were, at_same_pressure };

/// [-] A contact whose length grows or shrinks by more at once has just begun or is about to end: its force says nothing of the pressure around it.
inline constexpr double most_change_of_length = 2.0;

/// [-] By which the forces of a contact change with its tributary length [m].
inline double change_at_same_pressure(double from, double to) {
  return from > 0.0 ? std::clamp(to / from, 1.0 / most_change_of_length, most_change_of_length) : 1.0;
}

/// From here on the normal spring carries nothing at the present gap, and nothing at positive ones.
inline void rest_at_present_gap(Contact& contact) {
  contact.rest_gap = std::min(0.0, contact.gap);
}

/// [m] Stretch of the normal spring of a contact whose gap has been measured anew. It follows the positions, so that what steps round or linearise
/// does not add up; but one that the last step left open has carried nothing since, wherever it is now, unless somebody else has moved the blocks.
inline double stretch_at(const Contact& before, double gap, bool moved_by_others) {
  const bool is_open = before.status == ContactStatus::open && before.stretch() >= 0.0;
  return is_open && !moved_by_others ? before.stretch() : gap - before.rest_gap;
}

/// What a contact of the present geometry has from the one that it continues, see above.
/// \param stretch  [m] of the normal spring of `from`
inline void inherit(const Contact& from, double stretch, InheritedForces forces, Contact& to) {
  to.status = from.status;
  to.joint_state = from.joint_state;
  // Faces that have slid off each other have opened: they are not bonded when they come back.
  JointState& joint = to.joint_state;
  if (joint.bonded) joint.bonded_length = std::min(joint.bonded_length, joint.joined * to.length);
  const double change = forces == InheritedForces::at_same_pressure ? change_at_same_pressure(from.length, to.length) : 1.0;
  to.normal_force = change * from.normal_force;
  to.shear_force = change * from.shear_force;
  to.stored_energy = from.stored_energy;
  to.crossing_energy = from.crossing_energy;
  to.slack = from.slack;
  const double longer = to.length > 0.0 ? std::sqrt(from.length / to.length) : 1.0;
  to.elastic_slip = longer * from.elastic_slip;
  const bool pulls = stretch > 0.0 && from.joint_state.bonded && from.status != ContactStatus::open;
  if (stretch >= 0.0 && !pulls) {
    rest_at_present_gap(to);
  } else if (pulls) {
    to.rest_gap = to.gap - stretch * std::min(1.0, longer);
  } else {
    to.rest_gap = to.gap + std::min(-longer * stretch, std::max(0.0, -to.gap));
  }
}

}  // namespace openclose
