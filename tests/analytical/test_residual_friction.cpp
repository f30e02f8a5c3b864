#include <cmath>
#include <stdexcept>

#include "openclose/analytical/residual_friction.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

BlockOnPlane strong_block() {
  BlockOnPlane block;
  block.friction_angle = 40.0 * degree;
  return block;
}

}  // namespace

TEST_CASE("residual friction: a thrown block hangs on its springs until these carry the peak strength", "[analytical][residual_friction]") {
  const BlockOnPlane block = strong_block();
  const ReleasedSlide slide = released_slide(block, 20.0 * degree, 0.5);
  // The equation of motion by central differences, from the start to slip.
  const int steps = 20000;
  const double h = slide.slip_time / steps, drive = block.gravity * std::sin(block.slope_angle);
  const double k = 2.0 * block.shear_stiffness / block.mass();
  double x = 0.0, v = 0.5 + 0.5 * h * drive;
  for (int i = 0; i < steps; ++i) {
    x += h * v;
    v += h * (drive - k * x);
  }
  CHECK(x == Approx(slide.slip_distance).epsilon(1e-6));
  CHECK(v - 0.5 * h * (drive - k * x) == Approx(slide.slip_velocity).epsilon(1e-6));
  CHECK(k * block.mass() * slide.slip_distance == Approx(block.friction() * block.normal_weight()).epsilon(1e-13));
  CHECK(slide.displacement(slide.slip_time) == slide.slip_distance);
  CHECK(slide.acceleration == Approx(9.81 * (0.5 - std::tan(20.0 * degree) * std::sqrt(0.75))).epsilon(1e-13));
  // At rest at first, the springs carry up to twice the weight's part along the plane: tan 50 degrees is more than 2 tan 30 degrees.
  BlockOnPlane held = block;
  held.friction_angle = 50.0 * degree;
  CHECK_THROWS_AS(released_slide(held, 20.0 * degree, 1e-3), std::domain_error);
}

TEST_CASE("residual friction: rigid contacts slip at once", "[analytical][residual_friction]") {
  const ReleasedSlide slide = released_rigid_slide(strong_block(), 30.0 * degree, 2.0);
  CHECK(slide.acceleration == Approx(0.0).margin(1e-14));
  CHECK(slide.displacement(3.0) == Approx(6.0).epsilon(1e-13));
}

TEST_CASE("residual friction: the factor of a block whose upper corner slips first", "[analytical][residual_friction]") {
  BlockOnPlane block;
  block.friction_angle = 45.0 * degree;
  // 2 m x 1 m on 30 degrees, in parts of the weight: T = 1/2, N = sqrt(3)/2, N_l - N_u = 1/4.
  const double normal = std::sqrt(0.75), upper = 0.5 * (normal - 0.25), lower = 0.5 * (normal + 0.25);
  CHECK(residual_strength_factor(block, 40.0 * degree) == Approx((std::tan(40.0 * degree) * upper + lower) / 0.5).epsilon(1e-13));
  CHECK(residual_strength_factor(block, 5.0 * degree) == Approx(upper / 0.25).epsilon(1e-13));
  // Nothing is lost without a difference of the angles.
  CHECK(residual_strength_factor(block, 45.0 * degree) == Approx(1.0 / std::tan(30.0 * degree)).epsilon(1e-13));
}
