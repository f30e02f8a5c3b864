// When, within a step, a corner enters a block through an edge that it is not held by.
//
// The contacts of a step are those of its start. A corner that passes another block's corner within the step, or comes round it, has none, and
// nothing takes back what it enters before the next step finds it. Rigid contacts then have a penetration that they may not have, springs begin to
// carry where they are found, behind the edge; and a thin block or the tip of a needle it has left again by then. Such a step is cut where the corner
// is behind the edge by half of what is tolerated: along the way of the step, on which this contact did not act, that moment is known without solving
// again.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// What corners may enter between two steps.
struct EntryTolerance {
  double depth = 0.0;                                     ///< [m]
  double part_of_width = 0.0;                             ///< [-] of the narrower block, if that is more
  double most = std::numeric_limits<double>::infinity();  ///< [m] and no more than this

  double of(double narrower) const { return std::min(std::max(depth, part_of_width * narrower), most); }
};

/// [-] Part of a step of these displacements after which the first corner has gone through an edge by half of what is tolerated, or into a tip of the
/// block through which it goes, so far that it is found at the edge; 1 if none ends farther behind than closed contacts may miss their places, or has
/// gone through a tip. Corners that are behind at once do not count: cutting would not help.
/// \param pairs  of blocks that may touch
/// \param held   contacts of which corners and edges do not count, because their springs have acted; none if rigid ones hold what they should
double first_entry(const BlockSystem& system, const StepSolution& solution, const std::vector<std::pair<int, int>>& pairs,
                   const EntryTolerance& tolerance, std::span<const Contact> held = {});

/// Whether two blocks are deeper in each other at the end of a step of these displacements than they may be [m], and were not at its start: as where
/// two tips cross each other's sides with no corner in the other block, or places that exclude each other have been missed.
bool pass_into_each_other(const BlockSystem& system, const StepSolution& solution, const std::vector<std::pair<int, int>>& pairs, double allowed);

}  // namespace openclose
