// D5: Housner's rocking block: rigid contact against the ODE of a block that turns about its corners with plastic impacts, springs against the ODE of
// a block on two springs; overturning by a pulse of the base.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "rocking.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Rocking {
  double at_time = not_measured();         ///< [rad] at `time`
  double quarter_period = not_measured();  ///< [s] until it stands upright
  double other_side = not_measured();      ///< [rad] farthest after the impact
};

/// From rest at half the critical angle with rigid contact.
Rocking free_rocking(const Report& report, double angle, double time, double dt) {
  Simulation simulation = report.simulate(leaning("hard", angle, dt));
  Rocking found;
  double farthest = 0.0, last = angle, turning = 0.0;
  for (int i = 1; i * dt < 1.2; ++i) {
    if (!simulation.advance(dt)) return found;
    const double now = angle + simulation.system().displacement(1)[2];
    if (i == std::lround(time / dt)) found.at_time = now;
    // The last two angles before it is upright, drawn on to zero.
    if (std::isnan(found.quarter_period) && now < 0.5 * (last - now)) found.quarter_period = (i - 1) * dt + last / -turning;
    if (now > 0.0) turning = (now - last) / dt;
    farthest = smaller(farthest, now);
    last = now;
  }
  if (farthest < 0.0) found.other_side = -farthest;
  return found;
}

void rigid(Report& report) {
  const double angle = 0.5 * rocking.critical_angle();
  const double quarter = analytical::rocking_quarter_period(rocking, angle);
  std::vector<double> steps, angles, periods, ratios;
  for (const double n : {64.0, 128.0, 256.0, 512.0, 1024.0}) {
    // The impact half-way in its step, with all of them: its error is of order 1 with a factor that depends on where it is.
    const double dt = quarter / (n + 0.5);
    const Rocking r = free_rocking(report, angle, dt * std::floor(0.8 * n), dt);
    const double ratio =
        analytical::rocking_impact_speed(rocking, std::isnan(r.other_side) ? angle : r.other_side) / analytical::rocking_impact_speed(rocking, angle);
    steps.push_back(dt);
    angles.push_back(std::abs(r.at_time - analytical::rocking_fall(rocking, angle, dt * std::floor(0.8 * n)).angle));
    periods.push_back(4.0 * std::abs(r.quarter_period - quarter));
    ratios.push_back(std::isnan(r.other_side) ? not_measured() : std::abs(ratio - rocking.restitution()));
  }
  report.against(Reference::ode)
      .order("free rocking: angle after 0.8 of the fall", "hard", steps, angles, 0.9, 1.1, "ODE; forces at the end of the step: order 1");
  report.against(Reference::ode)
      .order("free rocking: period from half the critical angle (1.975213 s)", "hard", steps, periods, 0.8, 1.2, "ODE; order 1");
  report.order("ratio of angular velocities at the impact (0.911765)", "hard", steps, ratios, 0.8, 1.2,
               "1 - 1.5 sin^2 alpha_b, from how far it goes after it; order 1");
  Simulation simulation = report.simulate(leaning("hard", angle, 1e-3));
  bool done = true;
  for (int i = 0; i < 2000 && done; ++i) done = simulation.advance(1e-3);
  check_ledger(report, "free rocking", "hard", simulation, done);
}

/// On springs, from rest at half a degree on one corner, which carries the weight, until after a time [s]. Tributary lengths are taken on the
/// bisector of the edges and change by angle^2/8, 1e-5.
class OnSprings {
 public:
  explicit OnSprings(double end) {
    const analytical::BlockOnPlane data = tall_block();
    analytical::SlidingBlockState start;
    start.rotation = angle;
    start.y = 0.5 * data.width * std::sin(angle) - data.height * std::pow(std::sin(0.5 * angle), 2) - closure();
    analytical::SlidingBlockReference reference(data, start);
    for (int i = 1; i <= std::lround(end / every); ++i) times_.push_back(every * i);
    for (const auto& s : reference.states_at(times_)) exact_.push_back(s.rotation);
  }

  /// [rad] Largest error of the rotation.
  double error(const Report& report, const Scheme& scheme, double dt) const {
    Scene scene = leaning(scheme.contact, angle, dt, closure());
    set_scheme(scene, scheme);
    Simulation simulation = report.simulate(scene);
    std::vector<double> angles;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      bool done = true;
      for (int k = 0; k < std::lround(every / dt) && done; ++k) done = simulation.advance(dt);
      angles.push_back(done ? angle + simulation.system().displacement(1)[2] : not_measured());
    }
    return largest_difference(angles, exact_);
  }

  static constexpr double angle = 0.5 * analytical::degree;
  static double closure() { return tall_block().weight() / tall_block().normal_stiffness; }

 private:
  static constexpr double every = 0.01;  // [s]
  std::vector<double> times_, exact_;
};

void elastic(Report& report) {
  const OnSprings before_impact(0.09), two_impacts(0.35);
  for (const Scheme& s : spring_schemes()) {
    std::vector<double> steps, before, after;
    const double first = s.order == 1.0 ? 5e-5 : 1e-3;
    for (const double refinement : {1.0, 2.0, 4.0, 8.0, 16.0}) {
      steps.push_back(first / refinement);
      before.push_back(before_impact.error(report, s, steps.back()));
      after.push_back(two_impacts.error(report, s, steps.back()));
    }
    report.against(Reference::ode)
        .order(with_variant("rocking on springs, one corner", s), s.contact, steps, before, s.order - 0.2, s.order + 0.2,
               "SUNDIALS ODE of two springs; order of the scheme");
    if (s.contact == "shi") {
      report.leave_out(
          "rocking on springs through two impacts", s.contact,
          "a corner that closes by little has little friction in that step and may slide; it then carries mu N as long as it slips one way, where "
          "the reference sticks while N rises: right or 2e-4 rad off, from step size to step size");
    } else {
      report.against(Reference::ode)
          .order(with_variant("rocking on springs through two impacts", s), s.contact, steps, after, s.order == 2.0 ? 1.5 : 0.8,
                 s.order == 2.0 ? 2.4 : 1.2,
                 s.order == 2.0 ? "SUNDIALS ODE of two springs; order 2, and of order 1 what a corner slips in the step in which it closes"
                                : "SUNDIALS ODE of two springs; order 1");
    }
    Scene scene = leaning(s.contact, OnSprings::angle, 1e-3, OnSprings::closure());
    set_scheme(scene, s);
    Simulation simulation = report.simulate(scene);
    bool done = true;
    for (int i = 0; i < 1000 && done; ++i) done = simulation.advance(1e-3);
    check_ledger(report, with_variant("rocking on springs", s), s.contact, simulation, done);
  }
}

/// Under a rectangular pulse.
double overturned(const Report& report, double acceleration, double duration, double dt) {
  BaseMotionInput base;
  base.pulses = {{0.0, duration, {acceleration, 0.0}}};
  return overturned(report, base, duration, dt);
}

/// The smallest acceleration that does, to a tenth of the error of interest.
double overturning_acceleration(const Report& report, double duration, double dt, double width) {
  const double low = 0.5 * analytical::overturning_acceleration(rocking, duration);
  return threshold(low, 4.0 * low, width, [&](double acceleration) { return overturned(report, acceleration, duration, dt); });
}

void overturning(Report& report) {
  const double duration = 0.5, exact = analytical::overturning_acceleration(rocking, duration);
  std::vector<double> steps, errors;
  for (const double dt : {8e-3, 4e-3, 2e-3, 1e-3}) {
    steps.push_back(dt);
    errors.push_back(std::abs(overturning_acceleration(report, duration, dt, 1e-5) - exact));
  }
  report.against(Reference::ode).order("overturning acceleration of a pulse of 0.5 s", "hard", steps, errors, 0.8, 1.2, "ODE and energy; order 1");

  // A map on both sides of the boundary, with a narrow band left out.
  int right = 0, points = 0;
  const double dt = 2e-3, band = 0.02;
  for (const double t : {0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2}) {
    const double boundary = analytical::overturning_acceleration(rocking, t);
    for (const double part : {0.8, 0.9, 1.0 - band, 1.0 + band, 1.1, 1.3}) {
      ++points;
      right += overturned(report, part * boundary, t, dt) == (analytical::overturns(rocking, part * boundary, t) ? 1.0 : 0.0);
    }
  }
  report.against(Reference::ode)
      .near(text("overturning map, points right of {}", points), "hard", points, right, 0.0, "-",
            "ODE and energy; all durations, outside 2 % of the boundary (dt = 2 ms)");
  report.leave_out("overturning map", "soft", "springs tilt the block before it rises: another map for each stiffness; its ODE is checked above");
  report.leave_out("overturning map", "shi", "as soft");
  report.leave_out("overturning map", "dem", "as soft");
}

void rocking_block(Report& report) {
  rigid(report);
  elastic(report);
  overturning(report);
}

const Registered<Case> registered{{"D5", "rocking block", &rocking_block}};

}  // namespace
}  // namespace openclose::verification
