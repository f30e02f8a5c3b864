// Small vectors of the plane. Lengths in metres unless a name says otherwise.
#pragma once

#include <Eigen/Core>

namespace openclose {

using Vec2 = Eigen::Vector2d;

/// Degrees of freedom of a rigid block: the translation of its centroid [m] and its rotation [rad].
inline constexpr int dofs = 3;

/// The vector turned by +90 degrees (counter-clockwise).
inline Vec2 perpendicular(const Vec2& v) {
  return {-v.y(), v.x()};
}

/// z component of the cross product a x b.
inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace openclose
