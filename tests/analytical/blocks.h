// The block on a plane at other angles than its own.
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

inline BlockOnPlane block_with_friction(double friction_deg) {
  BlockOnPlane block;
  block.friction_angle = friction_deg * degree;
  return block;
}

inline BlockOnPlane block_on(double slope_deg, double friction_deg) {
  BlockOnPlane block = block_with_friction(friction_deg);
  block.slope_angle = slope_deg * degree;
  return block;
}

}  // namespace openclose::analytical
