// D1i, D2i: the integrators of second order. One block on its contact springs against the amplification of each scheme; one that bounces on them,
// with path-averaged forces.
#include <cmath>
#include <complex>

#include "harness.h"
#include "openclose/analytical/single_spring.h"
#include "openclose/analytical/spring_integrators.h"
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

Scene scene_of(const std::string& integrator, double dt) {
  Scene scene = block_on_plane(level_block());
  scene.method.integrator = integrator;
  scene.step.dt = dt;
  scene.settle.unbalanced_fraction = 1e-12;
  return scene;
}

/// Displacement from equilibrium and velocity over w after some steps from given ones.
std::complex<double> follow(const Report& report, const Scene& scene, std::complex<double> start, int steps) {
  const double w = analytical::bounce_frequency(level_block());
  const std::complex<double> nothing(not_measured(), not_measured());
  Simulation simulation = report.simulate(scene);
  if (!settle(simulation).settled) return nothing;
  const Vec2 rest = simulation.system().centroid(1);
  simulation.change_system().advance(1, {0.0, start.real(), 0.0});
  simulation.set_velocity(1, {0.0, start.imag() * w, 0.0});
  simulation.positions_changed();
  simulation.restart_clock();
  for (int i = 0; i < steps; ++i) {
    if (!simulation.advance(scene.step.dt)) return nothing;
  }
  return {simulation.system().centroid(1).y() - rest.y(), simulation.velocity(1)[1] / w};
}

/// What the scheme's own matrix makes of it.
std::complex<double> expected(const std::string& integrator, double phase, std::complex<double> start, int steps) {
  const double w = analytical::bounce_frequency(level_block());
  if (integrator == "tr_bdf2") return start * std::pow(analytical::tr_bdf2_factor(phase), steps);
  std::array<double, 3> x = {start.real(), w * start.imag(), -w * w * start.real()};
  const auto alpha = analytical::generalized_alpha_matrix(default_rho_inf, w, phase / w);
  const auto trapezoid = analytical::amplification_matrix({0.5, w, phase / w});
  for (int n = 0; n < steps; ++n) {
    std::array<double, 3> y{};
    const int size = integrator == "generalized_alpha" ? 3 : 2;
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) y[i] += (size == 3 ? alpha[i][j] : trapezoid[i][j]) * x[j];
    }
    x = y;
  }
  return {x[0], x[1] / w};
}

void amplification(Report& report, const std::string& integrator) {
  for (const double phase : {0.5, 1.0, 4.0}) {
    const Scene scene = scene_of(integrator, phase / analytical::bounce_frequency(level_block()));
    for (const int steps : {1, 20}) {
      for (const std::complex<double> start : {std::complex(amplitude, 0.0), std::complex(0.0, amplitude)}) {
        const auto measured = follow(report, scene, start, steps), scheme = expected(integrator, phase, start, steps);
        // Rounding of gaps of 5e-4 m in coordinates of metres, 1e-15 m over the amplitude, in every step.
        report.near(
            integrator + text(", w dt = {}", phase) + text(", {} steps", steps) + (start.imag() > 0.0 ? " from a velocity" : " from a displacement"),
            "soft", 0.0, std::abs(measured - scheme) / amplitude, 1e-10, "-",
            "distance of (u, v/w) from what the scheme's amplification gives, over the amplitude; rounding 1e-15 m over 1.5e-4 m");
      }
    }
  }
  const double w = analytical::bounce_frequency(level_block()), end = 2.0 / w;
  std::vector<double> steps, errors;
  for (const int n : {20, 40, 80, 160}) {
    const auto s = follow(report, scene_of(integrator, end / n), amplitude, n);
    steps.push_back(end / n);
    errors.push_back(std::abs(s.real() - amplitude * analytical::free_vibration(w, end)) / amplitude);
  }
  report.order("order on the free vibration, " + integrator, "soft", steps, errors, 1.9, 2.1, "cos(w t)");
}

// --- the bounce ---

constexpr double drop = 1.0;  // [m]
// (2/w)(pi - atan(v0 w/g)), (g/w^2)(1 + sqrt(1 + (v0 w/g)^2)) and contact time + 2 v0/g for K = 1e8 N/m and m = 5400 kg.
constexpr double contact_time = 0.02332507, depth = 0.03308370, period = 0.92637235;

struct Bounces {
  double contact = not_measured(), depth = not_measured();  ///< of the first
  double velocity = not_measured();                         ///< at the end
  double energy_drift = not_measured();                     ///< at the end, over that of the drop
};

Bounces bounce(const Report& report, double dt, double end) {
  Scene scene = scene_of("path_average", dt);
  scene.method.start = Start::unloaded;
  Simulation simulation = report.simulate(scene);
  const double loose = simulation.system().centroid(1).y(), weight = 5400.0 * 9.81;
  simulation.change_system().advance(1, {0.0, drop, 0.0});
  simulation.positions_changed();
  simulation.restart_clock();
  Bounces b;
  double y0 = drop, lowest = 0.0, first_touch = 0.0;
  const long steps = std::lround(end / dt);
  for (long i = 0; i < steps; ++i) {
    const double v0 = simulation.velocity(1)[1];
    if (!simulation.advance(dt)) return b;
    const double y = simulation.system().centroid(1).y() - loose, t = static_cast<double>(i) * dt;
    // The motion above the springs is a parabola.
    const auto time_at_zero = [&](double sign, double from_y, double from_v) {
      return (from_v + sign * std::sqrt(from_v * from_v + 2.0 * 9.81 * from_y)) / 9.81;
    };
    if (first_touch == 0.0 && y < 0.0) first_touch = t + time_at_zero(1.0, y0, v0);
    if (first_touch > 0.0 && std::isnan(b.contact) && y > 0.0) {
      b.contact = t + dt + time_at_zero(-1.0, y, simulation.velocity(1)[1]) - first_touch;
      b.depth = -lowest;
    }
    lowest = smaller(lowest, y);
    y0 = y;
  }
  if (first_touch == 0.0) return b;
  b.velocity = simulation.velocity(1)[1];
  const EnergyLedger& ledger = simulation.ledger();
  b.energy_drift = std::abs(ledger.kinetic + ledger.gravity + ledger.contact_springs) / (weight * drop);
  return b;
}

void bounces(Report& report) {
  std::vector<double> steps, errors;
  for (const int n : {500, 1000, 2000, 4000, 8000}) {
    // Until the block is back where it was dropped.
    const Bounces b = bounce(report, period / n, period);
    steps.push_back(period / n);
    errors.push_back(std::abs(b.velocity));
  }
  report.order("velocity at the top after one bounce, order", "soft", steps, errors, 1.8, 2.2,
               "path_average: order 2 over the impact, and no energy lost");
  const double dt = 2e-5, phase = analytical::bounce_frequency(level_block()) * dt;
  const Bounces fine = bounce(report, dt, 0.6);
  // The trapezoid's period is longer by W^2/12; the extreme of samples lies below that of the curve by W^2/8 of the amplitude at most.
  report.relative("contact time", "soft", contact_time, fine.contact, phase * phase + 1e-7, "s", "(2/w)(pi - atan(v0 w/g)), printed to eight digits");
  report.relative("depth", "soft", depth, fine.depth, phase * phase + 1e-7, "m", "(g/w^2)(1 + sqrt(1 + (v0 w/g)^2)), printed to seven digits");
  for (const double dt_of_many : {2e-2, 5e-3}) {
    const Bounces many = bounce(report, dt_of_many, 1000.0 * period);
    report.against(Reference::conservation)
        .near(text("energy after 1000 bounces, dt = {} s", dt_of_many), "soft", 0.0, many.energy_drift, 1e-8, "-",
              "the law is integrated exactly along the path of every step; relative to m g h");
  }
}

void second_order_integrators(Report& report) {
  for (const std::string integrator : {"generalized_alpha", "tr_bdf2", "path_average"}) amplification(report, integrator);
}

const Registered<Case> registered_amplification{{"D1i", "amplification by the integrators of second order", &second_order_integrators}};
const Registered<Case> registered_bounces{{"D2i", "bounces with path-averaged forces", &bounces}};

}  // namespace
}  // namespace openclose::verification
