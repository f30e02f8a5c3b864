#include "openclose/analytical/toppling_chart.h"

#include <cmath>
#include <stdexcept>

namespace openclose::analytical {
namespace {

double diagonal_squared(const BlockOnPlane& block) {
  return block.width * block.width + block.height * block.height;
}

double topple_acceleration(const BlockOnPlane& block) {
  const double lever = block.height * std::sin(block.slope_angle) - block.width * std::cos(block.slope_angle);
  return 3 * block.gravity * lever / (2 * diagonal_squared(block));
}

double slide_and_topple_acceleration(const BlockOnPlane& block) {
  const double k = 6 * (block.friction() * block.height - block.width) / (block.mass() * diagonal_squared(block));
  const double share = 1 - block.mass() * k * block.width / 2;
  if (!(share > 0)) throw std::domain_error("no normal force carries a corner that slides so");
  return k * block.normal_weight() / share;
}

}  // namespace

double toppling_friction_angle(const BlockOnPlane& block) {
  const double t = block.width / block.height, slope = std::tan(block.slope_angle);
  return std::atan(((4 * t * t + 1) * slope + 3 * t) / (4 + t * t + 3 * t * slope));
}

BlockMode first_mode(const BlockOnPlane& block) {
  const double t = block.width / block.height;
  if (t < std::tan(block.slope_angle) && block.friction_angle > toppling_friction_angle(block)) return BlockMode::topples;
  if (block.friction_angle > block.slope_angle) return BlockMode::stays;
  return t > block.friction() ? BlockMode::slides : BlockMode::slides_and_topples;
}

double first_rotation_acceleration(const BlockOnPlane& block) {
  switch (first_mode(block)) {
    case BlockMode::topples:
      return topple_acceleration(block);
    case BlockMode::slides_and_topples:
      return slide_and_topple_acceleration(block);
    default:
      return 0;
  }
}

double toppling_velocity(const BlockOnPlane& block, double angle) {
  const auto height = [&](double a) { return block.height * std::cos(a) + block.width * std::sin(a); };
  return std::sqrt(3 * block.gravity / diagonal_squared(block) * (height(block.slope_angle) - height(block.slope_angle + angle)));
}

double tipping_angle(const BlockOnPlane& block) {
  return std::atan2(block.width, block.height);
}

double elastic_tipping_angle(const BlockOnPlane& block) {
  const double closure_over_width = block.weight() / (block.normal_stiffness * block.width);
  if (!(closure_over_width * block.height < block.width)) throw std::domain_error("the springs do not hold the block upright");
  // Contracts by the elastic tilt.
  double angle = tipping_angle(block), before = 0;
  do {
    before = angle;
    angle = tipping_angle(block) - std::asin(closure_over_width * std::cos(angle));
  } while (std::abs(angle - before) > 1e-15);
  return angle;
}

}  // namespace openclose::analytical
