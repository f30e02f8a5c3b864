// A straight piece between two points.
#pragma once

#include "openclose/core/vector.h"
#include "openclose/geometry/box.h"

namespace openclose {

struct Segment {
  Vec2 from = Vec2::Zero();  ///< [m]
  Vec2 to = Vec2::Zero();    ///< [m]

  Box box() const { return Box::around(from, to); }
  double length() const { return (to - from).norm(); }
  Vec2 at(double fraction) const { return from + fraction * (to - from); }
};

}  // namespace openclose
