// What a contact carries on the average of a step in which gap and slip go straight from where they are to where the step ends. The joint law is
// integrated exactly along this path: it may close, open, stick, begin to slide, lose what the cohesion's ramp gives or what a dashpot takes away on
// the way. Without `dissipation` the work of these forces is what the springs store and what friction and dashpots take, to rounding: no energy comes
// from the time integration.
//
// On the part of the path on which the spring is closed its force, with the dashpot's constant one, is linear in time, and so is the shear bound
// between its kinks. On each linear piece the spring either sticks or from some point on slides to the end of the piece, because a line that starts
// within bounds and ends beyond one of them crosses it once. Every piece is integrated in closed form.
//
// Dissipation e adds e times the change of the spring forces over the step: 0 conserves, 1/2 would be the forces at the end, Shi's.
#pragma once

#include "openclose/law/joint_law.h"

namespace openclose {

/// Where the work of one contact went in a step [J]; minus the sum is the work of the mean forces along gap and slip.
struct PathEnergies {
  double springs = 0.0;   ///< change of what is stored
  double friction = 0.0;  ///< slip of the shear spring times its force
  double damping = 0.0;   ///< of the dashpots
  double rupture = 0.0;   ///< let go by a spring that opens under tension
  double scheme = 0.0;    ///< taken by `dissipation`
};

struct PathAverage {
  ContactForces
      mean;  ///< what enters the equation of motion, with its derivatives by gap and slip at the end of the step; its status is that of the end
  CarriedForces end;  ///< at the end of the path
  PathEnergies energies;
};

/// \param dissipation [-] e, at least 0
/// The springs' dashpots count as c/dt, dt being the duration of the whole path.
PathAverage path_average(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change, double dissipation);

/// The same without the short ways for contacts that are open or stick all the while, number for number.
PathAverage path_average_by_pieces(const ContactSprings& springs, const ContactStrength& strength, double gap_change, double slip_change,
                                   double dissipation);

}  // namespace openclose
