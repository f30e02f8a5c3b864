#include "openclose/analytical/incline.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace openclose::analytical {
namespace {

double driving_acceleration(const BlockOnPlane& block) {
  return block.gravity * (std::sin(block.slope_angle) - block.friction() * std::cos(block.slope_angle));
}

double shear_frequency(const BlockOnPlane& block) {
  return std::sqrt(2 * block.shear_stiffness / block.mass());
}

// Newton's method from the untilted position; the residual is the moment about the centroid divided by cos(tilt).
double steady_tilt(const BlockOnPlane& block, double s) {
  const double load = block.height * block.normal_weight() / 2;
  const double stiffness = block.normal_stiffness * block.width * block.width / 2;
  double tilt = 0;
  for (int i = 0; i < 50; ++i) {
    const double t = std::tan(tilt);
    const double sine = std::sin(tilt);
    const double residual = load * (t - s) - stiffness * sine * (1 + s * t);
    const double slope = load * (1 + t * t) - stiffness * (std::cos(tilt) * (1 + s * t) + sine * s * (1 + t * t));
    const double step = residual / slope;
    tilt -= step;
    if (std::abs(step) <= 1e-15 * std::abs(tilt)) return tilt;
  }
  throw std::domain_error("no steady sliding pose: the block topples");
}

}  // namespace

double sliding_acceleration(const BlockOnPlane& block) {
  return std::max(0.0, driving_acceleration(block));
}

double sliding_displacement(const BlockOnPlane& block, double time) {
  return sliding_acceleration(block) * time * time / 2;
}

double sliding_invariant(const BlockOnPlane& block, double time) {
  return driving_acceleration(block) * time * time / 2;
}

RelaxedStart relaxed_start(const BlockOnPlane& block) {
  if (block.friction_angle >= block.slope_angle) throw std::domain_error("the block only slides if the friction angle is below the slope angle");
  const double w = shear_frequency(block);
  const double hang = block.gravity * std::sin(block.slope_angle) / (w * w);
  const double drop_of_cosine = block.friction() / std::tan(block.slope_angle);
  // 2 asin(sqrt(c/2)) = acos(1 - c) without the cancellation at small friction.
  const double phase = 2 * std::asin(std::sqrt(drop_of_cosine / 2));
  return {phase / w, hang * drop_of_cosine, hang * w * std::sin(phase)};
}

double relaxed_start_lead(const BlockOnPlane& block, double time) {
  const RelaxedStart start = relaxed_start(block);
  const double a = sliding_acceleration(block);
  const double t = start.stick_time;
  return (start.stick_distance - a * t * t / 2) + (start.slip_velocity - a * t) * (time - t);
}

double relaxed_start_displacement(const BlockOnPlane& block, double time) {
  if (time >= relaxed_start(block).stick_time) return sliding_displacement(block, time) + relaxed_start_lead(block, time);
  const double w = shear_frequency(block);
  const double half_sine = std::sin(w * time / 2);
  return 2 * block.gravity * std::sin(block.slope_angle) / (w * w) * half_sine * half_sine;
}

SteadyPose steady_pose(const BlockOnPlane& block, int direction) {
  const double tilt = steady_tilt(block, direction * block.friction());
  const double half_sine = std::sin(tilt / 2);
  const double mean_normal = block.normal_weight() / 2;
  // A negative tilt presses the lower corner in.
  const double difference = block.normal_stiffness * block.width * std::sin(tilt) / 2;
  const SteadyPose pose{tilt, mean_normal / block.normal_stiffness + block.height * half_sine * half_sine, mean_normal - difference,
                        mean_normal + difference};
  if (!(pose.lower_normal > 0 && pose.upper_normal > 0)) throw std::domain_error("no steady sliding pose: a corner lifts and the block topples");
  return pose;
}

}  // namespace openclose::analytical
