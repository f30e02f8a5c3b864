// Axis-aligned boxes, the cheap test before any geometry is done.
#pragma once

#include <vector>

#include "openclose/core/vector.h"

namespace openclose {

struct Box {
  Vec2 low = Vec2::Zero();   ///< [m]
  Vec2 high = Vec2::Zero();  ///< [m]

  /// The smallest box around some points; around none an empty one, of endless negative width.
  static Box around(const std::vector<Vec2>& points);
  static Box around(const Vec2& a, const Vec2& b) { return {a.cwiseMin(b), a.cwiseMax(b)}; }

  /// Every side moved outwards by the margin [m]; a negative margin moves them inwards and may leave an empty box.
  Box inflated(double margin) const;
  /// The part the two have in common; empty if there is none.
  Box common(const Box& other) const { return {low.cwiseMax(other.low), high.cwiseMin(other.high)}; }
  bool empty() const { return (low.array() > high.array()).any(); }
  /// Boxes that touch overlap; an empty box overlaps nothing.
  bool overlaps(const Box& other) const { return !common(other).empty(); }
  /// Points on the rim are inside.
  bool contains(const Vec2& point) const { return (low.array() <= point.array()).all() && (point.array() <= high.array()).all(); }
};

}  // namespace openclose
