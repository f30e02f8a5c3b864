// Small scenes that several test folders share, built in memory.
#pragma once

#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/builders.h"

namespace openclose::test {

using namespace builders;

inline constexpr double degree = std::numbers::pi / 180.0;

/// [m] of `hard`: so tight that rigid contacts can be told from stiff ones.
inline constexpr double gap_tolerance = 1e-11;

/// One material of 2500 kg/m3, a joint without cohesion, steps of 1 ms, start "unloaded"; no blocks.
inline Scene empty_scene() {
  Scene scene = rock_scene(2500.0, frictional_joint(1e9, 4e8, 30.0 * degree), gap_tolerance);
  scene.step.dt = 1e-3;
  return scene;
}

inline Scene scene_with(std::vector<BlockInput> blocks) {
  Scene scene = empty_scene();
  scene.blocks = std::move(blocks);
  return scene;
}

/// Gravity alone on one block of 2 m x 1 m (5000 kg), no contact within reach.
inline Scene falling_block() {
  Scene scene = empty_scene();
  scene.blocks = {free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))};
  return scene;
}

/// The same block on a fixed base of 20 m: two contacts of 1 m tributary length.
inline Scene block_on_base() {
  Scene scene = empty_scene();
  scene.blocks = {fixed_block("base", rectangle(-10.0, -1.0, 20.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))};
  return scene;
}

inline constexpr double block_mass = 5000.0;           // [kg/m]
inline constexpr double block_weight = 5000.0 * 9.81;  // [N/m]
inline constexpr double block_edge = 2.0;              // [m] the block stands on

/// The same, tilted by `slope` [rad] so that downhill is to the right.
inline Scene block_on_incline(double slope) {
  Scene scene = block_on_base();
  for (BlockInput& block : scene.blocks) block.vertices = placed(block.vertices, -slope);
  return scene;
}

/// A column of n of these blocks on the base, each shifted against the one below by 0.3 m, to and fro.
inline Scene column_of_blocks(int n) {
  Scene scene = empty_scene();
  scene.blocks = {fixed_block("base", rectangle(-10.0, -1.0, 20.0, 1.0))};
  for (int i = 0; i < n; ++i) scene.blocks.push_back(free_block("block " + std::to_string(i), rectangle(i % 2 == 0 ? 0.0 : 0.3, i, 2.0, 1.0)));
  return scene;
}

/// Three blocks that fall on a base and on each other, spinning: contacts open, stick, slide and change their corners within half a second.
inline Scene tumbling_blocks() {
  Scene scene = empty_scene();
  scene.blocks = {fixed_block("base", rectangle(-10.0, -1.0, 20.0, 1.0)),
                  free_block("left", placed(rectangle(-0.5, -0.5, 1.0, 1.0), 0.3, {0.0, 0.9})),
                  free_block("right", placed(rectangle(-0.4, -0.6, 0.8, 1.2), -0.5, {1.4, 1.1})),
                  free_block("top", placed({{-0.6, -0.4}, {0.7, -0.4}, {0.0, 0.6}}, 0.2, {0.7, 2.2}))};
  scene.blocks[1].velocity = {1.5, -1.0};
  scene.blocks[1].angular_velocity = -2.0;
  scene.blocks[2].velocity = {-1.0, -1.0};
  scene.blocks[2].angular_velocity = 1.0;
  scene.blocks[3].velocity = {0.0, -4.0};
  scene.joints[0].normal_stiffness = 1e8;
  scene.joints[0].shear_stiffness = 5e7;
  return scene;
}

/// A wall of 640 blocks of 2 m x 1 m in running bond on the base. Some of the blocks on top have got a stroke to the right and downwards.
inline Scene struck_wall(int blocks = 40) {
  constexpr int courses = 16;
  Scene scene = empty_scene();
  scene.blocks = {fixed_block("base", rectangle(-1.0, -1.0, 2.0 * blocks + 3.0, 1.0))};
  for (BlockInput& block : wall(courses, blocks, 2.0, 1.0)) scene.blocks.push_back(std::move(block));
  for (std::size_t i = scene.blocks.size() - blocks + 5; i < scene.blocks.size(); i += 10) scene.blocks[i].velocity = {3.0, -1.0};
  scene.step.dt = 5e-3;
  return scene;
}

}  // namespace openclose::test
