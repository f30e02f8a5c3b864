// Slip to stick: a block that slides steadily on a level plane, rotation locked, comes to a stop (B4). Everything before is integrated exactly, so
// that one event is all there is to see; every step size is t/(n + f), so that the stop falls on the same fraction f of its step.
//
// Springs: friction is continuous at the stop; the scheme's order shows in the swing after it. Rigid contacts: friction jumps from mu N to zero, and
// the step of the stop is off by what the block would travel in it, r dt^2 times a function of f: order 2 for a given f, between 0 and r dt^2 for
// others.
#include <cmath>

#include "openclose/analytical/stopping_distance.h"
#include "studies.h"

namespace openclose::verification {
namespace {

void stopping_block(Studies& studies) {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = std::atan(0.5);
  constexpr double speed = 5.0;  // [m/s]
  const analytical::Stop stop = analytical::stopping(data, speed, 1);
  const analytical::Rebound swing = analytical::rebound_after_stop(data, speed);
  const double after = 2.0 / swing.frequency;
  for (const Scheme& scheme : schemes()) {
    const bool rigid = scheme.contact == "hard";
    const double exact = rigid ? stop.distance : swing.centre + swing.amplitude * std::cos(swing.frequency * after);
    const double order = rigid ? 2.0 : scheme.order;
    const std::string why =
        rigid ? "place off by a fixed fraction of r dt^2" : scheme.why + ", kept at the stop because friction is continuous there";
    for (const double fraction : {0.25, 0.5}) {
      std::vector<double> steps;
      for (const double n : {500.0, 1000.0, 2000.0, 4000.0, 8000.0, 16000.0}) steps.push_back(stop.time / (n + fraction));
      // Rounding of a way of 2.5 m in as many steps.
      const Expectation expected{order - 0.2, order + 0.2, 0.1 / swing.frequency, 1e-12, why};
      studies.in_time(scheme.name() + text(", f = {}", fraction), steps, expected, [&](double dt) {
        Scene scene = block_on_plane(data);
        use(scheme, scene);
        scene.method.start = Start::steady_sliding;
        scene.blocks[1].rotation_locked = true;
        scene.blocks[1].velocity = {speed, 0.0};
        scene.step.dt = dt;
        Simulation simulation = studies.simulate(scene);
        prepare_start(simulation);
        const Vec2 from = simulation.system().centroid(1);
        if (!follow(simulation, dt, stop.time + after)) return not_measured();
        return std::abs((simulation.system().centroid(1) - from).x() - exact);
      });
    }
  }
}

const Registered<Study> registered{{"stop", "initial velocity to a stop (B4)", &stopping_block}};

}  // namespace
}  // namespace openclose::verification
