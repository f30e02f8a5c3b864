// C1: a rectangular pulse of the base under a block on a level plane (Newmark's sliding block).
#include <cmath>

#include "harness.h"
#include "openclose/analytical/newmark_block.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double gravity = 9.81;  // [m/s2]
constexpr double part = 0.4;      // pulse over g
constexpr double friction = 0.1;  // yield over g
constexpr double pulse = part * gravity;
constexpr double duration = 0.5;  // [s]

analytical::BlockOnPlane level_block() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = std::atan(friction);
  return data;
}

Scene scene_of(const std::string& method, const analytical::BlockOnPlane& data, double dt, double end) {
  Scene scene = block_on_plane(data);
  scene.method.contact = method;
  scene.method.start = Start::normal_balanced;
  scene.step.dt = dt;
  scene.end_time = end;
  scene.output_every = end;
  // To the left: the block moves on to the right.
  scene.base_motion.emplace();
  scene.base_motion->pulses = {{0.0, duration, {-pulse, 0.0}}};
  use_joint_springs_as_penalty(scene);
  return scene;
}

double place(const Report& report, const Scene& scene, const analytical::BlockOnPlane& data) {
  Simulation simulation = report.simulate(scene);
  return downhill_history(simulation, data, 2).back();
}

/// Rigid contact: velocities are exact, places the sum of mid-step velocities. Where both ends of the pulse and the stop fall on steps that is the
/// distance; else a bend in the velocity by a, a part f < 1/2 of a step after its start, costs a (f dt)^2/2, and the stop half-way through a step
/// N g dt^2/8.
void rigid(Report& report) {
  const analytical::BlockOnPlane data = level_block();
  const auto expected = analytical::pulse_slip(data, pulse, duration);
  for (const double dt : {1e-2, 1e-3}) {
    const double slid = place(report, scene_of("hard", data, dt, 2.5), data);
    report.near(text("distance, pulse and stop at whole steps, dt = {} s", dt), "hard", expected.distance, slid, 1e-10, "m",
                "V^2/(2 g N) (1 - N/A); velocities and places exact, rounding of 1e3 steps");
  }
  std::vector<double> steps, errors;
  for (const double n : {40.0, 80.0, 160.0, 320.0}) {
    // The pulse ends an eighth into a step, the stop half-way.
    const double dt = expected.stop_time / (n + 0.5);
    const double slid = place(report, scene_of("hard", data, dt, 2.5), data);
    steps.push_back(dt);
    errors.push_back(std::abs(slid - expected.distance));
    if (n > 40.0) continue;
    report.relative("error when they fall within steps, over g dt^2", "hard", part / 128.0 - friction / 8.0,
                    (slid - expected.distance) / (gravity * dt * dt), 1e-6, "-", "A/128 - N/8: a bend by A an eighth, a stop half-way into a step");
  }
  report.order("distance, pulse and stop within steps", "hard", steps, errors, 1.98, 2.02, "V^2/(2 g N) (1 - N/A); order 2");

  Simulation simulation = report.simulate(scene_of("hard", data, 1e-2, 0.25));
  const auto samples = history(simulation);
  report.relative("velocity at half the pulse", "hard", (part - friction) * gravity * 0.25,
                  samples.empty() ? not_measured() : samples.back().motion.velocity.x(), 1e-11, "m/s", "momentum: (A - N) g t");
}

/// Springs against the ODE on the shaken plane, in mid-slip; the sudden pull sets them swinging.
void elastic(Report& report) {
  const analytical::BlockOnPlane data = level_block();
  constexpr double end = 0.8;
  analytical::SlidingBlockReference reference(data, analytical::normal_balanced_start(data));
  const double exact = reference.follow(analytical::rectangular_pulse(-pulse, duration), {end}).back().x;
  for (const Scheme& s : spring_schemes()) {
    std::vector<double> steps, errors;
    for (const double n : {1600.0, 3200.0, 6400.0, 12800.0, 25600.0}) {
      Scene scene = scene_of(s.contact, data, end / n, end);
      set_scheme(scene, s);
      steps.push_back(end / n);
      errors.push_back(std::abs(place(report, scene, data) - exact));
    }
    // The place of a change between sticking and sliding within its step is a random factor of a second-order error.
    const double slack = s.order == 2.0 ? 0.4 : 0.2;
    report.against(Reference::ode)
        .order(with_variant("place in mid-slip", s), s.contact, steps, errors, s.order - slack, s.order + slack,
               "SUNDIALS ODE on the shaken plane; order of the scheme");
  }
}

/// A sudden pull finds slack springs: the block gains speed a/w before friction is there, so that rigid contact is reached as ks^(-1/2).
void stiffness(Report& report) {
  std::vector<double> stiffnesses, errors;
  for (const double k : {5e7, 5e8, 5e9, 5e10}) {
    analytical::BlockOnPlane data = level_block();
    data.normal_stiffness = data.shear_stiffness = k;
    Scene scene = scene_of("soft", data, 0.0, 1.5);
    scene.step.dt = 1.5 / std::ceil(1.5 / (0.05 / std::sqrt(2.0 * k / data.mass())));
    scene.method.theta = 0.5;
    scene.blocks[1].rotation_locked = true;
    // Slid in the pulse and since: (A - N) g T^2/2 + (A - N) g T t - N g t^2/2.
    const double t = 1.0, speed = (part - friction) * gravity * duration;
    const double rigid_place = 0.5 * speed * duration + speed * t - 0.5 * friction * gravity * t * t;
    stiffnesses.push_back(k);
    errors.push_back(std::abs(place(report, scene, data) - rigid_place));
  }
  report.order("distance from the rigid block over the stiffness", "soft", stiffnesses, errors, -0.6, -0.4,
               "speed won on slack springs, mu g/w: order -1/2", stiffness_name);
}

void pulse_under_block(Report& report) {
  rigid(report);
  elastic(report);
  stiffness(report);
  for (const std::string& method : all_methods) {
    Simulation simulation = report.simulate(scene_of(method, level_block(), 1e-3, 2.5));
    const bool done = !history(simulation).empty();
    check_ledger(report, "pulse", method, simulation, done);
  }
}

const Registered<Case> registered{{"C1", "block on a base with a rectangular pulse", &pulse_under_block}};

}  // namespace
}  // namespace openclose::verification
