#include "rocking.h"

namespace openclose::verification {

analytical::BlockOnPlane tall_block() {
  analytical::BlockOnPlane data;
  data.width = rocking.width;
  data.height = rocking.height;
  data.slope_angle = 0.0;
  data.friction_angle = 60.0 * analytical::degree;
  return data;
}

Scene leaning(const std::string& method, double angle, double dt, double closure) {
  Scene scene = block_on_plane(tall_block());
  scene.blocks[1].vertices = placed(scene.blocks[1].vertices, angle, {0.0, -closure});
  scene.method.contact = method;
  scene.step.dt = dt;
  use_joint_springs_as_penalty(scene);
  return scene;
}

double overturned(const Report& report, const BaseMotionInput& base, double over, double dt) {
  Scene scene = leaning("hard", 0.0, dt);
  scene.method.start = Start::settled;
  scene.base_motion = base;
  Simulation simulation = report.simulate(scene);
  if (!prepare_start(simulation).converged) return not_measured();
  const double critical = rocking.critical_angle();
  // [s] A block that stops a millionth of the critical angle beside it takes 5 s to go the rest of the way, exp(p t) = 1e6.
  constexpr double longest_wait = 10.0;
  for (int i = 1; i * dt < over + longest_wait; ++i) {
    if (!simulation.advance(dt)) return not_measured();
    const double angle = simulation.system().displacement(1)[2], turning = simulation.velocity(1)[2];
    if (angle > 1.2 * critical) return 1.0;
    if (i * dt > over && turning <= 0.0) return 0.0;
  }
  return not_measured();
}

}  // namespace openclose::verification
