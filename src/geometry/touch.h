// How much of a line lies in or along a polygon.
#pragma once

#include "openclose/geometry/polygon.h"
#include "openclose/geometry/segment.h"

namespace openclose {

/// [m] Length of the segment that is inside the polygon or within tolerance::touching_m of its boundary. A corner that only touches the segment
/// gives (next to) nothing.
double common_length(const Segment& segment, const Polygon& polygon);

}  // namespace openclose
