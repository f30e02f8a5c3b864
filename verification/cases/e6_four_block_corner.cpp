// E6f, the mechanism behind E6: two blocks slide as a slab over two fixed ones, and all four meet exactly in one corner. A contact between the
// diagonal blocks would lock the slab; without one it slides as eq. (8) says.
#include <cmath>

#include "harness.h"
#include "openclose/analytical/incline.h"
#include "openclose/analytical/two_spring_block.h"
#include "openclose/core/tolerance.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

/// Slab and base on an incline, cut by one joint at `joint_angle` from the plane (90: normal to it).
Scene slab(const analytical::BlockOnPlane& data, double joint_angle) {
  Scene scene = empty_scene(data);
  const auto place = [&](double along, double above) { return on_slope(data.slope_angle, along, above); };
  const double lean = 1.0 / std::tan(joint_angle);  // shift of the joint per metre of height
  scene.blocks = {fixed_block("base up", {place(-8.0, 0.0), place(-8.0, -1.0), place(-lean, -1.0), place(0.0, 0.0)}),
                  fixed_block("base down", {place(0.0, 0.0), place(-lean, -1.0), place(8.0, -1.0), place(8.0, 0.0)}),
                  free_block("slab up", {place(-2.0, 0.0), place(0.0, 0.0), place(lean, 1.0), place(-2.0, 1.0)}),
                  free_block("slab down", {place(0.0, 0.0), place(2.0, 0.0), place(2.0, 1.0), place(lean, 1.0)})};
  return scene;
}

/// Mean displacement of the two sliding blocks down the plane at the scene's end, from the unloaded start.
double slide(const Report& report, const Scene& scene, const analytical::BlockOnPlane& data) {
  Simulation simulation = report.simulate(scene);
  const auto& system = simulation.system();
  const Vec2 start = system.centroid(2) + system.centroid(3);
  if (history(simulation).empty()) return not_measured();
  return 0.5 * downhill(data, system.centroid(2) + system.centroid(3) - start);
}

Scene scene_of(const analytical::BlockOnPlane& data, double degrees, const std::string& method, double dt) {
  Scene scene = slab(data, degrees * analytical::degree);
  scene.method.contact = method;
  use_joint_springs_as_penalty(scene);
  scene.step.dt = dt;
  scene.end_time = 0.5;
  scene.output_every = scene.end_time;
  return scene;
}

void four_block_corner(Report& report) {
  const analytical::BlockOnPlane data;
  const double expected = analytical::sliding_displacement(data, 0.5);
  for (const double degrees : {90.0, 60.0, 120.0, 45.0, 135.0, 30.0, 150.0}) {
    const std::string name = text("slab over a joint at {} deg: ", degrees);
    // The bounces of the unloaded start change the velocity for good, by a share of g/w with w^2 = (sum of kn)/m; a lock would not fade with
    // stiffness.
    for (const double factor : {4.0, 64.0}) {
      analytical::BlockOnPlane stiffer = data;
      stiffer.normal_stiffness *= factor;
      stiffer.shear_stiffness *= factor;
      const double w = analytical::bounce_frequency(stiffer);
      for (const std::string method : {"soft", "shi", "dem"}) {
        report.near(name + text("displacement, {} kn", factor), method, expected, slide(report, scene_of(stiffer, degrees, method, 1e-4), stiffer),
                    data.gravity / w * 0.5, "m", "eq. (8); tolerance g t/w of the transient");
      }
    }
    const double dt = 1e-3;
    const Scene hard = scene_of(data, degrees, "hard", dt);
    report.near(name + "displacement", "hard", expected, slide(report, hard, data), 0.5 / dt * hard.method.gap_tolerance, "m",
                "eq. (8); tolerance: what each step may leave in a contact");
  }
}

const Registered<Case> registered{{"E6f", "four blocks that meet in one corner", &four_block_corner}};

}  // namespace
}  // namespace openclose::verification
