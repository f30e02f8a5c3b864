// Blocks, joints and scenes built in memory, for unit tests and verification cases alike.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "openclose/scene/scene.h"
#include "support/polygons.h"

namespace openclose::builders {

inline const std::array<std::string, 4> all_methods = {"soft", "hard", "shi", "dem"};

inline BlockInput free_block(const std::string& name, std::vector<Vec2> vertices) {
  BlockInput block;
  block.name = name;
  block.vertices = std::move(vertices);
  return block;
}

inline BlockInput fixed_block(const std::string& name, std::vector<Vec2> vertices) {
  BlockInput block = free_block(name, std::move(vertices));
  block.fixed = true;
  return block;
}

/// Courses of blocks 1 m high that rest on y = 0, from left to right and from below; every other course is shifted to the right [m].
inline std::vector<BlockInput> wall(int courses, int blocks, double width, double shift) {
  std::vector<BlockInput> list;
  for (int course = 0; course < courses; ++course) {
    for (int i = 0; i < blocks; ++i) {
      const std::string name = "block " + std::to_string(course) + " " + std::to_string(i);
      list.push_back(free_block(name, rectangle(width * i + shift * (course % 2), course, width, 1.0)));
    }
  }
  return list;
}

/// A wall of bricks 2 m wide on a fixed base, its top course moving to the right.
inline std::vector<BlockInput> wall_with_moving_top(int courses, int bricks, double shift) {
  std::vector<BlockInput> list = wall(courses, bricks, 2.0, shift);
  for (auto brick = list.end() - bricks; brick != list.end(); ++brick) brick->velocity = {2.0, 0.0};
  list.insert(list.begin(), fixed_block("base", rectangle(-10.0, -1.0, 2.0 * bricks + 20.0, 1.0)));
  return list;
}

/// Without cohesion; stiffnesses [Pa/m], friction angle [rad].
inline JointProperties frictional_joint(double normal_stiffness, double shear_stiffness, double friction_angle) {
  JointProperties joint;
  joint.normal_stiffness = normal_stiffness;
  joint.shear_stiffness = shear_stiffness;
  joint.friction_angle = friction_angle;
  return joint;
}

/// One material "rock" of this density [kg/m3] and one joint; start "unloaded"; no blocks.
inline Scene rock_scene(double density, const JointProperties& joint, double gap_tolerance) {
  Scene scene;
  scene.where = {"scene.toml", 0};
  scene.materials = {{"rock", density}};
  scene.joints = {joint};
  scene.method.start = Start::unloaded;
  scene.method.gap_tolerance = gap_tolerance;
  return scene;
}

/// `shi` with the joint's own springs for penalties, so that it differs from `soft` in its way of solving only.
inline void use_joint_springs_as_penalty(Scene& scene) {
  scene.method.penalty = scene.joints[0].normal_stiffness;
  scene.method.penalty_shear_ratio = scene.joints[0].shear_stiffness / scene.joints[0].normal_stiffness;
  scene.method.penetration_tolerance = 1.0;
}

}  // namespace openclose::builders
