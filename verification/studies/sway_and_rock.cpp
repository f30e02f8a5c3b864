// Smooth: the two coupled modes of sway and rock of a block on its two corner springs, each against sin(w t).
#include <cmath>

#include "openclose/analytical/two_spring_block.h"
#include "studies.h"

namespace openclose::verification {
namespace {

void sway_and_rock(Studies& studies) {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = 45.0 * analytical::degree;
  for (const double w : analytical::sway_rock_frequencies(data)) {
    const double end = 2.0 / w;
    // Small against the closure of 5e-4 m. The change of geometry, amplitude over height, is what the linear reference leaves out.
    constexpr double amplitude = 1e-6;  // [m] of the sway
    // (2 ks - w^2 m) x + ks h r = 0.
    const Eigen::Vector3d shape(1.0, 0.0, (w * w * data.mass() - 2.0 * data.shear_stiffness) / (data.shear_stiffness * data.height));
    for (const Scheme& scheme : spring_schemes()) {
      const Expectation expected{scheme.order - 0.1, scheme.order + 0.1, 0.1 / w, 4e-6, scheme.why};
      studies.in_time(scheme.name() + text(", w = {:.4g} rad/s", w), halved(end / 10.0, 6), expected, [&](double dt) {
        Scene scene = block_on_plane(data);
        use(scheme, scene);
        const Eigen::Vector3d moved = push_and_follow(studies, scene, 1, amplitude * w * shape, dt, end);
        return std::abs(moved[0] / amplitude - std::sin(w * end));
      });
    }
  }
}

const Registered<Study> registered{{"sway_rock", "sway and rock on contact springs (D3)", &sway_and_rock}};

}  // namespace
}  // namespace openclose::verification
