// E6f, the mechanism behind E6: two blocks slide as a slab over two fixed ones, and all four meet exactly in one corner. A contact between the
// diagonal blocks would lock the slab; without one it slides as eq. (8) says. E6g: where the joints cross at a small angle the diagonal blocks face
// each other over the wedge of the other two, and what is above the steeper joint slides on it all the same.
#include <algorithm>
#include <cmath>
#include <utility>

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
  for (const double degrees : {90.0, 85.0, 95.0, 78.0, 102.0, 60.0, 120.0, 45.0, 135.0, 30.0, 150.0}) {
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

struct Crossing {
  double steep, shallow;  ///< [deg]
  bool has_third;         ///< joint half-way between the two
  bool is_mirrored;
};

/// Joints that cross in one point: what is above the steepest one slides on it, over fixed blocks, with the wedges of the other joints ahead.
Scene crossing_joints(const analytical::BlockOnPlane& data, const Crossing& joints) {
  constexpr double reach = 3.0, depth = 4.0;  // [m]
  Scene scene = empty_scene(data);
  const Vec2 corner(0.0, 0.0);
  const auto at = [](double x, double degrees) { return Vec2(x, x * std::tan(degrees * analytical::degree)); };
  std::vector<double> dips{joints.steep, joints.shallow};
  if (joints.has_third) dips.insert(dips.begin() + 1, 0.5 * (joints.steep + joints.shallow));
  scene.blocks = {fixed_block("below", {{-reach, -depth}, {reach, -depth}, at(reach, joints.shallow), corner, at(-reach, joints.steep)}),
                  free_block("above", {at(-reach, joints.shallow), corner, at(reach, joints.steep), {reach, depth}, {-reach, depth}})};
  for (int i = 1; i < static_cast<int>(dips.size()); ++i) {
    scene.blocks.push_back(fixed_block(text("behind {}", i), {corner, at(reach, dips[i]), at(reach, dips[i - 1])}));
    scene.blocks.push_back(free_block(text("ahead {}", i), {at(-reach, dips[i - 1]), corner, at(-reach, dips[i])}));
  }
  if (!joints.is_mirrored) return scene;
  for (BlockInput& block : scene.blocks) {
    for (Vec2& v : block.vertices) v.x() = -v.x();
    std::ranges::reverse(block.vertices);
  }
  return scene;
}

void joints_that_cross(Report& report) {
  for (const auto& [steep, shallow] : {std::pair{12.0, 4.0}, {25.0, 12.0}, {25.0, 20.0}, {30.0, 28.0}, {35.0, 21.0}}) {
    for (const auto& [has_third, is_mirrored] : {std::pair{false, false}, {false, true}, {true, false}, {true, true}}) {
      analytical::BlockOnPlane data;
      data.slope_angle = steep * analytical::degree;
      data.friction_angle = 30.0 * analytical::degree;
      const std::string name = text("joints of {}", steep) + text(" and {} deg", shallow) + (has_third ? " and one between" : "") +
                               (is_mirrored ? ", mirrored" : "") + ": factor of safety";
      Scene scene = crossing_joints(data, {steep, shallow, has_third, is_mirrored});
      scene.strength_reduction.width = 1e-4;
      use_joint_springs_as_penalty(scene);
      const double expected = std::tan(data.friction_angle) / std::tan(data.slope_angle);
      for (const std::string& method : all_methods) {
        scene.method.contact = method;
        scene.strength_reduction.definition = method == "hard" ? FactorDefinition::large_displacements : FactorDefinition::small_displacements;
        report.near(name, method, expected, strength_reduction_factor(report, scene), scene.strength_reduction.width, "-",
                    "tan phi/tan psi of the steepest joint; width of the bracket");
      }
    }
  }
}

const Registered<Case> registered{{"E6f", "four blocks that meet in one corner", &four_block_corner}};
const Registered<Case> registered_crossing{{"E6g", "four blocks that meet where joints cross at a small angle", &joints_that_cross}};

}  // namespace
}  // namespace openclose::verification
