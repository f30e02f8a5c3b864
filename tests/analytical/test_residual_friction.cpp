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

TEST_CASE("slip weakening: the equation of motion of a spring and a slider that weakens", "[analytical][residual_friction]") {
  const BlockOnPlane block = strong_block();
  const double residual = 20.0 * degree, distance = 5e-3, speed = 1.0;
  const ReleasedSlide first = released_slide(block, residual, speed), last = weakened_slide(block, residual, distance, first);
  // The slider by its own law: the spring's stretch u and the slip s = x - u, mu(s) N = k u.
  const double k = 2.0 * block.shear_stiffness, normal = block.normal_weight(), mu = block.friction(), mu_r = std::tan(residual);
  const double drive = block.gravity * std::sin(block.slope_angle);
  const auto friction = [&](double slip) { return normal * (mu - (mu - mu_r) * std::min(1.0, slip / distance)); };
  const int steps = 200000;
  const double h = last.slip_time / steps;
  double x = 0.0, slip = 0.0, v = speed + 0.5 * h * drive;
  for (int i = 0; i < steps; ++i) {
    x += h * v;
    // k (x - s) <= mu(s) N, with equality where it slips: linear in s while it weakens.
    const double excess = k * (x - slip) - friction(slip);
    if (excess > 0.0) slip += excess / (k - normal * (mu - mu_r) / distance);
    v += h * (drive - k * (x - slip) / block.mass());
  }
  CHECK(slip == Approx(distance).epsilon(1e-5));
  CHECK(x == Approx(last.slip_distance).epsilon(1e-5));
  CHECK(v == Approx(last.slip_velocity).epsilon(1e-5));
  CHECK(last.acceleration == first.acceleration);
}

TEST_CASE("slip weakening: no distance is residual friction at once, too short a one lets the springs go, friction stops the slow",
          "[analytical][residual_friction]") {
  const BlockOnPlane block = strong_block();
  const double residual = 20.0 * degree;
  const ReleasedSlide rigid = released_rigid_slide(block, residual, 1.0);
  CHECK(weakened_slide(block, residual, 1e-9, rigid).displacement(1.0) == Approx(rigid.displacement(1.0)).margin(1e-8));
  CHECK(weakened_slide(block, residual, 0.1, rigid).displacement(1.0) < rigid.displacement(1.0) - 0.05);
  CHECK_THROWS_AS(weakened_slide(block, residual, 1e-5, released_slide(block, residual, 1.0)), std::domain_error);
  CHECK_THROWS_AS(weakened_slide(block, residual, 0.1, released_rigid_slide(block, residual, 0.1)), std::domain_error);
}

TEST_CASE("slip weakening: what lateness costs is the response to the acceleration that is missing", "[analytical][residual_friction]") {
  const BlockOnPlane block = strong_block();
  const double residual = 20.0 * degree, distance = 0.1, delay = 1e-4, growth = 6.3534;
  const ReleasedSlide first = released_rigid_slide(block, residual, 1.0), last = weakened_slide(block, residual, distance, first);
  // e'' = beta^2 (e + delay cosh(beta t)), then e' stays.
  const double beta = std::sqrt(9.81 * std::sqrt(0.75) * (block.friction() - std::tan(residual)) / distance);
  CHECK(beta == Approx(growth).epsilon(1e-4));
  const int steps = 100000;
  const double h = last.slip_time / steps;
  double e = 0.0, rate = 0.5 * h * beta * beta * delay;
  for (int i = 1; i <= steps; ++i) {
    e += h * rate;
    rate += (i == steps ? 0.5 : 1.0) * h * beta * beta * (e + delay * std::cosh(beta * h * i));
  }
  CHECK(cost_of_late_weakening(block, residual, distance, first, delay, 1.0) == Approx(e + rate * (1.0 - last.slip_time)).epsilon(1e-6));
}

TEST_CASE("slip weakening: the factor of two corners lies between those of brittle and of ductile friction", "[analytical][residual_friction]") {
  BlockOnPlane block;
  block.friction_angle = 45.0 * degree;
  const double residual = 5.0 * degree, distance = 2e-3;
  const double brittle = residual_strength_factor(block, residual), ductile = 1.0 / std::tan(30.0 * degree);
  const double factor = weakened_strength_factor(block, residual, distance);
  // At the lower corner's first slip both carry the weight's part along the plane: the upper one by its slider, solved by repetition.
  const double normal = block.normal_weight(), shear = 0.5 * block.weight(), difference = 0.5 * shear;
  const double upper = 0.5 * (normal - difference), lower = 0.5 * (normal + difference), way = lower / factor / block.shear_stiffness;
  double slip = 0.0, carried = 0.0;
  for (int i = 0; i < 200; ++i) {
    carried = upper / factor * (1.0 - (1.0 - std::tan(residual)) * slip / distance);
    slip = way - carried / block.shear_stiffness;
  }
  CHECK(carried + lower / factor == Approx(shear).epsilon(1e-12));
  CHECK(brittle < factor);
  CHECK(factor < ductile);
  CHECK(weakened_strength_factor(block, residual, 1e3) == Approx(ductile).epsilon(1e-6));
  CHECK_THROWS_AS(weakened_strength_factor(block, residual, 1e-5), std::domain_error);
}
