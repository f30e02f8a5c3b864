// E6c, the other mechanism of E6: a block slides down a plane of two fixed blocks, and its front corner stands on the joint between them: three
// blocks meet in one corner, and air. This is so wherever joints cross in the face of a slope, and at its toe. A contact of the front corner with the
// joint's wall below, or of the wall's corner with the block's front, would lock the block; it slides as eq. (8) says.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/incline.h"
#include "openclose/analytical/two_spring_block.h"
#include "openclose/core/tolerance.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double duration = 0.5;  // [s]

/// Angles from the plane, uphill: of the joint below it and of the block's front above.
Scene block_over_joint(const analytical::BlockOnPlane& data, double joint_angle, double front_angle) {
  Scene scene = empty_scene(data);
  const auto place = [&](double along, double above) { return on_slope(data.slope_angle, along, above); };
  const double joint_lean = 1.0 / std::tan(joint_angle), front_lean = data.height / std::tan(front_angle);
  scene.blocks = {fixed_block("base up", {place(-8.0, 0.0), place(-8.0, -1.0), place(-joint_lean, -1.0), place(0.0, 0.0)}),
                  fixed_block("base down", {place(0.0, 0.0), place(-joint_lean, -1.0), place(8.0, -1.0), place(8.0, 0.0)}),
                  free_block("block", {place(-data.width, 0.0), place(0.0, 0.0), place(front_lean, data.height), place(-data.width, data.height)})};
  scene.end_time = duration;
  scene.output_every = duration;
  return scene;
}

/// Displacement down the plane at the scene's end, from the unloaded start.
double slide(const Report& report, const Scene& scene, const analytical::BlockOnPlane& data) {
  Simulation simulation = report.simulate(scene);
  const std::vector<Sample> samples = history(simulation);
  return samples.empty() ? not_measured() : downhill(data, samples.back().motion.displacement);
}

void corner_over_joint(Report& report) {
  analytical::BlockOnPlane data;
  data.normal_stiffness *= 64;
  data.shear_stiffness *= 64;
  const double expected = analytical::sliding_displacement(data, duration);
  const double transient = data.gravity / analytical::bounce_frequency(data) * duration;
  for (const double joint : {45.0, 60.0, 90.0, 110.0, 135.0}) {
    for (const double front : {70.0, 90.0, 105.0}) {
      Scene scene = block_over_joint(data, joint * analytical::degree, front * analytical::degree);
      const std::string name = text("joint at {:g} deg, ", joint) + text("front at {:g} deg: displacement", front);
      scene.method.contact = "soft";
      scene.step.dt = 1e-4;
      report.near(name, "soft", expected, slide(report, scene, data), transient, "m", "eq. (8); tolerance g t/w of the transient");
      scene.method.contact = "hard";
      scene.step.dt = 1e-3;
      report.near(name, "hard", expected, slide(report, scene, data), duration / scene.step.dt * scene.method.gap_tolerance, "m",
                  "eq. (8); tolerance: what each step may leave in a contact");
    }
  }
}

const Registered<Case> registered{{"E6c", "a corner that stands on a joint", &corner_over_joint}};

}  // namespace
}  // namespace openclose::verification
