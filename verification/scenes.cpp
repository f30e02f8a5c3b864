#include "scenes.h"

#include <cmath>

#include "openclose/analysis/strength_reduction.h"
#include "openclose/scene/writer.h"

namespace openclose::verification {
namespace {

/// Frame of the plane: x downhill (to the right), y away from it.
Vec2 along(const analytical::BlockOnPlane& data) {
  return {std::cos(data.slope_angle), -std::sin(data.slope_angle)};
}
Vec2 away(const analytical::BlockOnPlane& data) {
  return {std::sin(data.slope_angle), std::cos(data.slope_angle)};
}

}  // namespace

Scene empty_scene(const analytical::BlockOnPlane& data) {
  Scene scene;
  scene.where = {"(built in memory)", 0};
  scene.gravity = {0.0, -data.gravity};
  scene.materials = {{"rock", data.density}};
  JointProperties joint;
  // Each corner of the block has half its width for tributary length.
  joint.normal_stiffness = data.normal_stiffness / (0.5 * data.width);
  joint.shear_stiffness = data.shear_stiffness / (0.5 * data.width);
  joint.friction_angle = data.friction_angle;
  scene.joints = {joint};
  scene.method.start = Start::unloaded;
  scene.method.gap_tolerance = 1e-11;  // closed forms know rigid contacts
  scene.step.max_displacement = 1.0;
  return scene;
}

std::vector<Vec2> rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

BlockInput free_block(const std::string& name, std::vector<Vec2> vertices) {
  BlockInput block;
  block.name = name;
  block.vertices = std::move(vertices);
  block.where = {"(built in memory)", 0};
  return block;
}

BlockInput fixed_block(const std::string& name, std::vector<Vec2> vertices) {
  BlockInput block = free_block(name, std::move(vertices));
  block.fixed = true;
  return block;
}

Scene block_on_plane(const analytical::BlockOnPlane& data, double length_downhill) {
  Scene scene = empty_scene(data);
  const Vec2 x = along(data), y = away(data);
  const auto place = [&](double s, double h) { return Vec2(s * x + h * y); };
  scene.blocks.push_back(fixed_block("plane", {place(-20.0, 0.0), place(-20.0, -5.0), place(length_downhill, -5.0), place(length_downhill, 0.0)}));
  scene.blocks.push_back(free_block("block", {place(0.0, 0.0), place(data.width, 0.0), place(data.width, data.height), place(0.0, data.height)}));
  return scene;
}

double downhill(const analytical::BlockOnPlane& data, const Vec2& displacement) {
  return along(data).dot(displacement);
}
double off_plane(const analytical::BlockOnPlane& data, const Vec2& displacement) {
  return away(data).dot(displacement);
}

void use_joint_springs_as_penalty(Scene& scene, const analytical::BlockOnPlane& data) {
  scene.method.penalty = scene.joints[0].normal_stiffness;
  scene.method.penalty_shear_ratio = data.shear_stiffness / data.normal_stiffness;
  scene.method.penetration_tolerance = 1.0;
}

double strength_reduction_factor(const Report& report, const Scene& scene) {
  RigidSimulation simulation = report.simulate(scene);
  const auto result = factor_of_safety<unknowns>(simulation);
  return result.found ? result.stable : not_measured();
}

analytical::LimitState limit_state(const Scene& scene) {
  return analytical::limit_analysis(analytical::parse_rigid_blocks(write_scene(scene)));
}

}  // namespace openclose::verification
