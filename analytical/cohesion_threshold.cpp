#include "openclose/analytical/cohesion_threshold.h"

#include <algorithm>
#include <cmath>

#include "openclose/analytical/static_hold.h"

namespace openclose::analytical {
namespace {

double excess_force(const BlockOnPlane& block) {
  return block.weight() * std::sin(block.slope_angle) - block.friction() * block.normal_weight();
}

}  // namespace

double ductile_cohesion_threshold(const BlockOnPlane& block) {
  return std::max(0.0, excess_force(block) / block.width);
}

double brittle_cohesion_threshold(const BlockOnPlane& block) {
  const double upper_excess = block.weight() * std::sin(block.slope_angle) / 2 - block.friction() * holding_corner_forces(block).upper;
  return std::max(0.0, std::min(upper_excess, excess_force(block)) / (block.width / 2));
}

}  // namespace openclose::analytical
