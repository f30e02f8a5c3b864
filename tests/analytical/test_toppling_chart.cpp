#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "openclose/analytical/toppling_chart.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

BlockOnPlane block_of(double slope_deg, double friction_deg, double ratio) {
  BlockOnPlane block;
  block.width = ratio;
  block.height = 1;
  block.slope_angle = slope_deg * degree;
  block.friction_angle = friction_deg * degree;
  return block;
}

/// The mode from the equations of motion alone: the contact forces that each mode asks for, and whether the plane can give them.
BlockMode mode_by_forces(const BlockOnPlane& p) {
  const double m = p.mass(), g = p.gravity, b = p.width, h = p.height, inertia = p.moment_of_inertia();
  const double sine = std::sin(p.slope_angle), cosine = std::cos(p.slope_angle), mu = p.friction();
  const auto both_press = [&](double shear) { return shear * h / 2 < m * g * cosine * b / 2; };  // moments about the centroid
  if (both_press(m * g * sine) && sine < mu * cosine) return BlockMode::stays;
  if (both_press(mu * m * g * cosine) && sine > mu * cosine) return BlockMode::slides;
  // One corner holds: x'' = q h/2, y'' = q b/2, inertia q = T h/2 - N b/2, solved for q.
  const double q = (m * g * sine * h / 2 - m * g * cosine * b / 2) / (inertia + m * (b * b + h * h) / 4);
  const double normal = m * (g * cosine + q * b / 2), shear = m * (g * sine - q * h / 2);
  if (q > 0 && std::abs(shear) < mu * normal) return BlockMode::topples;
  return BlockMode::slides_and_topples;
}

}  // namespace

TEST_CASE("toppling chart: friction angles between toppling and both") {
  CHECK(std::abs(toppling_friction_angle(block_of(30, 20, 0.4)) / degree - 23.8643) < 5e-5);
  CHECK(std::abs(toppling_friction_angle(block_of(40, 20, 0.3)) / degree - 22.8447) < 5e-5);
  CHECK(std::abs(toppling_friction_angle(block_of(30, 20, 0.2)) / degree - 16.1440) < 5e-5);
}

TEST_CASE("toppling chart: the modes are those that the forces allow") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(3, 55), ratio(0.05, 1.6);
  int seen[4] = {};
  for (int i = 0; i < 20000; ++i) {
    const BlockOnPlane block = block_of(angle(random), angle(random), ratio(random));
    const BlockMode mode = first_mode(block);
    CHECK(mode == mode_by_forces(block));
    ++seen[static_cast<int>(mode)];
  }
  for (const int count : seen) CHECK(count > 500);
}

TEST_CASE("toppling chart: accelerations meet at the boundaries") {
  for (const double slope : {20.0, 35.0, 50.0}) {
    for (const double ratio : {0.1, 0.25, 0.35}) {
      BlockOnPlane block = block_of(slope, 0, ratio);
      const double limit = toppling_friction_angle(block) / degree;
      const double above = first_rotation_acceleration(block_of(slope, limit + 1e-9, ratio));
      const double below = first_rotation_acceleration(block_of(slope, limit - 1e-9, ratio));
      CHECK(above > 0);
      CHECK(std::abs(below / above - 1) < 1e-7);
      CHECK(first_rotation_acceleration(block_of(slope, std::atan(ratio) / degree + 1e-7, ratio)) < 1e-6);
    }
  }
  CHECK(first_rotation_acceleration(block_of(20, 30, 1)) == 0);
  CHECK(first_rotation_acceleration(block_of(20, 10, 1)) == 0);
}

TEST_CASE("toppling chart: velocity after toppling grows by the acceleration") {
  const BlockOnPlane block = block_of(30, 60, 0.4);
  const double q = first_rotation_acceleration(block);
  for (const double angle : {1e-4, 1e-3}) CHECK(std::abs(std::pow(toppling_velocity(block, angle), 2) / (2 * q * angle) - 1) < 10 * angle);
}

TEST_CASE("toppling chart: tipping on springs against a root finder") {
  BlockOnPlane block;
  block.width = 0.5;
  block.height = 2;
  block.friction_angle = 60 * degree;
  for (const double kn : {12.5e6, 50e6, 200e6}) {
    block.normal_stiffness = kn;
    // Moments about the lower corner, the upper one without force: h sin(alpha + theta) = b cos(alpha + theta).
    gsl_function f;
    f.function = [](double alpha, void* data) {
      const auto& p = *static_cast<BlockOnPlane*>(data);
      const double tilt = std::asin(p.weight() * std::cos(alpha) / (p.normal_stiffness * p.width));
      return p.height * std::sin(alpha + tilt) - p.width * std::cos(alpha + tilt);
    };
    f.params = &block;
    gsl_root_fsolver* solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
    gsl_root_fsolver_set(solver, &f, 0.1, 0.4);
    for (int i = 0; i < 60; ++i) gsl_root_fsolver_iterate(solver);
    CHECK(std::abs(gsl_root_fsolver_root(solver) - elastic_tipping_angle(block)) < 1e-13);
    gsl_root_fsolver_free(solver);
    CHECK(elastic_tipping_angle(block) < tipping_angle(block));
  }
  block.normal_stiffness = block.weight() * block.height / (block.width * block.width) * 0.99;
  CHECK_THROWS_AS(elastic_tipping_angle(block), std::domain_error);
}
