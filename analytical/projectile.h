// A point thrown in a uniform field: x = vx t, y = vy t - g t^2/2. Any time, either sign; no air. Elementary mechanics (case A1).
#pragma once

#include <array>
#include <numbers>

namespace openclose::analytical {

struct Projectile {
  double speed = 20.0;                      // [m/s]
  double elevation = std::numbers::pi / 3;  // [rad] above the horizontal
  double gravity = 9.81;                    // [m/s2] downwards
};

/// (x, y) [m] at time [s], from the point of release.
std::array<double, 2> projectile_position(const Projectile& projectile, double time);
/// (x', y') [m/s] at time [s].
std::array<double, 2> projectile_velocity(const Projectile& projectile, double time);

}  // namespace openclose::analytical
