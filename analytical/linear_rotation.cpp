#include "openclose/analytical/linear_rotation.h"

#include <cmath>

namespace openclose::analytical {

double linear_rotation_area_ratio(double angular_velocity, double dt, int steps) {
  const double increment = angular_velocity * dt;
  return std::exp(steps * std::log1p(increment * increment));
}

double linear_rotation_angle(double angular_velocity, double dt) {
  return std::atan(angular_velocity * dt);
}

}  // namespace openclose::analytical
