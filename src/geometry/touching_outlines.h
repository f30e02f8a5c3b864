// Whether two outlines with many vertices only touch, in time that is nearly proportional to their vertices.
#pragma once

#include "openclose/geometry/polygon.h"

namespace openclose {

/// Whether two simple polygons, counter-clockwise, are seen to overlap by no more than `depth` [m]; false: they may.
///
/// Of every edge each piece lies along one edge of the other polygon, no farther than that, or outside the other; so no boundary lies deeper than
/// that. What is left are polygons that coincide, so that no boundary is inside the other: beside no corner, twice that deep or a quarter of an edge
/// along the bisector of its angle, is a point inside both.
bool only_touch(const Polygon& a, const Polygon& b, double depth);

}  // namespace openclose
