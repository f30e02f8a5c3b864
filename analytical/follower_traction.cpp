#include "openclose/analytical/follower_traction.h"

#include <cmath>

namespace openclose::analytical {

double turned_angle(const FollowerTraction& pushed, double time) {
  return pushed.moment * time * time / (2.0 * pushed.moment_of_inertia);
}

std::array<double, 2> pushed_displacement(const FollowerTraction& pushed, double time) {
  constexpr int intervals = 4096;
  const double step = time / intervals;
  double x = 0.0, y = 0.0;
  for (int i = 0; i <= intervals; ++i) {
    const double s = i * step, angle = turned_angle(pushed, s), cosine = std::cos(angle), sine = std::sin(angle);
    const double weight = (i == 0 || i == intervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) * step / 3.0 * (time - s) / pushed.mass;
    x += weight * (cosine * pushed.force[0] - sine * pushed.force[1]);
    y += weight * (sine * pushed.force[0] + cosine * pushed.force[1]);
  }
  return {x, y};
}

}  // namespace openclose::analytical
