// B6: tractions that move and turn with their block: on the top of a block that slides down a plane, and on one end of a free block, which they turn.
#include <algorithm>
#include <cmath>

#include "harness.h"
#include "openclose/analytical/follower_traction.h"
#include "openclose/core/vector.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double pressure = 20e3;  // [Pa]
constexpr double shear = -3e3;     // [Pa] down the plane: the top's outline runs uphill

Scene loaded_block(const analytical::BlockOnPlane& data) {
  Scene scene = block_on_plane(data);
  const auto& corners = scene.blocks[1].vertices;
  scene.surcharges = {{1, corners[2], corners[3], pressure, shear}};
  return scene;
}

/// m x'' = W sin alpha + (-s) b - mu (W cos alpha + p b).
double loaded_acceleration(const analytical::BlockOnPlane& data) {
  const double driving = data.weight() * std::sin(data.slope_angle) - shear * data.width;
  return (driving - data.friction() * (data.normal_weight() + pressure * data.width)) / data.mass();
}

void sliding(Report& report) {
  const analytical::BlockOnPlane data;
  const double acceleration = loaded_acceleration(data);
  for (const std::string& method : all_methods) {
    for (const bool locked : {true, false}) {
      if (!locked && method != "hard") continue;
      Scene scene = loaded_block(data);
      scene.blocks[1].rotation_locked = locked;
      scene.method.contact = method;
      scene.method.start = Start::steady_sliding;
      scene.step.dt = 1e-3;
      scene.end_time = 2.0;
      scene.output_every = 0.1;
      use_joint_springs_as_penalty(scene);
      Simulation simulation = report.simulate(scene);
      double worst = 0.0;
      const auto samples = history(simulation);
      for (const Sample& s : samples) {
        if (s.time < 0.5) continue;
        worst = larger(worst, std::abs(downhill(data, s.motion.displacement) / (0.5 * acceleration * s.time * s.time) - 1.0));
      }
      report.near(std::string("sliding with a traction on its top") + (locked ? ", rotation locked" : ""), method, 0.0,
                  samples.empty() ? not_measured() : worst, 1e-10, "-", "m x'' = W sin alpha - s b - mu (W cos alpha + p b); constant forces");
    }
    if (method != "hard") report.leave_out("sliding with a traction on its top", method, "springs tilt the block, and the traction with it");
  }
}

void factor(Report& report) {
  analytical::BlockOnPlane data;
  data.friction_angle = 45.0 * analytical::degree;
  const double driving = data.weight() * std::sin(data.slope_angle) - shear * data.width;
  const double expected = data.friction() * (data.normal_weight() + pressure * data.width) / driving;
  for (const std::string& method : all_methods) {
    Scene scene = loaded_block(data);
    scene.method.contact = method;
    report.relative("factor of safety with a traction on its top", method, expected, strength_reduction_factor(report, scene), 1e-4, "-",
                    "mu (W cos alpha + p b)/(W sin alpha - s b); width of the bracket");
  }
}

/// A block of 2 m x 1 m, pushed on the right half of its underside.
Scene turned_block() {
  Scene scene = empty_scene();
  scene.gravity = Vec2::Zero();
  scene.blocks = {free_block("pushed", rectangle(0.0, 0.0, 2.0, 1.0))};
  scene.surcharges = {{0, {1.0, 0.0}, {2.0, 0.0}, 4e3, 1e3}};
  scene.end_time = 1.0;
  scene.output_every = 1.0;
  return scene;
}

analytical::FollowerTraction turned_reference() {
  const analytical::BlockOnPlane data;
  // Shear along the underside, half a metre below the centroid; pressure half a metre beside it.
  return {data.mass(), data.moment_of_inertia(), {1e3, 4e3}, 0.5 * 4e3 + 0.5 * 1e3};
}

void turning(Report& report) {
  const analytical::FollowerTraction reference = turned_reference();
  const auto place = analytical::pushed_displacement(reference, 1.0);
  const double angle = analytical::turned_angle(reference, 1.0);
  for (const Scheme& scheme : schemes()) {
    std::vector<double> steps, errors;
    for (const double dt : {0.02, 0.01, 0.005, 0.0025}) {
      Scene scene = turned_block();
      set_scheme(scene, scheme);
      scene.step.dt = dt;
      Simulation simulation = report.simulate(scene);
      const auto samples = history(simulation);
      const bool done = !samples.empty();
      steps.push_back(dt);
      errors.push_back(done ? (samples.back().motion.displacement - Vec2(place[0], place[1])).norm() : not_measured());
      if (dt != 0.01) continue;
      const double turned = done ? Motion::rotation(simulation.system().displacement(0)) : not_measured();
      report.relative(with_variant("a free block with a traction on one end: turned after 1 s", scheme), scheme.contact, angle, turned, 1e-10, "rad",
                      "M t^2/(2 I): the moment of a traction that turns with its block is constant");
      check_ledger(report, with_variant("a free block with a traction on one end", scheme), scheme.contact, simulation, done);
    }
    report.order(with_variant("a free block with a traction on one end: place after 1 s", scheme), scheme.contact, steps, errors, scheme.order - 0.2,
                 scheme.order + 0.2, "Fresnel integrals; order of the scheme");
  }
}

void surcharge(Report& report) {
  sliding(report);
  factor(report);
  turning(report);
}

const Registered<Case> registered{{"B6", "surcharges that follow their block", &surcharge}};

}  // namespace
}  // namespace openclose::verification
