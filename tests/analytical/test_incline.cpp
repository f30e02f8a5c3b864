#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <cmath>
#include <stdexcept>

#include "blocks.h"
#include "openclose/analytical/incline.h"
#include "openclose/analytical/static_hold.h"
#include "support/catch.h"

using namespace openclose::analytical;

namespace {

struct TiltProblem {
  BlockOnPlane block;
  int direction;
};

// Moment about the centroid from the two corner forces, written out corner by corner.
double moment_of_corners(double tilt, void* data) {
  const auto& [block, direction] = *static_cast<const TiltProblem*>(data);
  const double c = std::cos(tilt);
  const double s = std::sin(tilt);
  const double y = -block.normal_weight() / (2 * block.normal_stiffness) - block.height / 2 * (1 - c);
  double moment = 0;
  for (const double rx : {block.width / 2, -block.width / 2}) {
    const double ry = -block.height / 2;
    const double normal = -block.normal_stiffness * (y + rx * s + ry * (c - 1));
    const double tangential = -direction * block.friction() * normal;
    moment += (rx * c - ry * s) * normal - (rx * s + ry * c) * tangential;
  }
  return moment;
}

double tilt_by_bisection(TiltProblem problem) {
  gsl_function function{moment_of_corners, &problem};
  gsl_root_fsolver* solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  gsl_root_fsolver_set(solver, &function, -0.1, 0.1);
  for (int i = 0; i < 200; ++i) {
    gsl_root_fsolver_iterate(solver);
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver), gsl_root_fsolver_x_upper(solver), 1e-17, 1e-14) == GSL_SUCCESS) break;
  }
  const double root = gsl_root_fsolver_root(solver);
  gsl_root_fsolver_free(solver);
  return root;
}

}  // namespace

TEST_CASE("incline: accelerations of case B1") {
  const double printed[][2] = {{5, 4.16172}, {10, 3.40698}, {15, 2.62858}, {20, 1.81281}, {25, 0.943386}};
  for (const auto& [phi, a] : printed) CHECK(std::abs(sliding_acceleration(block_with_friction(phi)) - a) < 1e-5 * (a < 1 ? 0.1 : 1));
}

TEST_CASE("incline: limits of the rigid solution") {
  CHECK(std::abs(sliding_acceleration(block_with_friction(0)) - 9.81 / 2) < 1e-14);
  CHECK(sliding_acceleration(block_with_friction(31)) == 0.0);
  CHECK(sliding_displacement(block_with_friction(31), 2.0) == 0.0);
  CHECK(sliding_invariant(block_with_friction(31), 2.0) < -0.1);
  BlockOnPlane block = block_with_friction(20);
  CHECK(std::abs(sliding_displacement(block, 3.0) - 4.5 * sliding_acceleration(block)) < 1e-14 * 9);
  CHECK(sliding_displacement(block, 3.0) == sliding_invariant(block, 3.0));
  // g sin(alpha - phi)/cos(phi), another way to write it
  block.slope_angle = 1.1;
  block.friction_angle = 0.7;
  CHECK(std::abs(sliding_acceleration(block) - 9.81 * std::sin(0.4) / std::cos(0.7)) < 1e-14);
}

TEST_CASE("incline: the relaxed start hands over from sticking to sliding without a jump in position, velocity or force") {
  for (const double phi : {1.0, 10.0, 20.0, 25.0, 29.9}) {
    const BlockOnPlane block = block_with_friction(phi);
    const RelaxedStart start = relaxed_start(block);
    const double w = std::sqrt(2 * block.shear_stiffness / block.mass());
    const double hang = block.gravity * std::sin(block.slope_angle) / (w * w);
    CHECK(std::abs(start.stick_distance - hang * (1 - std::cos(w * start.stick_time))) < 1e-14 * hang);
    CHECK(std::abs(start.slip_velocity - hang * w * std::sin(w * start.stick_time)) < 1e-13 * hang * w);
    CHECK(std::abs(2 * block.shear_stiffness * start.stick_distance / (block.friction() * block.normal_weight()) - 1) < 1e-13);
    const double t = start.stick_time;
    CHECK(std::abs(relaxed_start_displacement(block, t * (1 - 1e-12)) - relaxed_start_displacement(block, t)) < 1e-11 * hang);
    // energy at the hand-over: what the weight gave is in the spring and in motion
    const double energy =
        block.mass() * start.slip_velocity * start.slip_velocity / 2 + block.shear_stiffness * start.stick_distance * start.stick_distance;
    CHECK(std::abs(energy / (block.weight() * std::sin(block.slope_angle) * start.stick_distance) - 1) < 1e-12);
  }
}

TEST_CASE("incline: the lead of the relaxed start is linear in t and in sqrt(rho/ks)") {
  const BlockOnPlane block = block_with_friction(20);
  const double rate = relaxed_start(block).slip_velocity - sliding_acceleration(block) * relaxed_start(block).stick_time;
  CHECK(std::abs(relaxed_start_lead(block, 3.0) - relaxed_start_lead(block, 1.0) - 2 * rate) < 1e-15);
  // one-unknown estimate: a few per cent below the 3.95 % of the block that may rotate
  const double lead = relaxed_start_lead(block, 0.5) / sliding_displacement(block, 0.5);
  CHECK(lead > 0.96 * 0.0395);
  CHECK(lead < 0.98 * 0.0396);
  BlockOnPlane heavy = block;
  heavy.density *= 4;
  const double heavy_rate = relaxed_start(heavy).slip_velocity - sliding_acceleration(heavy) * relaxed_start(heavy).stick_time;
  CHECK(std::abs(heavy_rate / rate - 2) < 1e-12);
  CHECK_THROWS_AS(relaxed_start(block_with_friction(30)), std::domain_error);
}

TEST_CASE("incline: steady pose against a bracketing root of the moment") {
  for (const double phi : {5.0, 25.0, 40.0}) {
    for (const int direction : {1, -1}) {
      BlockOnPlane block = block_with_friction(phi);
      block.normal_stiffness = 7e6;
      block.width = 1.5;
      const SteadyPose pose = steady_pose(block, direction);
      const double root = tilt_by_bisection({block, direction});
      CHECK(std::abs(pose.tilt / root - 1) < 1e-11);
      CHECK(direction * pose.tilt < -1e-6);
      CHECK(std::abs((pose.lower_normal + pose.upper_normal) / block.normal_weight() - 1) < 1e-15);
    }
  }
}

TEST_CASE("incline: steady pose tends to the rigid corner forces as the springs stiffen; no friction, no tilt") {
  BlockOnPlane block = block_with_friction(20);
  const CornerForces rigid = sliding_corner_forces(block);
  const double soft_error = std::abs(steady_pose(block, 1).lower_normal / rigid.lower - 1);
  block.normal_stiffness *= 10;
  const double stiff_error = std::abs(steady_pose(block, 1).lower_normal / rigid.lower - 1);
  CHECK(soft_error > 1e-6);
  CHECK(std::abs(soft_error / stiff_error - 10) < 0.01);
  CHECK(steady_pose(block, 0).tilt == 0.0);
  CHECK(std::abs(steady_pose(block, 0).drop - block.normal_weight() / (2 * block.normal_stiffness)) < 1e-18);
}

TEST_CASE("incline: a slender block has no steady pose") {
  BlockOnPlane block = block_with_friction(25);
  block.width = 0.4;  // mu h/b > 1
  CHECK_THROWS_AS(steady_pose(block, 1), std::domain_error);
}
