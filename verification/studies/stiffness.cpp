// From soft to hard: what the springs of contacts change against rigid contact, over 1/kn, kn = ks.
//
// At rest they close by W/(2 kn): order 1. A start with relaxed shear springs (B1, b) hangs on them for a time like 1/w and is ahead of eq. (8) by a
// velocity like 1/w from then on: order 1/2. `hard` has neither, whatever the stiffness of the joint.
#include <cmath>

#include "openclose/analytical/incline.h"
#include "studies.h"

namespace openclose::verification {
namespace {

analytical::BlockOnPlane block_with(double softness, double slope_angle) {
  analytical::BlockOnPlane data;
  data.slope_angle = slope_angle;
  data.normal_stiffness = data.shear_stiffness = 1.0 / softness;
  return data;
}

void closure(Studies& studies, const Scheme& scheme) {
  const Expectation expected{0.99, 1.01, 1e-7, 1e-12, "closure at rest W/(2 kn): order 1"};
  studies.measure(
      scheme.name() + ", closure at rest", "1/kn [m/N]", halved(1e-7, 6, 4.0), expected,
      [&](double softness) {
        const analytical::BlockOnPlane data = block_with(softness, 0.0);
        Scene scene = block_on_plane(data);
        use(scheme, scene);
        Simulation simulation = studies.simulate(scene);
        if (!settle(simulation).settled) return not_measured();
        return -simulation.system().displacement(1)[1];
      },
      [](double) { return not_measured(); });
}

void lead(Studies& studies, const Scheme& scheme) {
  constexpr double end = 1.0;  // [s]
  const auto step = [](double softness) {
    const analytical::BlockOnPlane data = block_with(softness, 0.0);
    // Resolves the swing on the shear springs until they slip.
    const double w = std::sqrt(2.0 * data.shear_stiffness / data.mass());
    return end / std::ceil(end / (0.05 / w));
  };
  const Expectation expected{0.4, 0.6, 1e-7, 1e-12, "lead over eq. (8) like a velocity of 1/w: order 1/2"};
  studies.measure(
      scheme.name() + ", lead over eq. (8)", "1/kn [m/N]", halved(1e-7, 5, 4.0), expected,
      [&](double softness) {
        const analytical::BlockOnPlane data = block_with(softness, 30.0 * analytical::degree);
        Scene scene = block_on_plane(data);
        use(scheme, scene);
        scene.method.start = Start::normal_balanced;
        scene.step.dt = step(softness);
        Simulation simulation = studies.simulate(scene);
        prepare_start(simulation);
        const Vec2 from = simulation.system().centroid(1);
        if (!follow(simulation, scene.step.dt, end)) return not_measured();
        return std::abs(downhill(data, simulation.system().centroid(1) - from) - analytical::sliding_displacement(data, end));
      },
      step);
}

void stiffness(Studies& studies) {
  for (const Scheme& scheme : spring_schemes()) {
    closure(studies, scheme);
    lead(studies, scheme);
  }
}

const Registered<Study> registered{{"stiffness", "from soft to hard: what contact springs change", &stiffness}};

}  // namespace
}  // namespace openclose::verification
