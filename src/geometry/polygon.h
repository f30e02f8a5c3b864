// Plane polygons: their mass properties, their faults, and where a point lies with respect to them.
//
// A polygon is its vertices [m] in order, the first one not repeated at the end; edge i runs from vertex i to vertex i + 1 (cyclic). It may be
// convex or not. Every function works with differences of coordinates, so that nothing is lost 1e6 m away from the origin but what the
// coordinates themselves have lost.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "openclose/core/vector.h"

namespace openclose {

using Polygon = std::vector<Vec2>;

struct PolygonProperties {
  double area = 0.0;                 ///< [m2]
  Vec2 centroid = Vec2::Zero();      ///< [m]
  double polar_second_moment = 0.0;  ///< [m4] integral of r^2 dA about the centroid
};

/// Area, centroid and polar second moment of a simple polygon of non-zero area, by Green's theorem: with c_i = a_i x b_i over the edges from a_i
/// to b_i, A = sum c_i / 2, A g = sum c_i (a_i + b_i) / 6, J = sum c_i (a_i.a_i + a_i.b_i + b_i.b_i) / 12 (C. Steger, On the calculation of
/// arbitrary moments of polygons, TU Munich 1996). A and g are taken about the first vertex, J about the centroid, so that no parallel-axis term
/// is subtracted. A and J are negative for a clockwise polygon.
PolygonProperties polygon_properties(const Polygon& polygon);

/// [m2] Positive when counter-clockwise.
double signed_area(const Polygon& polygon);

/// [m]
double longest_edge(const Polygon& polygon);

/// The same polygon run through the other way, beginning with the same vertex.
Polygon reversed(const Polygon& polygon);

/// Indices, in order, of the vertices that are corners. Dropped are vertices closer than tolerance::shortest_edge_m to the one before (and a last
/// one that repeats the first), and then vertices where the boundary turns by less than tolerance::straight_corner_rad. What is left may be fewer
/// than three. Applied to its own result it drops nothing.
std::vector<int> corners(const Polygon& polygon);

/// The convex hull of points, counter-clockwise from the leftmost one (the lowest of these). Points on its edges, to rounding, are left out. Sorted
/// by x, then one chain below and one above (A. M. Andrew, Information Processing Letters 9, 1979, 216-219).
Polygon convex_hull(std::vector<Vec2> points);

/// Whether two segments cross, overlap, touch or come closer than tolerance::shortest_edge_m.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q);

/// The first two edges (lower index first) that meet where they should not: edges without a common vertex that cross, overlap, touch or come
/// closer than tolerance::shortest_edge_m, or neighbours of which one is folded back on the other. None: the polygon is simple.
/// Expects a polygon without repeated vertices (see corners).
std::optional<std::pair<int, int>> first_self_intersection(const Polygon& polygon);

/// Whether the point is inside, by the parity of crossings. On the boundary, to rounding, either answer may come.
bool contains(const Polygon& polygon, const Vec2& point);

/// [m] From a point to the segment a-b.
double distance_to_segment(const Vec2& point, const Vec2& a, const Vec2& b);

/// [m] From a point, inside or outside, to the nearest edge.
double distance_to_boundary(const Polygon& polygon, const Vec2& point);

}  // namespace openclose
