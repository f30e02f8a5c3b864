// Joint traces that end in rock, led on to the next joint.
#pragma once

#include <vector>

#include "openclose/geometry/block_cutting.h"

namespace openclose {

/// Of every trace with a bridge, an end that lies inside the domain, farther than the reach from all other traces and rings, gets a trace of the
/// bridge in front of it. That runs in the direction of the trace to the next of the given traces or rings; what is led on from elsewhere does not
/// stop it, so that the result does not depend on the order.
/// \param rings  of the domain
/// \param reach  [m] see CuttingLimits::end_reach
/// \return whether any end goes on
bool continue_traces(std::vector<JointTrace>& traces, const std::vector<const Polygon*>& rings, double reach);

}  // namespace openclose
