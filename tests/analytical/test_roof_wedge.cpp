#include <cmath>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/roof_wedge.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// The load of a wedge that is drawn down from its squeezed planes until both slip, found by bisection of how far.
double followed(const RoofWedge& w) {
  const double kn = 1e9, ks = w.stiffness_ratio * kn, c = std::cos(w.half_angle), s = std::sin(w.half_angle);
  const auto normal = [&](double u) { return pressed_normal_force(w) - kn * u * s; };
  const auto shear = [&](double u) { return ks * u * c; };
  double sticks = 0, slips = pressed_normal_force(w) / (kn * s);
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (sticks + slips);
    (shear(middle) < normal(middle) * std::tan(w.friction_angle) ? sticks : slips) = middle;
  }
  return 2 * (shear(sticks) * c - normal(sticks) * s);
}

}  // namespace

TEST_CASE("roof wedge: published values") {
  CHECK(roof_wedge_load({30 * degree, 40 * degree, 1, 1e6}) == Approx(352653.961).epsilon(2e-9));
  CHECK(roof_wedge_load({20 * degree, 35 * degree, 0.25, 1e6}) == Approx(449866.250).epsilon(2e-9));
  CHECK_THROWS_AS(roof_wedge_load({40 * degree, 35 * degree, 1, 1e6}), std::domain_error);
}

TEST_CASE("roof wedge: followed on its springs from the pressed planes it bears the same") {
  for (const double ratio : {0.1, 1.0, 3.0}) {
    const RoofWedge wedge{25 * degree, 38 * degree, ratio, 2e5};
    CHECK(roof_wedge_load(wedge) == Approx(followed(wedge)).epsilon(1e-12));
  }
}
