// D2: a block falls on its contact springs and bounces: contact time, depth, period, and what each scheme makes of the energy.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/bounce.h"
#include "openclose/analytical/single_spring.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

analytical::BlockOnPlane level_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  return data;
}

analytical::Bounce drop_of_a_metre() {
  const analytical::BlockOnPlane data = level_block();
  return {1.0, std::sqrt(2.0 * data.normal_stiffness / data.mass()), data.gravity};
}

/// The block at a moment of the exact motion.
Scene scene_of(const Scheme& scheme, double time, double dt) {
  const auto [height, velocity] = drop_of_a_metre().at(time);
  Scene scene = block_on_plane(level_block());
  for (Vec2& v : scene.blocks[1].vertices) v.y() += height;
  scene.blocks[1].velocity = {0.0, velocity};
  scene.blocks[1].rotation_locked = true;
  set_scheme(scene, scheme);
  scene.step.dt = dt;
  use_joint_springs_as_penalty(scene);
  return scene;
}

struct State {
  double height, velocity;
};
State state_of(Simulation& simulation) {
  return {simulation.system().position(1, simulation.system().block(1).first_vertex).y(), simulation.velocity(1)[1]};
}
bool advance(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) {
    if (!simulation.advance(simulation.scene().step.dt)) return false;
  }
  return true;
}

/// What a bounce was, from the state a while after it: off the spring the block flies.
struct Flight {
  double place, speed, contact, period, depth;
};

/// Steps that divide the contact time, from two contact times before the touch to two after the end: both fall on steps, so that the order of the
/// scheme shows undisturbed by where in a step the force sets in.
Flight aligned_bounce(const Report& report, const Scheme& scheme, int steps_of_contact) {
  const analytical::Bounce b = drop_of_a_metre();
  const double contact = b.contact_time(), before = 2.0 * contact, now = 5.0 * contact;
  Simulation simulation = report.simulate(scene_of(scheme, b.fall_time() - before, contact / steps_of_contact));
  const bool done = advance(simulation, 5 * steps_of_contact);
  const State s = state_of(simulation);
  if (!done || !(s.velocity > 0.0)) return {not_measured(), not_measured(), not_measured(), not_measured(), not_measured()};
  const double speed = std::sqrt(s.velocity * s.velocity + 2.0 * b.gravity * s.height);
  const double off = now - (speed - s.velocity) / b.gravity, back = now + (speed + s.velocity) / b.gravity;
  return {s.height, speed, off - before, back - before, simulation.max_penetration()};
}

/// The deepest point is that of a sample, off by a phase whose square counts, and of an amplitude that the scheme may change.
struct Depth {
  double order, slack;
  const char* why;
};
Depth depth_of(const Scheme& scheme) {
  if (scheme.weight == 0.5 || scheme.conserves) return {4.0, 0.2, "closed form; the amplitude is kept, the phase of order 2 counts with its square"};
  if (scheme.integrator == "tr_bdf2") return {3.0, 0.2, "closed form; it turns (u, v/w) as one and shrinks it, by order 3 over the contact"};
  return {2.0, 0.1, "closed form; order 2"};
}

/// [-] Of the error of the contact time, how much is due to the phase. A contact lasts pi + 2 e in phase, e = g/(w v0), from the height e above the
/// place of rest, over the amplitude, back to it. The period of D1 stretches the phase by a part of order W^2. The amplitude shrinks on the way by
/// (theta - 1/2) W/2 for each radian, and what is e of it then is met earlier by e times the part lost, of order W. Both have the same sign. The
/// slope of a sum of W and s W^2 lies between 1 and 1 + s at the largest W; terms left out are e times these, below a twentieth.
double share_of_phase(const analytical::Bounce& b, double theta, double dt) {
  const analytical::SpringStep step{theta, b.frequency, dt};
  const double e = b.gravity / (b.frequency * b.impact_speed());
  const double phase = M_PI * (analytical::period_ratio(step) - 1.0), amplitude = e * M_PI * (theta - 0.5) * step.phase() / 2.0;
  return phase / amplitude;
}

void orders(Report& report, const Scheme& scheme) {
  const analytical::Bounce b = drop_of_a_metre();
  const double exact_place = b.at(b.fall_time() + 3.0 * b.contact_time())[0];
  std::vector<double> coarse, fine, place, speed, contact, period, depth;
  for (const int n : {20, 40, 80, 160}) {
    const Flight f = aligned_bounce(report, scheme, n);
    coarse.push_back(b.contact_time() / n);
    speed.push_back(std::abs(f.speed - b.impact_speed()));
    depth.push_back(std::abs(f.depth - b.depth()));
  }
  for (const int n : {1280, 2560, 5120, 10240}) {
    const Flight f = aligned_bounce(report, scheme, n);
    fine.push_back(b.contact_time() / n);
    place.push_back(std::abs(f.place - exact_place));
    contact.push_back(std::abs(f.contact - b.contact_time()));
    period.push_back(std::abs(f.period - b.period()));
  }
  const auto row = [&](const char* name, const std::vector<double>& steps, const std::vector<double>& errors, double low, double high,
                       const char* source) { report.order(with_variant(name, scheme), scheme.contact, steps, errors, low, high, source); };
  const double o = scheme.order;
  row("place after a bounce", fine, place, o - 0.2, o + 0.2, "closed form; order of the scheme");
  row("period", fine, period, o - 0.2, o + 0.2, "closed form; order of the scheme");
  if (o == 1.0) {
    row("contact time", fine, contact, 0.95, 1.05 + share_of_phase(b, *scheme.weight, fine.front()),
        "closed form; amplitude lost, of order 1, and the phase of D1, of order 2, whose share of the coarsest error may add to the order");
    row("speed off the spring", coarse, speed, 0.9, 1.1, "closed form; spectral radius of D1: order 1");
    row("depth", coarse, depth, 0.9, 1.1, "closed form; order 1");
  } else {
    row("contact time", fine, contact, 1.9, 2.1, "closed form; order 2");
    if (scheme.conserves) {
      report.against(Reference::conservation)
          .near(with_variant("speed off the spring, largest error at 4 steps", scheme), scheme.contact, 0.0, largest(speed),
                residual_share * b.impact_speed(), "m/s", "no energy is lost, wherever in its step the contact ends; what a residual may leave");
    } else {
      const bool settles = scheme.contact == "dem";
      const double ends = settles ? 4.0 : 3.0;
      row("speed off the spring", coarse, speed, ends - 0.2, ends + 0.2,
          settles ? "closed form; the end leaves e of order 3, and what settles it e^2/(k D^2), D of order 1: order 4"
                  : "closed form; what a step on the spring or at its end does to the energy is of order 3");
    }
    const Depth d = depth_of(scheme);
    row("depth", coarse, depth, d.order - d.slack, d.order + d.slack, d.why);
  }
}

/// The theta family leaves the spring as the matrices of D1 say, step by step.
void matrices(Report& report, const Scheme& scheme) {
  const analytical::Bounce b = drop_of_a_metre();
  for (const int n : {10, 40}) {
    const double dt = b.contact_time() / n;
    const auto expected = analytical::stepped_rebound(b, *scheme.weight, dt);
    Simulation simulation = report.simulate(scene_of(scheme, b.fall_time() - n * dt, dt));
    const State s = advance(simulation, n + expected.steps) ? state_of(simulation) : State{not_measured(), not_measured()};
    const std::string name = with_variant("off the spring, contact time / dt = " + text("{}", n), scheme);
    report.relative(name + ": velocity", scheme.contact, expected.velocity, s.velocity, 1e-10, "m/s", "matrix of D1 until y > 0; rounding of gaps");
    report.near(name + ": height", scheme.contact, expected.height, s.height, 1e-12, "m", "matrix of D1 until y > 0; rounding of coordinates");
  }
}

double energy(Simulation& simulation) {
  const State s = state_of(simulation);
  return 0.5 * s.velocity * s.velocity + drop_of_a_metre().gravity * s.height;
}

/// Newmark (1/2, 1) keeps rho^2 of the energy in each step on the spring, whose number is the contact time over dt to one step; the energy of place
/// at the touch, g^2/w^2, is not part of what decays: (g/(w v0))^2, and couples to it by g/(w v0).
void decay(Report& report, const Scheme& scheme) {
  const analytical::Bounce b = drop_of_a_metre();
  const int n = 200, bounces = 5;
  const double dt = b.contact_time() / n;
  Simulation simulation = report.simulate(scene_of(scheme, 0.0, dt));
  const double before = energy(simulation);
  const bool done = advance(simulation, static_cast<int>((b.fall_time() + (bounces - 0.5) * b.period()) / dt));
  const double kept = done ? std::log(energy(simulation) / before) : not_measured();
  const double expected = 2.0 * n * bounces * std::log(analytical::spectral_radius({*scheme.weight, b.frequency, dt}));
  report.relative(with_variant("log of the energy kept after 5 bounces", scheme), scheme.contact, expected, kept,
                  1.0 / n + 2.0 * b.gravity / (b.frequency * b.impact_speed()), "-", "spectral radius of D1; one step a contact, and g/(w v0)");
}

/// Where in their steps contacts begin and end is random: a touch costs, an end brings K v0^2 dt^2 f (1 - f)/2 with the part f of the step, f in (0,
/// 1). The sum over many bounces is a random walk of steps of second order. Several starts for a mean, at different parts of a step.
///
/// The root mean square of N numbers is known to 1/sqrt(2 N), a quarter for 8 of them; the slope of its logarithm over n halvings then to that over
/// ln(2) sqrt(n (n + 1)(n + 2)/12), 0.16 over three. Three times this standard deviation is allowed.
void drift(Report& report, const Scheme& scheme) {
  const analytical::Bounce b = drop_of_a_metre();
  constexpr int bounces = 12;
  std::vector<double> steps, drifts;
  for (const double dt : {2e-3, 1e-3, 5e-4, 2.5e-4}) {
    double sum = 0.0;
    constexpr int starts = 8;
    constexpr double golden_section = 0.6180339887;  // spreads the parts evenly
    for (int i = 0; i < starts; ++i) {
      Simulation simulation = report.simulate(scene_of(scheme, golden_section * i * dt, dt));
      const double before = energy(simulation);
      const bool done = advance(simulation, static_cast<int>((bounces * b.period()) / dt));
      sum += done && simulation.max_penetration() > 0.0 ? std::pow(energy(simulation) / before - 1.0, 2) : not_measured();
    }
    steps.push_back(dt);
    drifts.push_back(std::sqrt(sum / starts));
  }
  if (scheme.conserves) {
    report.against(Reference::conservation)
        .near(with_variant("energy after 12 bounces, root mean square of 8 starts, largest at 4 steps", scheme), scheme.contact, 0.0, largest(drifts),
              bounces * 2.0 * residual_share, "-", "no energy is lost; what a residual may leave in each bounce");
    return;
  }
  report.order(with_variant("energy after 12 bounces, root mean square of 8 starts", scheme), scheme.contact, steps, drifts, 2.0 - 3.0 * 0.16,
               2.0 + 3.0 * 0.16, "order 2; the size of a random walk is known to a quarter from 8 of them, the slope over three halvings to 0.2");
}

/// Rigid contact does not rebound. Of the way of mid-step velocities the first half step lacks g dt^2/8.
void plastic(Report& report) {
  const analytical::Bounce b = drop_of_a_metre();
  std::vector<double> steps, errors;
  const double weight = level_block().weight();
  for (const double dt : {4e-3, 2e-3, 1e-3}) {
    Simulation simulation = report.simulate(scene_of(scheme_named("hard"), 0.0, dt));
    const bool done = advance(simulation, static_cast<int>(std::ceil((b.fall_time() + 0.05) / dt)));
    const double lost = done ? simulation.ledger().impact : not_measured();
    report.relative(text("energy of the impact, dt = {} s", dt), "hard", weight * (b.drop - b.gravity * dt * dt / 8.0), lost, 1e-10, "J",
                    "all that was fallen, W (H - g dt^2/8)");
    steps.push_back(dt);
    errors.push_back(std::abs(lost - weight * b.drop));
    const State s = state_of(simulation);
    report.near(text("velocity after the impact over the one before, dt = {} s", dt), "hard", 0.0,
                done && simulation.ledger().impact > 0.0 ? std::abs(s.velocity) / b.impact_speed() : not_measured(), 1e-11, "-", "restitution 0");
  }
  Simulation simulation = report.simulate(scene_of(scheme_named("hard"), 0.0, 1e-3));
  const bool done = advance(simulation, 500);
  check_ledger(report, "fall and impact", "hard", simulation, done);
  report.order("energy of the impact", "hard", steps, errors, 1.99, 2.01, "W H; order 2");
  report.leave_out("contact time, depth, period, drift", "hard", "rigid contacts do not rebound");
}

void bounce(Report& report) {
  for (const Scheme& scheme : spring_schemes()) {
    orders(report, scheme);
    if (scheme.order == 1.0) decay(report, scheme);
    if (scheme.order == 2.0) drift(report, scheme);
    if (scheme.weight) matrices(report, scheme);
    Simulation simulation = report.simulate(scene_of(scheme, 0.0, 1e-3));
    const bool done = advance(simulation, 3000);
    check_ledger(report, with_variant("three bounces", scheme), scheme.contact, simulation, done);
  }
  report.leave_out("off the spring", "dem", "not of the theta family; its order is checked");
  for (const Scheme& s : spring_schemes()) {
    if (!s.integrator.empty() && !s.weight)
      report.leave_out(with_variant("off the spring", s), s.contact, "not of the theta family; its matrix is checked in D1i");
  }
  plastic(report);
}

const Registered<Case> registered{{"D2", "bounce on a contact", &bounce}};

}  // namespace
}  // namespace openclose::verification
