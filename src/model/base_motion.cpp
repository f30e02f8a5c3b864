#include "openclose/model/base_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace openclose {
namespace {

/// [m/s] Integral of a record between two times.
double velocity_change(const AccelerationRecord& record, double from, double to) {
  const std::vector<double>& t = record.times;
  const std::vector<double>& a = record.accelerations;
  double change = 0.0;
  // Segment i runs from t[i - 1] to t[i]; the first one that ends after `from`.
  for (std::size_t i = std::max<std::ptrdiff_t>(1, std::upper_bound(t.begin(), t.end(), from) - t.begin()); i < t.size() && t[i - 1] < to; ++i) {
    const double begin = std::max(from, t[i - 1]), end = std::min(to, t[i]);
    if (!(end > begin)) continue;
    const double middle = (0.5 * (begin + end) - t[i - 1]) / (t[i] - t[i - 1]);
    change += (end - begin) * (a[i - 1] + middle * (a[i] - a[i - 1]));
  }
  return change;
}

Vec2 velocity_change(const BaseMotionInput& motion, double from, double to) {
  switch (motion.kind) {
    case BaseMotionKind::pulses: {
      Vec2 change = Vec2::Zero();
      for (const BasePulse& pulse : motion.pulses) {
        const double time = std::min(to, pulse.start + pulse.duration) - std::max(from, pulse.start);
        if (time > 0.0) change += time * pulse.acceleration;
      }
      return change;
    }
    case BaseMotionKind::harmonic: {
      // cos(w from + p) - cos(w to + p), without cancellation.
      const double w = 2.0 * std::numbers::pi * motion.frequency;
      return 2.0 / w * std::sin(0.5 * w * (to - from)) * std::sin(0.5 * w * (from + to) + motion.phase) * motion.amplitude;
    }
    case BaseMotionKind::record:
      return {velocity_change(motion.horizontal, from, to), velocity_change(motion.vertical, from, to)};
  }
  return Vec2::Zero();
}

}  // namespace

Vec2 BaseMotion::mean_acceleration(double from, double to) const {
  if (!input_ || to <= 0.0) return Vec2::Zero();
  return input_->factor / (to - from) * velocity_change(*input_, std::max(from, 0.0), to);
}

}  // namespace openclose
