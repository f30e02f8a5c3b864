// How deep two polygons overlap.
#pragma once

#include "openclose/geometry/polygon.h"

namespace openclose {

/// [m] Depth of the overlap of two simple polygons, convex or not, counter-clockwise; 0 when they are apart or only touch.
///
/// It is the largest, over sample points of the intersection, of
///   - for points on the boundary of one polygon inside the other: the distance to the boundary of the other. Sampled on every edge are its ends,
///     its crossings with the other boundary, the feet of the other's vertices (of many only those near enough to matter), and the
///     midpoints between neighbouring ones of all these;
///   - for points inside both polygons: the distance to the nearer boundary. Sampled are the bisectors of the angles of either polygon (of one with
///     many corners until they leave it), midway between neighbouring crossings with the two boundaries. They catch polygons that coincide, of which
///     no boundary point is inside the other.
/// So it never exceeds the true largest depth and is never positive without an overlap. A depth below tolerance::shortest_edge_m is returned as 0:
/// shared edges, T-junctions and a block that fills a notch are contacts, not overlaps.
double overlap_depth(const Polygon& a, const Polygon& b);

/// A polygon of which it is known whether it is convex.
struct Outline {
  Polygon corners;
  bool is_convex = false;
};

Outline outline_of(const Polygon& polygon);

/// [m] The same, or 0 where it is seen at once to be no more than `depth`: a line along an edge of a convex one keeps the other one out but for that,
/// or one lies beside the other in its hollow, or many vertices only touch (touching_outlines.h).
double overlap_depth_beyond(double depth, const Outline& a, const Outline& b);

}  // namespace openclose
