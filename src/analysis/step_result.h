// What has become of a step.
#pragma once

#include <string>

namespace openclose {

struct StepResult {
  bool accepted = false;
  std::string reason;
  double unbalanced_force = 0.0;  ///< [N] largest sum of forces without inertia on a block; explicit and static steps only, of the latter by
                                  ///< emphasis_at_rest()
  double moved = 0.0;             ///< [m] farthest way of a vertex, of refused steps too; 0 if nothing was solved
  double error = 0.0;             ///< [m] local error, see local_error(); only if the scene asks for adaptive steps
  bool too_wrong = false;         ///< refused because of it
  double part = 0.0;              ///< [-] refused: of the step, a length that is likely to be accepted; 0 if that is not known
  bool ends_at_entry = false;     ///< refused: `part` ends where a corner enters a block that it is not in contact with
  bool relisted = false;       ///< explicit: not taken, since it needed more contacts than were listed; now they are, and the critical step is known
  bool stops = false;          ///< explicit: taken, but nothing that follows can be right, for this reason
  bool lost_strength = false;  ///< a joint has lost strength for good at the end of the step; with `dem`, its bond
};

}  // namespace openclose
