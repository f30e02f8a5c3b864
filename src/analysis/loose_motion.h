// How blocks move that nothing holds, in words, and what would hold them.
#pragma once

#include <string>
#include <vector>

#include "openclose/core/vector.h"
#include "openclose/scene/scene.h"

namespace openclose {

class Simulation;

/// A block that moves in a mechanism. Only ratios of velocities count.
struct FailingBlock {
  int block = 0;
  double area = 0.0;             ///< [m2]
  Vec2 centroid = Vec2::Zero();  ///< [m]
  Vec2 velocity = Vec2::Zero();  ///< [-] of the centroid; the fastest point of all blocks has about 1
  double rotation = 0.0;         ///< [1/m] counter-clockwise
};

/// E.g. `"top" slides along its joint with "base" (friction above 26.6 degrees, cohesion_pa or a [[support]] would hold it)`. Of many blocks those
/// come first that slide, turn or fall by themselves; the others are counted. \param scene  the blocks as they were drawn: what touches what is
/// looked up there
std::string motion_in_words(const Scene& scene, const std::vector<FailingBlock>& mechanism);

/// The blocks that have moved farther than a tenth of the farthest, with the velocities of steady turns that would bring them where they are.
std::vector<FailingBlock> moved_blocks(const Simulation& simulation);

}  // namespace openclose
