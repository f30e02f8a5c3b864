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

/// From x* on: x - x* = drive (cosh(growth t) - 1) + impulse sinh(growth t).
struct Weakening {
  double growth;          // [1/s] beta
  double drive, impulse;  // [m] g (sin alpha - mu cos alpha)/beta^2, v*/beta
  double way;             // [m] D (1 - kappa)

  Weakening(const BlockOnPlane& block, double residual_angle, double distance, const ReleasedSlide& first) {
    require_valid(block);
    const double drop = block.friction() - std::tan(residual_angle), g = block.gravity, alpha = block.slope_angle;
    const double kappa = first.slip_distance * drop / (block.friction() * distance);
    if (!(kappa < 1.0)) throw std::domain_error("weakened_slide: the springs let go faster than friction falls");
    growth = std::sqrt(g * std::cos(alpha) * drop / (distance * (1.0 - kappa)));
    drive = g * (std::sin(alpha) - block.friction() * std::cos(alpha)) / (growth * growth);
    impulse = first.slip_velocity / growth;
    way = distance * (1.0 - kappa);
    if (!(drive + impulse > 0.0)) throw std::domain_error("weakened_slide: friction stops the block");
  }
  /// [s] until friction is residual
  double duration() const {
    const double sum = way + drive;
    return std::log((sum + std::sqrt(sum * sum - (drive + impulse) * (drive - impulse))) / (drive + impulse)) / growth;
  }
};

}  // namespace

ReleasedSlide weakened_slide(const BlockOnPlane& block, double residual_angle, double distance, const ReleasedSlide& first) {
  const Weakening w(block, residual_angle, distance, first);
  const double duration = w.duration(), z = w.growth * duration;
  return {first.slip_time + duration, first.slip_distance + w.way, w.growth * (w.drive * std::sinh(z) + w.impulse * std::cosh(z)),
          first.acceleration};
}

double cost_of_late_weakening(const BlockOnPlane& block, double residual_angle, double distance, const ReleasedSlide& first, double delay,
                              double time) {
  const Weakening w(block, residual_angle, distance, first);
  const double duration = w.duration(), z = w.growth * duration;
  // e'' = beta^2 (e + delay v) with v = v* cosh(beta t).
  const double late = 0.5 * delay * first.slip_velocity * z * std::sinh(z);
  const double slow = 0.5 * delay * first.slip_velocity * w.growth * (z * std::cosh(z) + std::sinh(z));
  return late + slow * (time - first.slip_time - duration);
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

double weakened_strength_factor(const BlockOnPlane& block, double residual_angle, double distance) {
  const Corners c = corners(block);
  const double residual = std::tan(residual_angle);
  const auto carried = [&](double factor) {
    const double upper = block.friction() * c.upper / factor, lower = block.friction() * c.lower / factor;
    const double slope = (block.friction() - residual) * c.upper / factor / distance;
    if (!(slope < block.shear_stiffness)) throw std::domain_error("weakened_strength_factor: the spring lets go faster than friction falls");
    const double weakened = (upper - slope * lower / block.shear_stiffness) / (1.0 - slope / block.shear_stiffness);
    return std::max(2.0 * upper, lower + std::max(weakened, residual * c.upper / factor));
  };
  // Between the factors without peak and without weakening; halved until nothing lies between.
  double low = residual_strength_factor(block, residual_angle), high = block.friction() * (c.upper + c.lower) / c.shear;
  for (double middle = 0.5 * (low + high); low < middle && middle < high; middle = 0.5 * (low + high)) {
    (carried(middle) >= c.shear ? low : high) = middle;
  }
  return low;
}

}  // namespace openclose::analytical
