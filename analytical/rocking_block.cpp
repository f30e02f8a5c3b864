#include "openclose/analytical/rocking_block.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "openclose/analytical/event_ode.h"

namespace openclose::analytical {
namespace {

void require_angle(const RockingBlock& block, double angle) {
  if (!(angle > 0 && angle < block.critical_angle())) throw std::invalid_argument("the angle must be between 0 and the critical one");
}

/// [m/s2] Of the base at a time [s].
using Acceleration = std::function<double(double)>;

EventOde equations(const RockingBlock& block, const Acceleration& acceleration, double tolerance) {
  EventOde ode;
  const double square = block.frequency() * block.frequency(), gravity = block.gravity, alpha = block.critical_angle();
  ode.rates = [=](double t, const double* y, double* rates) {
    rates[0] = y[1];
    rates[1] = -square * (std::sin(alpha - y[0]) - acceleration(t) / gravity * std::cos(alpha - y[0]));
  };
  ode.relative_tolerance = tolerance;
  ode.absolute_tolerances = {tolerance * alpha, tolerance * alpha * block.frequency()};
  return ode;
}

/// [1/s2] Height of the centre, as kinetic energy omega^2/2 that the block loses on its way from an angle to upright over a corner.
double barrier(const RockingBlock& block, double angle) {
  const double half = std::sin((block.critical_angle() - angle) / 2);
  return 2 * block.frequency() * block.frequency() * half * half;
}

double no_shaking(double) {
  return 0;
}

constexpr double tolerance = 1e-13;  // [-] of CVODE

/// Whether a push of the base that makes the block rise at a time, and ends at another, turns it over.
bool falls_after(const RockingBlock& block, const Acceleration& acceleration, double rises, double end) {
  EventOde ode = equations(block, acceleration, tolerance);
  const double critical = block.critical_angle();
  ode.roots = [critical](double, const double* y, double* values) { values[0] = y[0] - critical; };
  ode.root_count = 1;
  EventIntegration session(ode, rises, {0, 0});
  if (!session.advance(end).empty()) return true;
  return session.y()[0] > 0 && session.y()[1] > 0 && session.y()[1] * session.y()[1] / 2 > barrier(block, session.y()[0]);
}

/// By bisection to rounding, from the acceleration at which the block begins to rise.
double smallest_acceleration(const RockingBlock& block, const std::function<bool(double)>& overturned) {
  double low = block.gravity * std::tan(block.critical_angle()), high = 2 * low;
  while (!overturned(high)) high *= 2;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high || high - low < tolerance * high) return middle;
    (overturned(middle) ? high : low) = middle;
  }
}

}  // namespace

double RockingBlock::critical_angle() const {
  return std::atan(width / height);
}
double RockingBlock::frequency() const {
  return std::sqrt(1.5 * gravity / std::hypot(width, height));
}
double RockingBlock::restitution() const {
  return 1 - 1.5 * width * width / (width * width + height * height);
}
double RockingBlock::moment_of_inertia() const {
  return (width * width + height * height) / 3;
}

RockingState rocking_fall(const RockingBlock& block, double angle, double time, double relative_tolerance) {
  require_angle(block, angle);
  EventIntegration session(equations(block, no_shaking, relative_tolerance), 0, {angle, 0});
  session.advance(time);
  return {session.y()[0], session.y()[1]};
}

double rocking_quarter_period(const RockingBlock& block, double angle, double relative_tolerance) {
  require_angle(block, angle);
  EventOde ode = equations(block, no_shaking, relative_tolerance);
  ode.roots = [](double, const double* y, double* values) { values[0] = y[0]; };
  ode.root_count = 1;
  EventIntegration session(ode, 0, {angle, 0});
  // Near the critical angle it hesitates for long; a hundred units of 1/p are beyond what a double can tell from alpha_b.
  if (session.advance(100 / block.frequency()).empty()) throw std::domain_error("the block does not fall back");
  return session.time();
}

double small_angle_quarter_period(const RockingBlock& block, double angle) {
  require_angle(block, angle);
  return std::acosh(1 / (1 - angle / block.critical_angle())) / block.frequency();
}

double rocking_impact_speed(const RockingBlock& block, double angle) {
  require_angle(block, angle);
  return std::sqrt(2 * (barrier(block, 0) - barrier(block, angle)));
}

double angle_after_impact(const RockingBlock& block, double angle) {
  const double speed = block.restitution() * rocking_impact_speed(block, angle);
  const double left = barrier(block, 0) - speed * speed / 2;
  return block.critical_angle() - 2 * std::asin(std::sqrt(left / 2) / block.frequency());
}

double rocking_angle(const RockingBlock& block, double angle, double time) {
  double side = 1, quarter = rocking_quarter_period(block, angle);
  if (time <= quarter) return rocking_fall(block, angle, time).angle;
  for (double since = time - quarter;; since -= 2 * quarter) {
    side = -side;
    angle = angle_after_impact(block, angle);
    quarter = rocking_quarter_period(block, angle);
    // Up and down again are the same fall, backwards and forwards.
    if (since <= 2 * quarter) return side * rocking_fall(block, angle, std::abs(since - quarter)).angle;
  }
}

bool overturns(const RockingBlock& block, double acceleration, double duration) {
  if (!(acceleration > block.gravity * std::tan(block.critical_angle()))) return false;  // it does not even rise
  return falls_after(
      block, [acceleration](double) { return acceleration; }, 0, duration);
}

double overturning_acceleration(const RockingBlock& block, double duration) {
  return smallest_acceleration(block, [&](double acceleration) { return overturns(block, acceleration, duration); });
}

bool overturned_by_half_sine(const RockingBlock& block, double peak, double duration) {
  const double rising = block.gravity * std::tan(block.critical_angle());
  if (!(peak > rising)) return false;
  const double rate = std::numbers::pi / duration;
  return falls_after(
      block, [=](double t) { return peak * std::sin(rate * t); }, std::asin(rising / peak) / rate, duration);
}

double overturning_half_sine(const RockingBlock& block, double duration) {
  return smallest_acceleration(block, [&](double peak) { return overturned_by_half_sine(block, peak, duration); });
}

}  // namespace openclose::analytical
