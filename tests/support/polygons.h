// Polygons from which tests and verification cases make blocks.
#pragma once

#include <cmath>
#include <vector>

#include "openclose/core/vector.h"

namespace openclose::builders {

/// By its opposite corners [m].
inline std::vector<Vec2> rectangle_between(const Vec2& low, const Vec2& high) {
  return {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
}

/// By its lower left corner and its size [m].
inline std::vector<Vec2> rectangle(double x, double y, double width, double height) {
  return rectangle_between({x, y}, {x + width, y + height});
}

/// The vector turned by `angle` [rad] counter-clockwise.
inline Vec2 turned(const Vec2& v, double angle) {
  return {std::cos(angle) * v.x() - std::sin(angle) * v.y(), std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

/// The polygon turned by `angle` [rad] about the origin, then shifted.
inline std::vector<Vec2> placed(std::vector<Vec2> polygon, double angle, const Vec2& shift = Vec2::Zero()) {
  for (Vec2& v : polygon) v = turned(v, angle) + shift;
  return polygon;
}

/// Unit vectors of a plane that falls to the right by `slope` [rad]: down it, and away from it.
inline Vec2 downhill(double slope) {
  return {std::cos(slope), -std::sin(slope)};
}
inline Vec2 off_slope(double slope) {
  return {std::sin(slope), std::cos(slope)};
}

/// The point [m] so far down that plane from the origin, and so far above it.
inline Vec2 on_slope(double slope, double along, double above) {
  return along * downhill(slope) + above * off_slope(slope);
}

}  // namespace openclose::builders
