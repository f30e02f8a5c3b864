#include "openclose/analytical/residual_friction.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace openclose::analytical {

double ReleasedSlide::displacement(double time) const {
  const double since = time - slip_time;
  return slip_distance + slip_velocity * since + 0.5 * acceleration * since * since;
}

ReleasedSlide released_rigid_slide(const BlockOnPlane& block, double residual_angle, double speed) {
  require_valid(block);
  const double g = block.gravity, alpha = block.slope_angle;
  return {0.0, 0.0, speed, g * (std::sin(alpha) - std::tan(residual_angle) * std::cos(alpha))};
}

ReleasedSlide released_slide(const BlockOnPlane& block, double residual_angle, double speed) {
  ReleasedSlide slide = released_rigid_slide(block, residual_angle, speed);
  const double w = std::sqrt(2.0 * block.shear_stiffness / block.mass()), drive = block.gravity * std::sin(block.slope_angle);
  slide.slip_distance = block.friction() * block.normal_weight() / (2.0 * block.shear_stiffness);
  // x = r sin(w t - lag) + r sin(lag), with r cos(lag) = v0/w and r sin(lag) = drive/w^2.
  const double lag = std::atan2(drive / (w * w), speed / w), radius = std::hypot(drive / (w * w), speed / w);
  const double sine = slide.slip_distance / radius - std::sin(lag);
  if (sine >= 1.0) throw std::domain_error("released_slide: the shear springs hold the block");
  slide.slip_time = (std::asin(sine) + lag) / w;
  slide.slip_velocity = radius * w * std::cos(w * slide.slip_time - lag);
  return slide;
}

namespace {

/// [N] On the plane.
struct Corners {
  double shear;         // of both
  double upper, lower;  // normal forces
};

Corners corners(const BlockOnPlane& block) {
  require_valid(block);
  const double shear = block.weight() * std::sin(block.slope_angle), normal = block.normal_weight();
  const double difference = shear * block.height / block.width;
  return {shear, 0.5 * (normal - difference), 0.5 * (normal + difference)};
}

}  // namespace

double first_slip_factor(const BlockOnPlane& block) {
  const Corners c = corners(block);
  return 2.0 * block.friction() * c.upper / c.shear;
}

double residual_strength_factor(const BlockOnPlane& block, double residual_angle) {
  const Corners c = corners(block);
  return std::max(first_slip_factor(block), (std::tan(residual_angle) * c.upper + block.friction() * c.lower) / c.shear);
}

}  // namespace openclose::analytical
