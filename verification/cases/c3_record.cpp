// C3: an incline shaken by a record with its vertical component. The scene and its records are files; the reference makes the records
// anew.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/newmark_block.h"
#include "openclose/analytical/sliding_block_reference.h"
#include "openclose/scene/reader.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double whole = 5.0, every = 0.05;  // [s]

/// What shaken_block.toml says.
analytical::BlockOnPlane data_of_scene() {
  analytical::BlockOnPlane data;
  data.slope_angle = 10.0 * analytical::degree;
  data.friction_angle = 20.0 * analytical::degree;
  return data;
}

Scene scene_of(const std::string& method, double dt, double end) {
  Scene scene = read_scene(OPENCLOSE_VERIFICATION_SCENES "/shaken_block.toml");
  scene.method.contact = method;
  scene.method.gap_tolerance = empty_scene().method.gap_tolerance;  // as those built in memory
  scene.step.dt = dt;
  scene.end_time = end;
  scene.output_every = every;
  use_joint_springs_as_penalty(scene);
  return scene;
}

/// The numbers of the files have six decimals.
analytical::GroundMotion ground() {
  constexpr double dt = 0.01;
  auto horizontal = analytical::synthetic_record(1, 5.0, 5.0, dt), vertical = analytical::synthetic_record(2, 2.5, 5.0, dt);
  std::vector<double> times;
  for (std::size_t i = 0; i < horizontal.size(); ++i) {
    times.push_back(dt * static_cast<double>(i));
    for (double* a : {&horizontal[i], &vertical[i]}) *a = 1e-6 * std::round(1e6 * *a);
  }
  return analytical::record_motion(times, horizontal, vertical);
}

std::vector<double> output_times(double end) {
  std::vector<double> times;
  for (int i = 0; i <= std::lround(end / every); ++i) times.push_back(i * every);
  return times;
}

std::vector<double> places(const Report& report, const Scene& scene) {
  Simulation simulation = report.simulate(scene);
  return downhill_history(simulation, data_of_scene(), output_times(scene.end_time).size());
}

void rigid(Report& report) {
  std::vector<double> exact;
  const auto motion = analytical::newmark_block(data_of_scene(), ground(), output_times(whole));
  for (const auto& s : motion.states) exact.push_back(s.x);
  std::vector<double> steps, errors;
  for (const double dt : {2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4}) {
    steps.push_back(dt);
    errors.push_back(largest_difference(places(report, scene_of("hard", dt, whole)), exact));
  }
  report.against(Reference::ode)
      .order(text("largest distance from Newmark's block over 5 s, {} slips and stops", static_cast<double>(motion.events.size())), "hard", steps,
             errors, 1.6, 2.4, "CVODE with events; order 2, where in their steps slips begin and end is a random factor");
}

void elastic(Report& report) {
  const analytical::BlockOnPlane data = data_of_scene();
  analytical::SlidingBlockReference reference(data, analytical::normal_balanced_start(data));
  std::vector<double> exact;
  for (const auto& s : reference.follow(ground(), output_times(whole))) exact.push_back(s.x);
  // Newmark (1/2, 1) damps the swings between two slips by exp(-w^2 dt t/4), the reference not at all: the first second, with its slips and stops,
  // shows its order at steps for which that is little.
  for (const Scheme& s : spring_schemes()) {
    if (s.contact == "shi") continue;  // see below
    const double end = s.order == 1.0 ? 1.0 : whole, first_dt = s.order == 1.0 ? 4e-5 : 1e-3;
    std::vector<double> steps, errors;
    for (const double refinement : {1.0, 2.0, 4.0, 8.0}) {
      Scene scene = scene_of(s.contact, first_dt / refinement, end);
      set_scheme(scene, s);
      scene.method.start = Start::normal_balanced;
      steps.push_back(scene.step.dt);
      errors.push_back(largest_difference(places(report, scene), exact));
    }
    const double slack = s.order == 2.0 ? 0.4 : 0.2;
    report.against(Reference::ode)
        .order(with_variant(text("largest distance from the ODE over {} s", end), s), s.contact, steps, errors, s.order - slack, s.order + slack,
               "SUNDIALS ODE on the shaken plane; order of the scheme");
  }
}

/// Its steps among themselves: the difference of two that follow each other.
void own_limit(Report& report) {
  report.leave_out(
      "largest distance from the ODE", "shi",
      "where the normal force changes the reference may stick while it slips one way; a sliding contact of shi carries mu N until its slip "
      "turns back, so it converges on another motion, 0.2 mm away");
  std::vector<double> steps, differences, coarser;
  for (const double dt : {4e-5, 2e-5, 1e-5, 5e-6}) {
    Scene scene = scene_of("shi", dt, 1.0);
    scene.method.start = Start::normal_balanced;
    std::vector<double> now = places(report, scene);
    if (!coarser.empty()) {
      steps.push_back(dt);
      differences.push_back(largest_difference(now, coarser));
    }
    coarser = std::move(now);
  }
  report.against(Reference::other_run)
      .order("largest difference of a step and its half over 1 s", "shi", steps, differences, 0.8, 1.2,
             "converges within itself with the order of the scheme");
}

void recorded_motion(Report& report) {
  rigid(report);
  elastic(report);
  own_limit(report);
  for (const std::string& method : all_methods) {
    Simulation simulation = report.simulate(scene_of(method, 1e-3, whole));
    check_ledger(report, "record", method, simulation, !history(simulation).empty());
  }
}

const Registered<Case> registered{{"C3", "block on an incline under a record", &recorded_motion}};

}  // namespace
}  // namespace openclose::verification
