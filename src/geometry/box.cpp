#include "openclose/geometry/box.h"

#include <limits>

namespace openclose {

Box Box::around(const std::vector<Vec2>& points) {
  Box box{Vec2::Constant(std::numeric_limits<double>::infinity()), Vec2::Constant(-std::numeric_limits<double>::infinity())};
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
