// A mass that falls on a linear spring and bounces for ever (case D2). y [m] above the loose end of the spring, y'' = -g while y > 0,
// y'' = -g - w^2 y while y < 0, w^2 = K/m. With the impact speed v0 = sqrt(2 g H):
//   contact time  (2/w) (pi - atan(v0 w/g)),   depth  (g/w^2) (1 + sqrt(1 + (v0 w/g)^2)),   period  contact time + 2 v0/g.
// H, w, g > 0.
#pragma once

#include <array>

namespace openclose::analytical {

struct Bounce {
  double drop = 1;        // H [m]
  double frequency = 0;   // w [rad/s]
  double gravity = 9.81;  // [m/s2]

  double impact_speed() const;  // [m/s]
  double fall_time() const;     // [s] from rest at H to the first contact
  double contact_time() const;  // [s]
  double depth() const;         // [m]
  double period() const;        // [s]
  /// (y [m], y' [m/s]) at a time [s] since the release.
  std::array<double, 2> at(double time) const;
};

/// The velocity [m/s], upwards, with which the theta family (single_spring.h) leaves the spring if a step begins just as the mass touches it with
/// speed v0: while a step ends on the spring it is the amplification matrix of case D1 about the place where the spring carries the weight; the
/// spring's force counts with 1 - theta at the start and theta at the end of a step, and is zero above y = 0.
struct SteppedRebound {
  double velocity;  // [m/s] after the first step that ends above y = 0
  double height;    // [m] there
  int steps;        // since the touch
};
SteppedRebound stepped_rebound(const Bounce& bounce, double theta, double dt);

}  // namespace openclose::analytical
