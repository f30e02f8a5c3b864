// Smooth and without any contact, so that rigid contacts have an order too: a block hung in the springs of a support, along a Lissajous figure.
#include <cmath>

#include "studies.h"

namespace openclose::verification {
namespace {

void support_springs(Studies& studies) {
  constexpr double amplitude = 0.01, end = 0.2;  // [m], [s]
  const Vec2 frequency(10.0, 15.0);              // [rad/s]
  for (const Scheme& scheme : schemes()) {
    const Expectation expected{scheme.order - 0.1, scheme.order + 0.1, 0.1 / frequency.y(), 1e-11, scheme.why};
    studies.in_time(scheme.name(), halved(end / 10.0, 7), expected, [&](double dt) {
      Scene scene = empty_scene();
      scene.blocks = {free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))};
      const double mass = scene.materials[0].density * 2.0;
      scene.supports = {{0, {1.0, 0.5}, mass * frequency.cwiseAbs2()}};
      use(scheme, scene);
      const Eigen::Vector3d velocity(amplitude * frequency.x(), amplitude * frequency.y(), 0.0);
      const Eigen::Vector3d moved = push_and_follow(studies, scene, 0, velocity, dt, end);
      const Vec2 exact(std::sin(frequency.x() * end), std::sin(frequency.y() * end));
      return (moved.head<2>() / amplitude - exact).norm();
    });
  }
}

const Registered<Study> registered{{"support", "a block between support springs", &support_springs}};

}  // namespace
}  // namespace openclose::verification
