#include "openclose/geometry/box.h"

namespace openclose {

Box Box::around(const std::vector<Vec2>& points) {
  Box box{points.front(), points.front()};
  for (const Vec2& point : points) {
    box.low = box.low.cwiseMin(point);
    box.high = box.high.cwiseMax(point);
  }
  return box;
}

Box Box::inflated(double margin) const {
  return {low.array() - margin, high.array() + margin};
}

}  // namespace openclose
