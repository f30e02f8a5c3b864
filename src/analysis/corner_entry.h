// When, within a step, a corner enters a block through an edge that it is not held by.
//
// The contacts of a step are those of its start. A corner that passes another block's corner within the step, or comes round it, has none, and where
// contacts are rigid nothing takes back what it enters before the next step finds it; a thin block or the tip of a needle it has left again by then.
// Such a step is cut where the corner is behind the edge by half of what is tolerated: along the way of the step, on which this contact did not act,
// that moment is known without solving again.
#pragma once

#include <utility>
#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// [-] Part of a step of these displacements after which the first corner has gone through an edge by half of `tolerated` [m]; 1 if none ends farther
/// behind than closed contacts may miss their places. Corners that are behind at once do not count: cutting would not help.
/// \param pairs  of blocks that may touch
template <int N>
double first_entry(const BlockSystem<N>& system, const StepSolution<N>& solution, const std::vector<std::pair<int, int>>& pairs, double tolerated);

}  // namespace openclose
