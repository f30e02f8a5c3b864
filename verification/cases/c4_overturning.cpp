// C4: a block that stands on a base is turned over by half a sine of the base's acceleration (Zhang and Makris 2001): the smallest peak over the
// duration, and how it rocks on springs under a peak below that.
#include <cmath>
#include <numbers>

#include "harness.h"
#include "openclose/analytical/ground_motion.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "rocking.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

/// Straight lines between its points leave out (pi/n)^2/8 of the peak at most, 8e-6: far below the error of the steps.
constexpr int points = 400;

BaseMotionInput half_sine(double peak, double duration) {
  BaseMotionInput base;
  base.kind = BaseMotionKind::record;
  for (int i = 0; i <= points; ++i) {
    base.horizontal.times.push_back(duration * i / points);
    base.horizontal.accelerations.push_back(i == points ? 0.0 : peak * std::sin(std::numbers::pi * i / points));
  }
  return base;
}

double overturned(const Report& report, double peak, double duration, double dt) {
  return overturned(report, half_sine(peak, duration), duration, dt);
}

void smallest_peak(Report& report) {
  const double duration = 0.5, exact = analytical::overturning_half_sine(rocking, duration);
  std::vector<double> steps, errors;
  for (const double dt : {8e-3, 4e-3, 2e-3, 1e-3}) {
    steps.push_back(dt);
    const double low = 0.5 * exact;
    errors.push_back(std::abs(threshold(low, 4.0 * low, 1e-5, [&](double peak) { return overturned(report, peak, duration, dt); }) - exact));
  }
  report.against(Reference::ode).order("smallest peak that overturns, 0.5 s", "hard", steps, errors, 0.8, 1.2, "ODE and energy; order 1");
}

/// The smallest peak for each duration is between 2 % less, which stands, and 2 % more, which falls.
void curve(Report& report) {
  constexpr double dt = 2e-3, band = 0.02;
  int right = 0, asked = 0;
  for (const double duration : {0.15, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0}) {
    const double boundary = analytical::overturning_half_sine(rocking, duration);
    for (const double part : {0.8, 1.0 - band, 1.0 + band, 1.3}) {
      ++asked;
      right += overturned(report, part * boundary, duration, dt) == (part > 1.0 ? 1.0 : 0.0);
    }
  }
  report.against(Reference::ode)
      .near(text("smallest peak over the duration, points right of {}", asked), "hard", asked, right, 0.0, "-",
            "ODE and energy; durations of 0.15 to 2 s, outside 2 % of the boundary (dt = 2 ms)");
}

/// The base is at its peak at half the time: until then the block has risen and turns about one corner.
void on_springs(Report& report) {
  const analytical::BlockOnPlane data = tall_block();
  constexpr double peak = 4.0, duration = 0.5, end = 0.25, every = 0.025;
  std::vector<double> times, exact;
  for (int i = 1; i <= std::lround(end / every); ++i) times.push_back(every * i);
  analytical::SlidingBlockReference reference(data, analytical::normal_balanced_start(data));
  for (const auto& s : reference.follow(analytical::half_sine_pulse(peak, duration), times)) exact.push_back(s.rotation);
  for (const Scheme& s : spring_schemes()) {
    std::vector<double> steps, errors;
    for (const double refinement : {1.0, 2.0, 4.0, 8.0, 16.0}) {
      const double dt = (s.order == 1.0 ? 6.25e-5 : 1e-3) / refinement;
      Scene scene = leaning(s.contact, 0.0, dt);
      scene.method.start = Start::normal_balanced;
      scene.base_motion.emplace();
      scene.base_motion->kind = BaseMotionKind::harmonic;  // whose second half does not come
      scene.base_motion->amplitude = {peak, 0.0};
      scene.base_motion->frequency = 0.5 / duration;
      set_scheme(scene, s);
      Simulation simulation = report.simulate(scene);
      bool done = prepare_start(simulation).converged;
      std::vector<double> angles;
      for (std::size_t i = 0; i < times.size(); ++i) {
        for (int k = 0; k < std::lround(every / dt) && done; ++k) done = simulation.advance(dt);
        angles.push_back(done ? simulation.system().displacement(1)[2] : not_measured());
      }
      steps.push_back(dt);
      errors.push_back(largest_difference(angles, exact));
    }
    report.against(Reference::ode)
        .order(with_variant("rotation on springs until the peak", s), s.contact, steps, errors, s.order - 0.2, s.order + 0.2,
               "SUNDIALS ODE of two springs; order of the scheme");
  }
}

void overturning(Report& report) {
  smallest_peak(report);
  curve(report);
  on_springs(report);
  for (const std::string method : {"soft", "shi", "dem"})
    report.leave_out("smallest peak that overturns", method, "springs tilt the block before it rises: another curve for each stiffness; see its ODE");
}

const Registered<Case> registered{{"C4", "a block turned over by half a sine", &overturning}};

}  // namespace
}  // namespace openclose::verification
