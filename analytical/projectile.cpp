#include "openclose/analytical/projectile.h"

#include <cmath>

namespace openclose::analytical {

std::array<double, 2> projectile_velocity(const Projectile& p, double time) {
  return {p.speed * std::cos(p.elevation), p.speed * std::sin(p.elevation) - p.gravity * time};
}

std::array<double, 2> projectile_position(const Projectile& p, double time) {
  const auto start = projectile_velocity(p, 0.0);
  return {start[0] * time, start[1] * time - p.gravity * time * time / 2};
}

}  // namespace openclose::analytical
