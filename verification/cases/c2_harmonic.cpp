// C2: harmonic shaking of an incline (Goodman & Seed): the block slips downhill in every cycle.
#include <cmath>
#include <numbers>

#include "harness.h"
#include "openclose/analytical/newmark_block.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double amplitude = 0.3 * 9.81;  // [m/s2]
constexpr double frequency = 2.0;         // [Hz]
constexpr double omega = 2.0 * std::numbers::pi * frequency;

analytical::BlockOnPlane incline_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 20.0 * analytical::degree;
  data.friction_angle = 25.0 * analytical::degree;
  return data;
}

Scene scene_of(const std::string& method, const analytical::BlockOnPlane& data, double dt, double end) {
  Scene scene = block_on_plane(data);
  scene.method.contact = method;
  scene.method.start = Start::settled;
  scene.step.dt = dt;
  scene.end_time = end;
  scene.output_every = 0.5;
  // The ground goes uphill, to the left, where the block's inertia points downhill.
  scene.base_motion.emplace();
  scene.base_motion->kind = BaseMotionKind::harmonic;
  scene.base_motion->amplitude = {-amplitude, 0.0};
  scene.base_motion->frequency = frequency;
  use_joint_springs_as_penalty(scene);
  return scene;
}

/// Rigid contact. With mid-step velocities a slip that starts in the middle between two of them misses s dt^2/8 of its speed (s the rate of the pull
/// that exceeds friction), one that stops at a whole step nothing, and the sum of mid-step velocities exceeds the path by r dt^2/24 (r the
/// retardation at the stop): order 2. The phase puts both events there.
void rigid(Report& report) {
  const analytical::BlockOnPlane data = incline_block();
  const auto cycle = analytical::harmonic_slip(data, amplitude, frequency);
  const double span = cycle.end - cycle.start, kappa = std::cos(data.friction_angle - data.slope_angle) / std::cos(data.friction_angle);
  const double pull_rate = kappa * amplitude * omega * std::cos(omega * cycle.start);
  const double retardation = kappa * (cycle.yield - amplitude * std::sin(omega * cycle.end));
  std::vector<double> steps, errors;
  for (const int n : {64, 128, 256, 512}) {
    const double dt = span / n;
    Scene scene = scene_of("hard", data, dt, dt * std::ceil(0.45 / dt));
    scene.output_every = scene.end_time;
    scene.base_motion->phase = omega * (cycle.start - span / 16.0);
    Simulation simulation = report.simulate(scene);
    steps.push_back(dt);
    errors.push_back(std::abs(downhill_history(simulation, data, 2).back() - cycle.distance));
  }
  report.order("one cycle, slip from and to whole steps", "hard", steps, errors, 1.9, 2.1, "Goodman & Seed; order 2");
  const double expected = std::abs(-pull_rate / 8.0 * span + retardation / 24.0);
  report.relative("its error over dt^2", "hard", expected, errors.back() / (steps.back() * steps.back()), 0.1, "m/s2",
                  "s (t2 - t1)/8 - r/24; next order in w dt left out");

  // Wherever in their steps slips begin and end: at most s (t2 - t1)/8 + r (1/8 + 1/24), times dt^2.
  const double dt = 1e-4;
  Simulation simulation = report.simulate(scene_of("hard", data, dt, 1.5));
  const auto places = downhill_history(simulation, data, 4);
  for (int i = 1; i <= 3; ++i) {
    report.near("cycle " + text("{}", i) + text(", dt = {} s", dt), "hard", cycle.distance, places[i] - places[i - 1],
                (pull_rate * span / 8.0 + retardation / 6.0) * dt * dt, "m", "Goodman & Seed; [s (t2 - t1)/8 + r/6] dt^2 = 4e-7 of it");
  }
  check_ledger(report, "three cycles", "hard", simulation, !std::isnan(places.back()));
}

/// Springs: the slip begins later and ends earlier by what they give, which the pull passes smoothly: as 1/ks.
void stiffness(Report& report) {
  const auto cycle = analytical::harmonic_slip(incline_block(), amplitude, frequency);
  std::vector<double> stiffnesses, errors;
  for (const double k : {5e8, 2e9, 8e9, 3.2e10}) {
    analytical::BlockOnPlane data = incline_block();
    data.normal_stiffness = data.shear_stiffness = k;
    Scene scene = scene_of("soft", data, 0.5 / std::ceil(0.5 / (0.05 / std::sqrt(2.0 * k / data.mass()))), 1.0);
    scene.method.theta = 0.5;
    Simulation simulation = report.simulate(scene);
    const auto places = downhill_history(simulation, data, 3);
    stiffnesses.push_back(k);
    errors.push_back(std::abs(places[2] - places[1] - cycle.distance));
  }
  report.order("one cycle, distance from the rigid block over the stiffness", "soft", stiffnesses, errors, -1.3, -0.7,
               "order -1; the swing after the stop, of the same order, is met at a random phase", stiffness_name);
}

/// Springs against the ODE on the shaken plane, from relaxed shear springs.
void elastic(Report& report) {
  const analytical::BlockOnPlane data = incline_block();
  constexpr double end = 0.25;
  analytical::SlidingBlockReference reference(data, analytical::normal_balanced_start(data));
  const double exact = reference.follow(analytical::harmonic_motion(-amplitude, frequency, 1.0), {end}).back().x;
  for (const Scheme& s : spring_schemes()) {
    std::vector<double> steps, errors;
    for (const double n : {1000.0, 2000.0, 4000.0, 8000.0, 16000.0}) {
      Scene scene = scene_of(s.contact, data, end / n, end);
      set_scheme(scene, s);
      scene.method.start = Start::normal_balanced;
      scene.output_every = end;
      Simulation simulation = report.simulate(scene);
      steps.push_back(end / n);
      errors.push_back(std::abs(downhill_history(simulation, data, 2).back() - exact));
    }
    const double slack = s.order == 2.0 ? 0.4 : 0.2;
    report.against(Reference::ode)
        .order(with_variant("place in mid-slip", s), s.contact, steps, errors, s.order - slack, s.order + slack,
               "SUNDIALS ODE on the shaken plane; order of the scheme");
  }
}

void shaken_incline(Report& report) {
  rigid(report);
  stiffness(report);
  elastic(report);
  for (const std::string method : {"soft", "shi", "dem"}) {
    Simulation simulation = report.simulate(scene_of(method, incline_block(), 1e-3, 1.5));
    check_ledger(report, "three cycles", method, simulation, !history(simulation).empty());
  }
}

const Registered<Case> registered{{"C2", "block on an incline under harmonic shaking", &shaken_incline}};

}  // namespace
}  // namespace openclose::verification
