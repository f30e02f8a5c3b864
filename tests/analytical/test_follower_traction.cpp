#include <cmath>

#include "openclose/analytical/follower_traction.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("a traction through the centroid accelerates the block without turning it", "[analytical][follower_traction]") {
  const FollowerTraction pushed{2.0, 3.0, {4.0, -6.0}, 0.0};
  const auto x = pushed_displacement(pushed, 1.5);
  CHECK(turned_angle(pushed, 1.5) == 0.0);
  CHECK(x[0] == Approx(2.25).epsilon(1e-13));
  CHECK(x[1] == Approx(-3.375).epsilon(1e-13));
}

TEST_CASE("the pushed displacement satisfies the equation of motion and a series for small angles", "[analytical][follower_traction]") {
  const FollowerTraction pushed{2.0, 0.5, {3.0, 1.0}, 0.7};
  const double h = 1e-3;
  for (const double t : {0.5, 1.0, 1.8}) {
    const auto before = pushed_displacement(pushed, t - h), now = pushed_displacement(pushed, t), after = pushed_displacement(pushed, t + h);
    const double angle = turned_angle(pushed, t), c = std::cos(angle), s = std::sin(angle);
    CHECK((after[0] - 2.0 * now[0] + before[0]) / (h * h) == Approx((3.0 * c - 1.0 * s) / 2.0).margin(1e-5));
    CHECK((after[1] - 2.0 * now[1] + before[1]) / (h * h) == Approx((3.0 * s + 1.0 * c) / 2.0).margin(1e-5));
  }
  // x = F t^2/(2 m) + w/(24 m) t^4 (-Fy, Fx) + ..., w = M/I.
  const double t = 0.02, w = 0.7 / 0.5;
  const auto x = pushed_displacement(pushed, t);
  CHECK(x[0] == Approx(3.0 * t * t / 4.0 - w * std::pow(t, 4) / 48.0).epsilon(1e-8));
  CHECK(x[1] == Approx(1.0 * t * t / 4.0 + 3.0 * w * std::pow(t, 4) / 48.0).epsilon(1e-8));
}
