#include "openclose/analytical/stopping_distance.h"

#include <cmath>
#include <stdexcept>

namespace openclose::analytical {

Stop stopping(const BlockOnPlane& block, double speed, int direction) {
  const double retardation = block.gravity * (block.friction() * std::cos(block.slope_angle) - direction * std::sin(block.slope_angle));
  if (!(retardation > 0)) throw std::domain_error("the block never stops: friction does not exceed the downhill pull");
  return {speed / retardation, speed * speed / (2 * retardation)};
}

Rebound rebound_after_stop(const BlockOnPlane& block, double speed) {
  if (block.slope_angle != 0) throw std::domain_error("the closed form of the rebound is for a level plane");
  const double shear = 2 * block.shear_stiffness;
  const double amplitude = block.friction() * block.weight() / shear;
  return {stopping(block, speed, 1).distance - amplitude, amplitude, std::sqrt(shear / block.mass())};
}

}  // namespace openclose::analytical
