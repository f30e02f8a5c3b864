#include "openclose/analytical/static_hold.h"

#include <cmath>

namespace openclose::analytical {
namespace {

CornerForces corner_forces(const BlockOnPlane& block, double tangential_force) {
  const double mean = block.normal_weight() / 2;
  const double difference = tangential_force * block.height / (2 * block.width);
  return {mean + difference, mean - difference};
}

}  // namespace

CornerForces holding_corner_forces(const BlockOnPlane& block) {
  return corner_forces(block, block.weight() * std::sin(block.slope_angle));
}

CornerForces sliding_corner_forces(const BlockOnPlane& block) {
  return corner_forces(block, block.friction() * block.normal_weight());
}

}  // namespace openclose::analytical
