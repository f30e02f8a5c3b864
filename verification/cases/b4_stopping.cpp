// B4: a block thrown along a plane comes to a stop by friction.
#include <Eigen/QR>
#include <cmath>

#include "harness.h"
#include "near_steps.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "openclose/analytical/stopping_distance.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

struct Throw {
  const char* name;
  analytical::BlockOnPlane data;
  int direction;  ///< +1 downhill, -1 uphill
};

constexpr double speed = 5.0;  // [m/s]

std::vector<Throw> throws() {
  analytical::BlockOnPlane level, slope;
  level.slope_angle = 0.0;
  level.friction_angle = std::atan(0.5);
  slope.slope_angle = 20.0 * analytical::degree;
  slope.friction_angle = 30.0 * analytical::degree;
  return {{"level", level, 1}, {"uphill", slope, -1}, {"downhill", slope, 1}};
}

Scene scene_of(const Throw& t, const std::string& method, double dt, double end) {
  Scene scene = block_on_plane(t.data);
  scene.method.contact = method;
  scene.method.start = Start::normal_balanced;
  scene.step.dt = dt;
  scene.end_time = end;
  scene.output_every = 0.05;
  use_joint_springs_as_penalty(scene);
  scene.blocks[1].velocity = t.direction * speed * downhill(t.data.slope_angle);
  return scene;
}

/// Rigid contact stops where the closed form says: the step in which it stops is the only one without constant force, so the place is off by at most
/// what the block would travel in it, r dt^2.
void rigid(Report& report, const Throw& t) {
  const auto stop = analytical::stopping(t.data, speed, t.direction);
  for (const double dt : {1e-2, 1e-3}) {
    Simulation simulation = report.simulate(scene_of(t, "hard", dt, 0.05 * std::ceil(stop.time / 0.05 + 2.0)));
    const auto samples = history(simulation);
    const double travelled = samples.empty() ? not_measured() : t.direction * downhill(t.data, samples.back().motion.displacement);
    report.near(std::string(t.name) + text(": distance, dt = {} s", dt), "hard", stop.distance, travelled, speed / stop.time * dt * dt, "m",
                "v0^2/(2 r); tolerance r dt^2");
  }
}

/// Springs, trapezoid: against the ODE, through the stop and the oscillation after it.
void elastic(Report& report, const Throw& t) {
  const double end = 0.05 * std::ceil(analytical::stopping(t.data, speed, t.direction).time / 0.05 + 1.0);
  auto start = analytical::normal_balanced_start(t.data);
  start.velocity_x = t.direction * speed;
  analytical::SlidingBlockReference reference(t.data, start);
  const double exact = reference.advance(end).x;
  std::vector<double> steps, errors;
  for (const double dt : {2e-4, 1e-4, 5e-5, 2.5e-5, 1.25e-5}) {
    Scene scene = scene_of(t, "soft", dt, end);
    scene.method.theta = 0.5;
    Simulation simulation = report.simulate(scene);
    const auto samples = history(simulation);
    steps.push_back(dt);
    errors.push_back(samples.empty() ? not_measured() : std::abs(downhill(t.data, samples.back().motion.displacement) - exact));
  }
  report.against(Reference::ode)
      .order(std::string(t.name) + ": place after the stop, trapezoid", "soft", steps, errors, 1.6, 2.4, "SUNDIALS ODE; order 2");
}

/// Newmark (1/2, 1) damps the swing after the stop: the block comes to rest in its middle, d - mu W/(2 ks), off by at most what the step in which it
/// stops may be, r dt^2.
void rest(Report& report, const Throw& t, const std::string& method) {
  const auto expected = analytical::rebound_after_stop(t.data, speed);
  const auto stop = analytical::stopping(t.data, speed, t.direction);
  for (const double dt : {1.6e-3, 4e-4}) {
    // The swing falls as exp(-w^2 dt t/4): to 1e-9 of its amplitude.
    const double damping = 4.0 * 20.0 / (std::pow(expected.frequency, 2) * dt);
    Scene scene = scene_of(t, method, dt, std::ceil(1.1 + damping));
    scene.output_every = 1.0;
    scene.method.start = Start::steady_sliding;
    scene.blocks[1].rotation_locked = true;
    Simulation simulation = report.simulate(scene);
    const auto samples = history(simulation);
    const double place = samples.empty() ? not_measured() : downhill(t.data, samples.back().motion.displacement);
    report.near(text("level, rotation locked: place of rest, dt = {} s", dt), method, expected.centre, place, speed / stop.time * dt * dt, "m",
                "d - mu W/(2 ks); tolerance r dt^2");
  }
}

/// c of the swing c + a cos(w t) + b sin(w t) that fits best; NaN without samples. \param frequency  w [rad/s]
double middle_of(const std::vector<Sample>& swing, double frequency) {
  if (swing.empty()) return not_measured();
  const auto count = static_cast<Eigen::Index>(swing.size());
  Eigen::MatrixX3d terms(count, 3);
  Eigen::VectorXd places(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& s = swing[static_cast<std::size_t>(i)];
    terms.row(i) << 1.0, std::cos(frequency * s.time), std::sin(frequency * s.time);
    places[i] = s.motion.displacement.x();
  }
  return terms.colPivHouseholderQr().solve(places)[0];
}

struct Swing {
  double centre, amplitude;  ///< [m]
};

/// Level, rotation locked, from the steady state: the springs throw the block back, and it swings about d - mu W/(2 ks).
Swing swing_after_stop(const Report& report, const Throw& t, double dt, double frequency) {
  Scene scene = scene_of(t, "soft", dt, 1.2);
  scene.method.theta = 0.5;
  scene.method.start = Start::steady_sliding;
  scene.blocks[1].rotation_locked = true;
  scene.output_every = dt;
  Simulation simulation = report.simulate(scene);
  double low = 1e300, high = -1e300;
  std::vector<Sample> swing;
  for (const Sample& s : history(simulation)) {
    if (s.time < 1.05) continue;
    swing.push_back(s);
    low = smaller(low, s.motion.displacement.x());
    high = larger(high, s.motion.displacement.x());
  }
  return {middle_of(swing, 2.0 / dt * std::atan(0.5 * frequency * dt)), 0.5 * (high - low)};
}

/// The block stops anywhere within a step, so that the largest error of near steps is taken. Its factor goes with the part p of the step that is left
/// as p (1 - p): of five parts at random the largest is above half of the most it can be with 99.8 %, that is known to sqrt(2) either way. The
/// slope of a line through five such errors a halving apart is then known to 0.6 ln(sqrt(2))/ln(2), 0.3.
void rebound(Report& report, const Throw& t) {
  const auto expected = analytical::rebound_after_stop(t.data, speed);
  std::vector<double> steps, errors;
  for (const double dt : {2e-4, 1e-4, 5e-5, 2.5e-5, 1.25e-5}) {
    steps.push_back(dt);
    errors.push_back(largest_error_near(
        dt, 1.2, [&](double near) { return std::abs(swing_after_stop(report, t, near, expected.frequency).centre - expected.centre); }));
  }
  // Sampled every (w dt): the crest is missed by at most (w dt)^2/8, the trapezoid keeps the amplitude.
  constexpr double fine = 2.5e-5;  // [s]
  const double phase = expected.frequency * fine;
  report.relative("level, rotation locked: amplitude after the stop", "soft", expected.amplitude,
                  swing_after_stop(report, t, fine, expected.frequency).amplitude, phase * phase, "m",
                  "mu W/(2 ks); trapezoid keeps it, sampling misses (w dt)^2/8");
  report.order("level, rotation locked: centre after the stop", "soft", steps, errors, 1.7, 2.3,
               "d - mu W/(2 ks), of the sine at the trapezoid's frequency that fits best; order 2, the largest error of five near steps");
  report.leave_out("rebound after the stop", "dem", "its order is checked on the same motion in case B1");
  report.leave_out("rebound after the stop", "hard", "rigid contacts do not swing");
  report.leave_out("rebound after the stop", "shi", "Newmark (1/2, 1) damps the swing; the place of rest is checked instead");
}

struct StopTimes {
  double drawn_on = not_measured();  ///< [s] where the last two velocities before the stop lead to
  double at_rest = not_measured();   ///< [s] after which it has a millionth of its first velocity or less
};

StopTimes stop_times(const Report& report, const Throw& t, const Scheme& scheme, double dt) {
  Scene scene = scene_of(t, scheme.contact, dt, 2.0);
  set_scheme(scene, scheme);
  scene.method.start = Start::steady_sliding;
  scene.blocks[1].rotation_locked = true;
  Simulation simulation = report.simulate(scene);
  StopTimes found;
  if (!prepare_start(simulation).converged) return found;
  double before = speed;
  for (int i = 1; i * dt < 10.0 * speed; ++i) {
    if (!simulation.advance(dt)) return {};
    const double now = t.direction * downhill(t.data, simulation.velocity(1).head<2>());
    if (now > 0.0 && now < before && std::isnan(found.at_rest)) {
      found.drawn_on = i * dt + now * dt / (before - now);
    } else if (std::isnan(found.drawn_on)) {
      return {};
    }
    if (std::abs(now) <= 1e-6 * speed) {
      found.at_rest = i * dt;
      return found;
    }
    if (now <= 0.0 && scheme.contact != "hard") return found;
    before = now;
  }
  return {};
}

/// The retardation is constant until the stop, so that every scheme has it exactly; what is left is rounding of velocities over what is lost in a
/// step. Rigid contact slips on in the step of the stop if its mid-step velocity does not change its sign there, and sticks in the next one: half a
/// step to one and a half late, and one more where only the step after that takes the velocity to zero.
void times_of_stop(Report& report, const Throw& t) {
  const auto stop = analytical::stopping(t.data, speed, t.direction);
  const std::string name = t.name;
  for (const Scheme& scheme : schemes()) {
    if (t.direction < 0 && scheme.contact != "hard") continue;
    const StopTimes found = stop_times(report, t, scheme, 1e-3);
    report.relative(with_variant(name + ": time of the stop, drawn on", scheme), scheme.contact, stop.time, found.drawn_on, 1e-10, "s",
                    "v0/r; constant retardation");
  }
  if (t.direction < 0)
    report.leave_out(name + ": time of the stop", "soft, shi, dem", "no start has shear springs that resist an upward motion; they swing about r");
  for (const double dt : {1e-2, 1e-3}) {
    const double at_rest = stop_times(report, t, scheme_named("hard"), dt).at_rest;
    report.between(name + text(": at rest, steps after the stop, dt = {} s", dt), "hard", 0.5, 2.5, (at_rest - stop.time) / dt, "-",
                   "v0/r; the step of the stop, the one that sticks, the one that takes the rest of the velocity");
  }
}

void ledger(Report& report, const Throw& t) {
  for (const Scheme& scheme : schemes()) {
    Scene scene = scene_of(t, scheme.contact, 1e-3, 1.5);
    set_scheme(scene, scheme);
    Simulation simulation = report.simulate(scene);
    const bool done = !history(simulation).empty();
    const EnergyLedger& l = simulation.ledger();
    check_ledger(report, with_variant(t.name, scheme), scheme.contact, simulation, done);
    if (!scheme.variant.empty()) continue;
    const std::string& method = scheme.contact;
    const double kinetic = 0.5 * t.data.mass() * speed * speed;
    // All but what springs and scheme take ends in friction; both are below the energy of the shear springs at their bound and of one step of
    // sliding.
    const double springs = std::pow(t.data.friction() * t.data.normal_weight(), 2) / (2.0 * t.data.shear_stiffness);
    const double slack = 2.0 * springs + t.data.friction() * t.data.normal_weight() * speed * 1e-3;
    if (t.data.slope_angle == 0.0) {
      report.near("level: dissipated by friction", method, kinetic, l.friction, slack, "J", "m v0^2/2, less springs and one step");
    }
  }
}

void stopping(Report& report) {
  for (const Throw& t : throws()) {
    rigid(report, t);
    elastic(report, t);
    times_of_stop(report, t);
    ledger(report, t);
  }
  for (const std::string method : {"soft", "shi"}) rest(report, throws().front(), method);
  rebound(report, throws().front());
}

const Registered<Case> registered{{"B4", "initial velocity to a stop", &stopping}};

}  // namespace
}  // namespace openclose::verification
