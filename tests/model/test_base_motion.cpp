#include <cmath>
#include <numbers>

#include "openclose/model/base_motion.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// By many small rectangles, at the middle of each.
template <class F>
double integral(F f, double from, double to, int pieces = 100000) {
  double sum = 0.0;
  const double h = (to - from) / pieces;
  for (int i = 0; i < pieces; ++i) sum += h * f(from + (i + 0.5) * h);
  return sum;
}

}  // namespace

TEST_CASE("a base without motion rests", "[model][base_motion]") {
  CHECK(BaseMotion(std::nullopt).mean_acceleration(0.0, 1.0) == Vec2(0.0, 0.0));
}

TEST_CASE("pulses count with the part of them that lies in the step", "[model][base_motion]") {
  BaseMotionInput input;
  input.kind = BaseMotionKind::pulses;
  input.factor = 2.0;
  input.pulses = {{0.5, 1.0, {3.0, -1.0}}, {1.0, 2.0, {1.0, 0.0}}};
  const BaseMotion base(input);
  CHECK(base.mean_acceleration(0.0, 0.5) == Vec2(0.0, 0.0));
  CHECK(base.mean_acceleration(0.5, 1.0).isApprox(Vec2(6.0, -2.0), 1e-15));
  CHECK(base.mean_acceleration(0.25, 0.75).isApprox(Vec2(3.0, -1.0), 1e-15));
  CHECK(base.mean_acceleration(1.25, 1.75).isApprox(Vec2(5.0, -1.0), 1e-15));
  CHECK(base.mean_acceleration(0.0, 10.0).isApprox(2.0 / 10.0 * Vec2(3.0 + 2.0, -1.0), 1e-15));
}

TEST_CASE("harmonic motion: the difference of the velocities", "[model][base_motion]") {
  BaseMotionInput input;
  input.kind = BaseMotionKind::harmonic;
  input.amplitude = {2.0, -0.5};
  input.frequency = 1.7;
  input.phase = 0.3;
  const BaseMotion base(input);
  const double w = 2.0 * std::numbers::pi * input.frequency;
  for (const double from : {0.0, 0.1, 1.234}) {
    for (const double h : {0.01, 0.3, 2.0}) {
      const double change = (std::cos(w * from + input.phase) - std::cos(w * (from + h) + input.phase)) / w;
      CHECK(base.mean_acceleration(from, from + h).isApprox(change / h * input.amplitude, 1e-12));
    }
  }
  // A short step is not the difference of two nearly equal numbers.
  CHECK(base.mean_acceleration(1.0, 1.0 + 1e-9).x() == Approx(2.0 * std::sin(w * (1.0 + 0.5e-9) + input.phase)).epsilon(1e-14));
  // Before time 0 the base rests.
  CHECK(base.mean_acceleration(-1.0, 1.0).isApprox(0.5 * base.mean_acceleration(0.0, 1.0), 1e-15));
}

TEST_CASE("records: every piece that lies in the step", "[model][base_motion]") {
  BaseMotionInput input;
  input.kind = BaseMotionKind::record;
  input.horizontal = {{0.2, 0.5, 0.5, 1.1, 1.3}, {1.0, -2.0, 4.0, 0.5, 3.0}};
  input.vertical = {{0.0, 2.0}, {1.0, 0.0}};
  const BaseMotion base(input);
  const auto horizontal = [](double t) {
    if (t < 0.2 || t > 1.3) return 0.0;
    if (t < 0.5) return 1.0 - 10.0 * (t - 0.2);
    if (t < 1.1) return 4.0 - 3.5 / 0.6 * (t - 0.5);
    return 0.5 + 12.5 * (t - 1.1);
  };
  for (const auto& [from, to] :
       {std::pair{0.0, 0.1}, {0.0, 0.3}, {0.3, 0.4}, {0.4, 0.6}, {0.1, 1.2}, {0.0, 5.0}, {1.25, 1.5}, {1.4, 1.5}, {0.5, 1.1}}) {
    INFO(from << " to " << to);
    // Rectangles miss half a piece times a jump of 6 m/s2.
    const double rough = integral(horizontal, from, to) / (to - from);
    CHECK(base.mean_acceleration(from, to).x() == Approx(rough).margin(1e-4).epsilon(0.0));
    const double below = [](double t) { return std::min(t, 2.0) - 0.25 * std::min(t, 2.0) * std::min(t, 2.0); }(to) -
                         [](double t) { return std::min(t, 2.0) - 0.25 * std::min(t, 2.0) * std::min(t, 2.0); }(from);
    CHECK(base.mean_acceleration(from, to).y() == Approx(below / (to - from)).epsilon(1e-13));
  }
  // However it is cut into steps, the velocity is the same.
  double sum = 0.0;
  for (int i = 0; i < 1000; ++i) sum += 2e-3 * base.mean_acceleration(2e-3 * i, 2e-3 * (i + 1)).x();
  CHECK(sum == Approx(2.0 * base.mean_acceleration(0.0, 2.0).x()).epsilon(1e-13));
  CHECK(sum == Approx(0.3 * -0.5 + 0.6 * 2.25 + 0.2 * 1.75).epsilon(1e-13));
}
