// B7: a block on a plane between its residual and its peak friction angle: it rests for good, slides for good once it has slipped, and its factor of
// safety counts what the first corner loses; all that at the first slip, or over a slip-weakening distance.
#include <algorithm>
#include <cmath>

#include "harness.h"
#include "openclose/analytical/residual_friction.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double residual_angle = 20.0 * analytical::degree;  // [rad] the plane falls by 30 degrees
constexpr double speed = 1.0;                                 // [m/s]

analytical::BlockOnPlane strong_block(double peak_angle = 40.0) {
  analytical::BlockOnPlane data;
  data.friction_angle = peak_angle * analytical::degree;
  return data;
}

Scene softening_block(const analytical::BlockOnPlane& data, double residual) {
  Scene scene = block_on_plane(data);
  scene.joints[0].residual_friction_angle = residual;
  use_joint_springs_as_penalty(scene);
  return scene;
}

Scene thrown_block(const analytical::BlockOnPlane& data, const Scheme& scheme, double dt, double end) {
  Scene scene = softening_block(data, residual_angle);
  set_scheme(scene, scheme);
  scene.method.start = Start::normal_balanced;
  scene.blocks[1].rotation_locked = true;
  scene.blocks[1].velocity = speed * Vec2(std::cos(data.slope_angle), -std::sin(data.slope_angle));
  scene.step.dt = dt;
  scene.end_time = end;
  scene.output_every = end;
  return scene;
}

double carried(const Simulation& simulation) {
  double sum = 0.0;
  for (const Contact& c : simulation.contacts()) sum += c.normal_force;
  return sum;
}

void rest(Report& report) {
  const analytical::BlockOnPlane data = strong_block();
  for (const std::string& method : all_methods) {
    Scene scene = softening_block(data, residual_angle);
    scene.method.contact = method;
    scene.method.start = Start::settled;
    scene.step.dt = 1e-3;
    scene.end_time = 5.0;
    scene.output_every = 0.5;
    Simulation simulation = report.simulate(scene);
    double worst = 0.0;
    const auto samples = history(simulation);
    for (const Sample& s : samples) {
      if (s.time >= 0.5) worst = larger(worst, (s.motion.displacement - samples[1].motion.displacement).norm());
    }
    const bool carries = !samples.empty() && std::abs(carried(simulation) / data.normal_weight() - 1.0) < 1e-3;
    // What settling leaves unbalanced vibrates on with `dem`, as in case B2.
    const double vibration = method == "dem" ? 2.0 * scene.settle.unbalanced_fraction * data.weight() / (2.0 * data.normal_stiffness) : 0.0;
    report.near("at rest on a plane below the peak angle: way in 4.5 s", method, 0.0, carries ? worst : not_measured(), 1e-12 + vibration, "m",
                "static equilibrium; no contact slips");
  }
}

/// The bond breaks at the end of the step in which the block slips: up to there it has the peak friction, which costs at most the difference of the
/// accelerations in that step and in the one in which it begins.
void release(Report& report) {
  const analytical::BlockOnPlane data = strong_block();
  const double dt = 1e-4, end = 1.0;
  const double difference = data.gravity * (data.friction() - std::tan(residual_angle)) * std::cos(data.slope_angle);
  for (const Scheme& scheme : schemes()) {
    const auto slide = scheme.contact == "hard" ? analytical::released_rigid_slide(data, residual_angle, speed)
                                                : analytical::released_slide(data, residual_angle, speed);
    const Scene scene = thrown_block(data, scheme, dt, end);
    Simulation simulation = report.simulate(scene);
    const auto samples = history(simulation);
    const double place = samples.empty() ? not_measured() : downhill(data, samples.back().motion.displacement);
    report.near(with_variant("thrown down the plane: place after 1 s", scheme), scheme.contact, slide.displacement(end), place,
                2.0 * difference * dt * end, "m", "residual acceleration from the first slip on; two steps late at most");
    check_ledger(report, with_variant("thrown down the plane", scheme), scheme.contact, simulation, !samples.empty());
  }
}

/// The strength of a step is that of the slip before it, two steps late at most as with the bond.
void weaken(Report& report) {
  const analytical::BlockOnPlane data = strong_block();
  const double dt = 1e-4, end = 1.0, distance = 0.1;
  for (const Scheme& scheme : schemes()) {
    const auto first = scheme.contact == "hard" ? analytical::released_rigid_slide(data, residual_angle, speed)
                                                : analytical::released_slide(data, residual_angle, speed);
    const auto slide = analytical::weakened_slide(data, residual_angle, distance, first);
    Scene scene = thrown_block(data, scheme, dt, end);
    scene.joints[0].slip_weakening_distance = distance;
    Simulation simulation = report.simulate(scene);
    const auto samples = history(simulation);
    const double place = samples.empty() ? not_measured() : downhill(data, samples.back().motion.displacement);
    report.near(with_variant("thrown down the plane, friction falls over 0.1 m: place after 1 s", scheme), scheme.contact, slide.displacement(end),
                place, analytical::cost_of_late_weakening(data, residual_angle, distance, first, 2.0 * dt, end), "m",
                "linear slip weakening: hyperbolic functions up to the distance, then the residual acceleration; two steps late at most");
    check_ledger(report, with_variant("thrown down the plane, friction falls over 0.1 m", scheme), scheme.contact, simulation, !samples.empty());
  }
}

/// Adaptive steps lose at most a fiftieth of the drop each, as the handbook says: two of them lack what goes with a slip of 2 D/50. The bound has
/// this slip at the speed of the throw and more of it later on.
void weaken_adaptively(Report& report) {
  const analytical::BlockOnPlane data = strong_block();
  const double end = 1.0, distance = 0.1, longest = 0.02 * distance / speed;
  const auto first = analytical::released_slide(data, residual_angle, speed);
  const auto slide = analytical::weakened_slide(data, residual_angle, distance, first);
  Scheme soft;
  soft.contact = "soft";
  Scene scene = thrown_block(data, soft, 0.02, end);
  scene.step.adaptive = true;
  scene.joints[0].slip_weakening_distance = distance;
  Simulation simulation = report.simulate(scene);
  const auto samples = history(simulation);
  const double place = samples.empty() ? not_measured() : downhill(data, samples.back().motion.displacement);
  report.near("thrown down the plane, friction falls over 0.1 m, adaptive steps: place after 1 s", "soft", slide.displacement(end), place,
              analytical::cost_of_late_weakening(data, residual_angle, distance, first, 2.0 * longest, end), "m",
              "linear slip weakening; two steps late at most, in each of which no joint loses more than 2 % of its drop");
}

void factor(Report& report) {
  const analytical::BlockOnPlane data = strong_block(45.0);
  for (const double residual : {40.0, 5.0}) {
    const double expected = analytical::residual_strength_factor(data, residual * analytical::degree);
    for (const std::string& method : all_methods) {
      Scene scene = softening_block(data, residual * analytical::degree);
      scene.method.contact = method;
      if (method == "dem") {
        constexpr double width = 1e-4;
        report.between(text("factor of safety, residual angle {} deg", residual), method, (1.0 - width) * analytical::first_slip_factor(data),
                       (1.0 + width) * expected, strength_reduction_factor(report, scene), "-",
                       "from the first slip, 2 mu N_u/T, to what both corners carry after it: on the way there the corners share by how they swing");
        continue;
      }
      report.relative(text("factor of safety, residual angle {} deg", residual), method, expected, strength_reduction_factor(report, scene), 1e-4,
                      "-", "max(2 mu N_u, mu_r N_u + mu N_l)/T; width of the bracket");
    }
  }
}

/// Of rigid contacts, too: at rest only the ratios of their forces are undetermined, and these the joint's springs decide.
void weakened_factor(Report& report) {
  const analytical::BlockOnPlane data = strong_block(45.0);
  const double residual = 5.0 * analytical::degree, distance = 2e-3, width = 1e-4;
  const double expected = analytical::weakened_strength_factor(data, residual, distance);
  for (const std::string& method : all_methods) {
    Scene scene = softening_block(data, residual);
    scene.joints[0].slip_weakening_distance = distance;
    scene.method.contact = method;
    const double found = strength_reduction_factor(report, scene);
    const std::string what = "factor of safety, residual angle 5 deg over 2 mm";
    if (method == "dem") {
      report.between(what, method, (1.0 - width) * analytical::residual_strength_factor(data, residual), (1.0 + width) * expected, found, "-",
                     "from that of an angle that falls at once to what both corners carry together: the corners share by how they swing");
    } else {
      report.relative(what, method, expected, found, width, "-",
                      "the upper corner weakens along its slip while the lower one's spring is loaded; width of the bracket");
    }
  }
}

void residual_friction(Report& report) {
  rest(report);
  release(report);
  weaken(report);
  weaken_adaptively(report);
  factor(report);
  weakened_factor(report);
}

const Registered<Case> registered{{"B7", "peak and residual friction", &residual_friction}};

}  // namespace
}  // namespace openclose::verification
