// B10: a block on the level, held by a spring against friction, on which a load comes at once: the swing about the spring's new length loses 2 mu N/k
// in each half cycle and ends where the spring no longer overcomes friction.
#include <cmath>
#include <numbers>

#include "harness.h"
#include "openclose/analytical/coulomb_oscillator.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double spring = 1e6;  // [N/m]
constexpr double load = 1e5;    // [N]
constexpr double rest_s = 0.1;  // [s] after the stop, so that one that comes late is seen at rest, too

analytical::BlockOnPlane block_on_level() {
  analytical::BlockOnPlane data;
  data.slope_angle = 0.0;
  data.friction_angle = std::atan(0.2);
  return data;
}

/// The load shifts the spring's rest by load/k: the swing is the one released from there.
analytical::CoulombRest expected() {
  const analytical::BlockOnPlane data = block_on_level();
  return analytical::coulomb_oscillator({data.mass(), spring, data.friction() * data.weight(), load / spring});
}

/// \param steps  of the whole run
Scene scene_of(const analytical::BlockOnPlane& data, const std::string& method, int steps) {
  Scene scene = block_on_plane(data);
  scene.method.contact = method;
  scene.method.start = Start::normal_balanced;
  scene.blocks[1].rotation_locked = true;
  const Vec2 centre(0.5 * data.width, 0.5 * data.height);
  scene.supports = {{1, centre, {spring, 0.0}}};
  scene.loads = {{1, centre, {load, 0.0}}};
  scene.end_time = scene.output_every = expected().time + rest_s;
  scene.step.dt = scene.end_time / steps;
  use_joint_springs_as_penalty(scene);
  return scene;
}

double place(const Report& report, const Scene& scene, const analytical::BlockOnPlane& data) {
  Simulation simulation = report.simulate(scene);
  return downhill_history(simulation, data, 2).back();
}

void rigid(Report& report) {
  const analytical::BlockOnPlane data = block_on_level();
  const analytical::CoulombRest exact = expected();
  std::vector<double> steps, errors;
  for (const int n : {1250, 2500, 5000, 10000}) {
    const Scene scene = scene_of(data, "hard", n);
    steps.push_back(scene.step.dt);
    errors.push_back(std::abs(place(report, scene, data) - (load / spring - exact.place)));
  }
  report.order("place of rest", "hard", steps, errors, 0.8, 1.2,
               "five half cycles lose 2 mu N/k each; the spring's force of the step's end: order 1");

  // Half a cycle ends in the step in which the velocity passes zero: the five of them are over within as many steps of the exact time.
  const Scene scene = scene_of(data, "hard", 10000);
  const double dt = scene.step.dt;
  Simulation simulation = report.simulate(scene);
  double stopped = not_measured();
  for (int i = 1; i < 10000; ++i) {
    if (!simulation.advance(dt)) break;
    const double speed = std::abs(simulation.velocity(1)[0]);
    if (speed > 1e-9)
      stopped = not_measured();
    else if (std::isnan(stopped))
      stopped = i * dt;
  }
  report.near("time of rest", "hard", exact.time, stopped, exact.half_cycles * dt, "s", "five half periods; a step each");
}

/// The shear springs of the contact hold beside the spring while it sticks: they let go a little later and hold a little earlier, and swing about the
/// place of the stop with mu N/(2 ks).
void elastic(Report& report) {
  std::vector<double> compliance, errors;
  for (const double factor : {4.0, 16.0, 64.0}) {
    analytical::BlockOnPlane data = block_on_level();
    data.normal_stiffness *= factor;
    data.shear_stiffness *= factor;
    const analytical::CoulombRest exact = expected();
    Scene scene = scene_of(data, "soft", 60000);
    scene.method.integrator = "path_average";
    compliance.push_back(1.0 / data.shear_stiffness);
    errors.push_back(std::abs(place(report, scene, data) - (load / spring - exact.place)));
  }
  report.order("place of rest, distance from the rigid block over compliance", "soft", compliance, errors, 0.7, 1.3,
               "mu N/(2 ks) at each of five turns; the swing after the stop is met at a random phase", compliance_name);
}

void ledgers(Report& report) {
  const analytical::BlockOnPlane data = block_on_level();
  for (const Scheme& scheme : schemes()) {
    Scene scene = scene_of(data, scheme.contact, 1250);
    set_scheme(scene, scheme);
    Simulation simulation = report.simulate(scene);
    check_ledger(report, with_variant("five half cycles", scheme), scheme.contact, simulation, !history(simulation).empty());
  }
}

void coulomb_oscillator(Report& report) {
  rigid(report);
  elastic(report);
  ledgers(report);
}

const Registered<Case> registered{{"B10", "a spring against friction", &coulomb_oscillator}};

}  // namespace
}  // namespace openclose::verification
