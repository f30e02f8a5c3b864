#include <cmath>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/rocking_block.h"
#include "support/catch.h"

using namespace openclose::analytical;

TEST_CASE("rocking block: the numbers of case D5", "[rocking]") {
  const RockingBlock block;
  const double half = 0.5 * block.critical_angle();
  CHECK(block.frequency() == Approx(2.671671).epsilon(1e-6));
  CHECK(block.restitution() == Approx(0.911765).epsilon(1e-6));
  CHECK(block.restitution() == Approx(1.0 - 1.5 * std::pow(std::sin(block.critical_angle()), 2)).epsilon(1e-14));
  CHECK(4.0 * rocking_quarter_period(block, half) == Approx(1.975213).epsilon(1e-6));
  CHECK(4.0 * small_angle_quarter_period(block, half) == Approx(1.971737).epsilon(1e-6));
}

TEST_CASE("the small-angle formula is the limit of slender blocks", "[rocking]") {
  // The relative difference falls with the square of the critical angle.
  double last = 0.0;
  for (const double width : {0.4, 0.2, 0.1}) {
    const RockingBlock block{width, 2.0, 9.81};
    const double angle = 0.4 * block.critical_angle();
    const double difference = rocking_quarter_period(block, angle) / small_angle_quarter_period(block, angle) - 1.0;
    if (last != 0.0) CHECK(last / difference == Approx(4.0).margin(0.2));
    last = difference;
  }
}

TEST_CASE("rocking: ODE against energy and against a tighter tolerance", "[rocking]") {
  for (const RockingBlock& block : {RockingBlock{}, RockingBlock{1.0, 1.5, 9.81}, RockingBlock{0.3, 4.0, 1.6}}) {
    for (const double part : {0.1, 0.5, 0.9}) {
      const double angle = part * block.critical_angle(), time = rocking_quarter_period(block, angle);
      CHECK(rocking_quarter_period(block, angle, 1e-8) == Approx(time).epsilon(1e-6));
      const RockingState upright = rocking_fall(block, angle, time);
      CHECK(upright.angle == Approx(0.0).margin(1e-11));
      CHECK(-upright.velocity == Approx(rocking_impact_speed(block, angle)).epsilon(1e-10));
      // On the other side, back from where it gets to, it has the speed after the impact.
      const double other = angle_after_impact(block, angle);
      CHECK(other < angle);
      CHECK(rocking_impact_speed(block, other) == Approx(block.restitution() * rocking_impact_speed(block, angle)).epsilon(1e-12));
    }
  }
  CHECK_THROWS_AS(rocking_quarter_period(RockingBlock{}, 0.3), std::invalid_argument);
  CHECK_THROWS_AS(rocking_quarter_period(RockingBlock{}, 0.0), std::invalid_argument);
}

TEST_CASE("rocking with impacts: upright at each of them, farthest between, half-periods shrink", "[rocking]") {
  const RockingBlock block;
  const double start = 0.5 * block.critical_angle(), first = rocking_quarter_period(block, start);
  CHECK(rocking_angle(block, start, 0.3 * first) == Approx(rocking_fall(block, start, 0.3 * first).angle).epsilon(1e-10));
  double impact = first, angle = start, side = 1;
  for (int i = 0; i < 3; ++i) {
    CHECK(rocking_angle(block, start, impact) == Approx(0.0).margin(1e-10));
    angle = angle_after_impact(block, angle);
    side = -side;
    const double quarter = rocking_quarter_period(block, angle);
    CHECK(rocking_angle(block, start, impact + quarter) == Approx(side * angle).epsilon(1e-10));
    // The speed just after the impact, from two angles near it.
    const double h = 1e-4, speed = rocking_angle(block, start, impact + h) / h;
    CHECK(side * speed == Approx(rocking_impact_speed(block, angle)).epsilon(1e-3));
    impact += 2 * quarter;
  }
}

TEST_CASE("overturning by a pulse: limits of long and short pulses", "[rocking]") {
  const RockingBlock block;
  const double yield = block.gravity * std::tan(block.critical_angle());
  CHECK(!overturns(block, 0.99 * yield, 100.0));
  // A pulse that lasts turns it over from the yield on; one that does not needs the velocity of a blow: a T m h/2 = I sqrt(2 barrier/I).
  CHECK(overturning_acceleration(block, 10.0) == Approx(yield).epsilon(1e-3));
  const double short_pulse = 1e-3, needed = std::sqrt(2.0 * 2.0 * std::pow(block.frequency() * std::sin(0.5 * block.critical_angle()), 2));
  const double blow = needed * block.moment_of_inertia() / (0.5 * block.height);
  CHECK(overturning_acceleration(block, short_pulse) * short_pulse == Approx(blow).epsilon(2e-3));
  const double critical = overturning_acceleration(block, 0.5);
  CHECK(overturns(block, 1.0001 * critical, 0.5));
  CHECK(!overturns(block, 0.9999 * critical, 0.5));
  // Slender blocks under a pulse of A yield: cosh(p T) = 1 + 1/(2 A (A - 1)).
  for (const double part : {1.5, 2.5}) {
    const RockingBlock slender{0.02, 2.0, 9.81};
    const double duration = std::acosh(1.0 + 1.0 / (2.0 * part * (part - 1.0))) / slender.frequency();
    CHECK(overturning_acceleration(slender, duration) == Approx(part * slender.gravity * std::tan(slender.critical_angle())).epsilon(1e-3));
  }
}

TEST_CASE("overturning by half a sine: a blow, and slender blocks", "[rocking]") {
  const RockingBlock block;
  // A short one is the blow of its mean, 2/pi of the peak.
  const double mean = 2.0 / std::numbers::pi;
  CHECK(mean * overturning_half_sine(block, 1e-3) == Approx(overturning_acceleration(block, 1e-3)).epsilon(2e-3));
  CHECK(!overturned_by_half_sine(block, 0.99 * block.gravity * std::tan(block.critical_angle()), 5.0));
  const double critical = overturning_half_sine(block, 0.5);
  CHECK(overturned_by_half_sine(block, 1.0001 * critical, 0.5));
  CHECK(!overturned_by_half_sine(block, 0.9999 * critical, 0.5));
  // theta'' = p^2 (theta - alpha + (a/g) sin w t) from t0 on, at rest: the part that grows as exp(p t) vanishes at the limit, that is
  // (a/g) int_t0^T exp(-p t) sin w t dt = alpha exp(-p t0)/p.
  for (const double duration : {0.3, 0.8}) {
    const RockingBlock slender{0.002, 2.0, 9.81};
    const double p = slender.frequency(), w = std::numbers::pi / duration, alpha = slender.critical_angle();
    const double part = overturning_half_sine(slender, duration) / slender.gravity, begin = std::asin(alpha / part) / w;
    const auto primitive = [&](double t) { return -std::exp(-p * t) * (p * std::sin(w * t) + w * std::cos(w * t)) / (p * p + w * w); };
    CHECK(part * (primitive(duration) - primitive(begin)) == Approx(alpha * std::exp(-p * begin) / p).epsilon(1e-5));
  }
}
