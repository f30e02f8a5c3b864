// Smooth and not linear: a block tilted about its left corner falls back like a pendulum on the springs of that corner, which sticks; it is looked at
// before the other corner strikes. Reference: the ODE of sliding_block_reference.h.
#include <cmath>

#include "openclose/analytical/sliding_block_reference.h"
#include "studies.h"

namespace openclose::verification {
namespace {

constexpr double tilt = 0.003;    // [rad] falls for 0.032 s
constexpr double end = 0.02;      // [s]
constexpr double closure = 4e-4;  // [m] of the springs: about what they carry while the block falls

analytical::BlockOnPlane tilted_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = 80.0 * analytical::degree;
  return data;
}

void rocking(Studies& studies) {
  const analytical::BlockOnPlane data = tilted_block();
  const Vec2 arm = turned({0.5 * data.width, 0.5 * data.height}, tilt);  // from the left corner to the centroid
  analytical::SlidingBlockState start;
  start.y = arm.y() - closure - 0.5 * data.height;
  start.x = arm.x() - 0.5 * data.width;
  start.rotation = tilt;
  analytical::SlidingBlockReference reference(data, start);
  const analytical::SlidingBlockState exact = reference.advance(end);
  const double smooth_motion_only = reference.events().empty() ? 0.0 : not_measured();
  const double w = std::sqrt(4.0 * data.normal_stiffness / data.mass());  // of the corner: about a quarter of the mass moves with it

  for (const Scheme& scheme : spring_schemes()) {
    // The tributary length is the overlap on the bisector of the faces, tilt^2/8 less than that of the reference, and so the closures: fitted are
    // errors ten times as large.
    const Expectation expected{scheme.order - 0.15, scheme.order + 0.15, 0.1 / w, 10.0 * 2.0 * tilt * tilt / 8.0 * closure, scheme.why};
    studies.in_time(scheme.name(), halved(end / 20.0, 10, std::sqrt(2.0)), expected, [&](double dt) {
      Scene scene = block_on_plane(data);
      for (Vec2& v : scene.blocks[1].vertices) v = turned(v, tilt) - Vec2(0.0, closure);
      use(scheme, scene);
      scene.step.dt = dt;
      Simulation simulation = studies.simulate(scene);
      if (!follow(simulation, dt, end)) return not_measured();
      const Eigen::Vector3d moved = simulation.system().displacement(1);
      const Eigen::Vector3d error = moved - Eigen::Vector3d(exact.x - start.x, exact.y - start.y, exact.rotation - tilt);
      return error.norm() + smooth_motion_only;
    });
  }
}

const Registered<Study> registered{{"rocking", "a block that rocks about one corner, before impact", &rocking}};

}  // namespace
}  // namespace openclose::verification
