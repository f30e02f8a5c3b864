// Smooth: a block that bounces on its two closed corner springs after a push, against sin(w t).
#include <cmath>

#include "openclose/analytical/two_spring_block.h"
#include "studies.h"

namespace openclose::verification {
namespace {

void spring_vibration(Studies& studies) {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  const double w = analytical::bounce_frequency(data), end = 2.0 / w;
  constexpr double amplitude = 1.5e-4;  // [m] a third of the static closure: the contacts stay closed
  for (const Scheme& scheme : spring_schemes()) {
    // Rounding of gaps of 5e-4 m in coordinates of metres, 1e-15 m over the amplitude, times the steps.
    const Expectation expected{scheme.order - 0.1, scheme.order + 0.1, 0.1 / w, 1e-8, scheme.why};
    studies.in_time(scheme.name(), halved(end / 10.0, 7), expected, [&](double dt) {
      Scene scene = block_on_plane(data);
      use(scheme, scene);
      const Eigen::Vector3d moved = push_and_follow(studies, scene, 1, {0.0, amplitude * w, 0.0}, dt, end);
      return std::abs(moved[1] / amplitude - std::sin(w * end));
    });
  }
}

const Registered<Study> registered{{"spring", "vertical vibration on contact springs (D1)", &spring_vibration}};

}  // namespace
}  // namespace openclose::verification
