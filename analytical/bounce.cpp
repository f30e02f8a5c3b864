#include "openclose/analytical/bounce.h"

#include <cmath>
#include <numbers>

#include "openclose/analytical/single_spring.h"

namespace openclose::analytical {

double Bounce::impact_speed() const {
  return std::sqrt(2 * gravity * drop);
}
double Bounce::fall_time() const {
  return std::sqrt(2 * drop / gravity);
}
double Bounce::contact_time() const {
  return 2 / frequency * (std::numbers::pi - std::atan(impact_speed() * frequency / gravity));
}
double Bounce::depth() const {
  return gravity / (frequency * frequency) * (1 + std::hypot(1, impact_speed() * frequency / gravity));
}
double Bounce::period() const {
  return contact_time() + 2 * impact_speed() / gravity;
}

std::array<double, 2> Bounce::at(double time) const {
  const double v0 = impact_speed(), contact = contact_time();
  double since = time - fall_time();  // the last touch
  if (since < 0) return {drop - gravity * time * time / 2, -gravity * time};
  since = std::fmod(since, period());
  if (since < contact) {
    const double sag = gravity / (frequency * frequency), c = std::cos(frequency * since), s = std::sin(frequency * since);
    return {-sag * (1 - c) - v0 / frequency * s, -sag * frequency * s - v0 * c};
  }
  const double flight = since - contact;
  return {v0 * flight - gravity * flight * flight / 2, v0 - gravity * flight};
}

SteppedRebound stepped_rebound(const Bounce& bounce, double theta, double dt) {
  const auto a = amplification_matrix({theta, bounce.frequency, dt});
  const double sag = bounce.gravity / (bounce.frequency * bounce.frequency);
  double y = 0, v = -bounce.impact_speed();
  for (int steps = 1;; ++steps) {
    const double u = y + sag;
    const double next = a[0][0] * u + a[0][1] * v - sag;
    if (next >= 0) {
      const double acceleration = -bounce.gravity - (1 - theta) * bounce.frequency * bounce.frequency * y;
      return {v + dt * acceleration, y + dt * v + dt * dt * acceleration / 2, steps};
    }
    v = a[1][0] * u + a[1][1] * v;
    y = next;
  }
}

}  // namespace openclose::analytical
