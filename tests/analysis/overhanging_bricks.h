// Bricks that topple, and that friction between rigid blocks may lock by chance.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "support/scenes.h"

namespace openclose::test {

/// Two courses of bricks in running bond on a floor: the last brick of the upper one rests on half a brick and topples about its edge where gravity
/// leans that way, while its corner slides along its neighbour.
inline Scene overhanging_bricks(int bricks, const Vec2& gravity, const JointProperties& joint) {
  Scene scene = scene_with({fixed_block("floor", rectangle(-5.0, -1.0, 15.0, 1.0))});
  for (int course : {0, 1}) {
    for (int i = 0; i < bricks; ++i) {
      scene.blocks.push_back(free_block(fmt::format("brick {} {}", course, i), rectangle(i + 0.5 * course, 0.6 * course, 1.0, 0.6)));
    }
  }
  scene.gravity = gravity;
  scene.joints[0] = joint;
  scene.method.gap_tolerance = MethodInput().gap_tolerance;
  return scene;
}

/// Of four bricks on a floor that leans by six degrees.
inline Scene overhanging_bricks() {
  const double leaning = 6.0 * degree;
  return overhanging_bricks(2, {9.81 * std::sin(leaning), -9.81 * std::cos(leaning)}, frictional_joint(1e10, 1e9, 35.0 * degree));
}

}  // namespace openclose::test
