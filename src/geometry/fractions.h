// Places on a segment, as fractions of it from its beginning on, which may be below 0 or above 1.
#pragma once

#include <optional>

#include "openclose/geometry/polygon.h"
#include "openclose/geometry/segment.h"

namespace openclose {

/// The edge from vertex i of a polygon to the next one.
inline Segment edge_of(const Polygon& polygon, std::size_t i) {
  return {polygon[i], polygon[i + 1 < polygon.size() ? i + 1 : 0]};
}

/// Of the foot of the perpendicular from the point.
inline double foot(const Segment& segment, const Vec2& point) {
  const Vec2 along = segment.to - segment.from;
  return (point - segment.from).dot(along) / along.squaredNorm();
}

/// Where it crosses the line of another segment; none for parallel ones.
inline std::optional<double> crossing(const Segment& segment, const Segment& other) {
  const Vec2 across = other.to - other.from;
  const double sine = cross(segment.to - segment.from, across);
  if (sine == 0.0) return std::nullopt;
  return cross(other.from - segment.from, across) / sine;
}

}  // namespace openclose
