// Impacts: a block dropped from 1 m bounces on its two corner springs, against the flight parabola and the harmonic motion in between.
//
// The force of a contact spring begins at zero, so that only its derivative jumps at the events: a step across one has an error of the second order
// in dt in the velocity, of the same order as what the smooth steps leave. The order of the scheme stays; its constant depends on where in their
// steps the events fall, which scatters the errors from one step size to the next: what is fitted is their root mean square over drops from several
// heights.
#include <cmath>

#include "studies.h"

namespace openclose::verification {
namespace {

/// Height [m] over the unstressed springs of a mass dropped from `drop`, circular frequency w on the springs; elastic for ever.
double height(double drop, double gravity, double w, double time) {
  const double fall = std::sqrt(2.0 * drop / gravity), v0 = gravity * fall, sink = gravity / (w * w);
  const double contact = 2.0 / w * (std::acos(-1.0) - std::atan(v0 * w / gravity));
  const double since_impact = std::fmod(time + fall, 2.0 * fall + contact) - 2.0 * fall;
  if (since_impact > 0.0) return -sink + sink * std::cos(w * since_impact) - v0 / w * std::sin(w * since_impact);
  const double from_top = since_impact + fall;
  return drop - 0.5 * gravity * from_top * from_top;
}

void bounce(Studies& studies) {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  const double w = std::sqrt(2.0 * data.normal_stiffness / data.mass());
  constexpr double end = 2.5;  // [s] in flight after the third bounce
  constexpr int drops = 12;
  constexpr double lowest = 1.0, spacing = 3e-3;  // [m] some steps of flight between one and the next
  for (const Scheme& scheme : spring_schemes()) {
    const bool second = scheme.order == 2.0;
    // Newmark (1/2, 1) takes w^2 dt t_c/2 of the energy in each contact of t_c = 23 ms: 0.6 % of all in three at 1e-5 s.
    const Expectation expected{scheme.order - (second ? 0.4 : 0.2), scheme.order + (second ? 0.4 : 0.2), second ? 1e-3 : 2e-5, 1e-9,
                               scheme.why + ", kept across impacts because the force of a spring begins at zero"};
    studies.in_time(scheme.name(), second ? halved(1e-3, 6) : halved(2e-5, 3), expected, [&](double dt) {
      double squares = 0.0;
      for (int i = 0; i < drops; ++i) {
        const double drop = lowest + i * spacing;
        Scene scene = block_on_plane(data);
        for (Vec2& v : scene.blocks[1].vertices) v.y() += drop;
        use(scheme, scene);
        scene.step.dt = dt;
        Simulation simulation = studies.simulate(scene);
        if (!follow(simulation, dt, end)) return not_measured();
        squares += std::pow(drop + simulation.system().displacement(1)[1] - height(drop, data.gravity, w, end), 2);
      }
      return std::sqrt(squares / drops);
    });
  }
}

const Registered<Study> registered{{"bounce", "three bounces on contact springs (D2)", &bounce}};

}  // namespace
}  // namespace openclose::verification
