// D1: one block on its contact springs, moving vertically: the step map of the code, column by column, against the amplification matrix.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/single_spring.h"
#include "openclose/analytical/two_spring_block.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

// A third of the static closure of the contacts, which therefore stay closed.
constexpr double amplitude = 1.5e-4;  // [m]

analytical::BlockOnPlane level_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  return data;
}

Scene scene_of(const std::string& method, double theta, double dt) {
  Scene scene = block_on_plane(level_block());
  scene.method.contact = method;
  scene.method.theta = theta;
  scene.step.dt = dt;
  use_joint_springs_as_penalty(scene);
  scene.settle.unbalanced_fraction = 1e-12;
  return scene;
}

/// Displacement from equilibrium and velocity after some steps from given ones.
std::array<double, 2> follow(Simulation& simulation, double displacement, double velocity, int steps) {
  if (!settle(simulation).settled) return {not_measured(), not_measured()};
  const Vec2 rest = simulation.system().centroid(1);
  simulation.change_system().advance(1, {0.0, displacement, 0.0});
  simulation.set_velocity(1, {0.0, velocity, 0.0});
  simulation.positions_changed();
  simulation.restart_clock();
  for (int i = 0; i < steps; ++i) {
    if (!simulation.step(simulation.scene().step.dt, false).accepted) return {not_measured(), not_measured()};
  }
  return {simulation.system().centroid(1).y() - rest.y(), simulation.velocity(1)[1]};
}

std::array<double, 2> follow(const Report& report, const Scene& scene, double displacement, double velocity, int steps) {
  Simulation simulation = report.simulate(scene);
  return follow(simulation, displacement, velocity, steps);
}

void matrix(Report& report, const std::string& method, double theta, double phase) {
  const double w = analytical::bounce_frequency(level_block());
  const analytical::SpringStep step{theta, w, phase / w};
  const Scene scene = scene_of(method, theta, step.dt);
  const auto expected = analytical::amplification_matrix(step);
  const auto x = follow(report, scene, amplitude, 0.0, 1);
  const auto v = follow(report, scene, 0.0, amplitude * w, 1);
  const std::array<std::array<double, 2>, 2> measured = {{{x[0] / amplitude, v[0] / (amplitude * w)}, {x[1] / amplitude, v[1] / (amplitude * w)}}};
  const std::string name = text("theta = {}", theta) + text(", w dt = {}", phase);
  // Rounding of gaps of 5e-4 m in coordinates of metres: 1e-15 m over the amplitude, times a few operations.
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double scale = i == j ? 1.0 : (i == 0 ? step.dt : w);
      report.near(name + text(": A{}", i + 1) + text("{}", j + 1), method, expected[i][j] / scale, measured[i][j] / scale, 1e-10, "-",
                  "amplification matrix, off-diagonals over dt and w; rounding 1e-15 m over 1.5e-4 m");
    }
  }
  // Eigenvalues of the measured matrix; without motion there are none to measure.
  const bool moves = std::abs(measured[0][1]) > 0.0;
  const double trace = measured[0][0] + measured[1][1], det = measured[0][0] * measured[1][1] - measured[0][1] * measured[1][0];
  const double discriminant = 0.25 * trace * trace - det;
  const double radius = !moves ? not_measured() : discriminant < 0.0 ? std::sqrt(det) : std::abs(0.5 * trace) + std::sqrt(discriminant);
  report.near(name + ": spectral radius", method, analytical::spectral_radius(step), radius, 1e-9, "-", "(1 + W^2/2)^(-1/2) for theta = 1, W < 4");
  if (phase < 4.0) {
    report.near(name + ": period over exact", method, analytical::period_ratio(step), phase / std::atan2(std::sqrt(-discriminant), 0.5 * trace), 1e-9,
                "-", "argument of the eigenvalues");
  }
}

void order(Report& report, const std::string& method, double theta) {
  const double w = analytical::bounce_frequency(level_block());
  const double end = 2.0 / w;
  std::vector<double> steps, errors;
  for (const int n : {40, 80, 160, 320}) {
    const auto s = follow(report, scene_of(method, theta, end / n), amplitude, 0.0, n);
    steps.push_back(end / n);
    errors.push_back(std::abs(s[0] - amplitude * analytical::free_vibration(w, end)) / amplitude);
  }
  const double expected = theta == 0.5 ? 2.0 : 1.0;
  report.order(text("order on the free vibration, theta = {}", theta), method, steps, errors, expected - 0.1, expected + 0.1, "cos(w t)");
}

void ledger(Report& report, const Scheme& scheme) {
  const double w = analytical::bounce_frequency(level_block());
  constexpr int steps = 100;
  Scene scene = scene_of(scheme.contact, 1.0, 0.1 / w);
  set_scheme(scene, scheme);
  Simulation simulation = report.simulate(scene);
  const bool done = !std::isnan(follow(simulation, amplitude, amplitude * w, steps)[0]);
  check_ledger(report, with_variant("free vibration", scheme), scheme.contact, simulation, done);
}

void amplification(Report& report) {
  for (const double phase : {0.5, 1.0, 3.9, 4.1}) {
    matrix(report, "soft", 1.0, phase);
    matrix(report, "shi", 1.0, phase);
  }
  for (const double theta : {0.5, 0.6}) matrix(report, "soft", theta, 0.5);
  for (const double theta : {1.0, 0.6, 0.5}) order(report, "soft", theta);
  order(report, "shi", 1.0);
  for (const Scheme& scheme : spring_schemes()) ledger(report, scheme);
  report.leave_out("amplification matrix", "dem", "not of the theta family; its order and its critical step are checked in D1c and D3");
  report.leave_out("amplification matrix", "hard", "rigid contacts do not vibrate");
}

const Registered<Case> registered{{"D1", "amplification matrix of one block on a spring", &amplification}};

}  // namespace
}  // namespace openclose::verification
