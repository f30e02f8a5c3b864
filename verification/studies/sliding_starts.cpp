// Stick and slip: the block on the incline from the starts (a) unloaded and (b) with relaxed shear springs (B1), against the ODE that finds its
// events.
//
// At the change from stick to slip the force is continuous, only its derivative jumps: the order of the scheme stays, as after impacts on springs,
// and the errors scatter in the same way.
#include <cmath>

#include "openclose/analytical/sliding_block_reference.h"
#include "studies.h"

namespace openclose::verification {
namespace {

void sliding_starts(Studies& studies) {
  const analytical::BlockOnPlane data;  // phi = 20 deg on 30 deg
  for (const Start start : {Start::normal_balanced, Start::unloaded}) {
    const bool bounces = start == Start::unloaded;
    // Newmark (1/2, 1) damps the bounces of start (a) by exp(-w^2 dt t/4), the reference not at all: a tenth of a second shows the order.
    const double end = bounces ? 0.1 : 1.0;
    const auto state = bounces ? analytical::unloaded_start() : analytical::normal_balanced_start(data);
    const double exact = analytical::SlidingBlockReference(data, state).advance(end).x;
    for (const Scheme& scheme : spring_schemes()) {
      const bool second = scheme.order == 2.0;
      const double spread = second ? 0.5 : 0.2, first = second ? 5e-4 : (bounces ? 2.5e-5 : 2.5e-4);
      const Expectation expected{scheme.order - spread, scheme.order + spread, first, 1e-13,
                                 scheme.why + ", kept across stick and slip because friction is continuous there"};
      studies.in_time(scheme.name() + (bounces ? ", start (a)" : ", start (b)"), halved(first, 21, std::pow(2.0, 0.25)), expected, [&](double dt) {
        Scene scene = block_on_plane(data);
        use(scheme, scene);
        scene.method.start = start;
        scene.step.dt = dt;
        Simulation simulation = studies.simulate(scene);
        prepare_start(simulation);
        const Vec2 from = simulation.system().centroid(1);
        if (!follow(simulation, dt, end)) return not_measured();
        return std::abs(downhill(data, simulation.system().centroid(1) - from) - exact);
      });
    }
  }
}

const Registered<Study> registered{{"incline", "starts with a transient on an incline, stick and slip (B1)", &sliding_starts}};

}  // namespace
}  // namespace openclose::verification
