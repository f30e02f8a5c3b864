// The joints of the drawing, and what has become of them: how far their two sides have opened and slipped.
//
// A drawn joint is the stretch along which the edges of two blocks face each other in the drawing. Its opening follows from the motions of its two
// blocks alone, so that it is known wherever the blocks are, also where detection has long lost sight of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "openclose/model/block_system.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// Points are those of the drawing [m]; `from` to `to` runs along the edge of b, counter-clockwise around b.
struct DrawnJoint {
  int block_a = 0, block_b = 0;
  int edge_a = 0, edge_b = 0;                       ///< number of the edge's first vertex in the outline of its block
  Vec2 from_a = Vec2::Zero(), to_a = Vec2::Zero();  ///< on the side of a
  Vec2 from_b = Vec2::Zero(), to_b = Vec2::Zero();  ///< opposite to these on the side of b
};

/// Two points that faced each other in the drawing. The normal is that of b's edge, see JointDirection.
struct JointGap {
  Vec2 middle = Vec2::Zero();  ///< [m] between the two
  double opening = 0.0;        ///< [m] along the normal, with what the drawing has; negative: closed that far
  double slip = 0.0;           ///< [m] of a along the edge of b, counter-clockwise around b, since the drawing
};

struct JointMotion {
  JointGap from, to;
};

/// All of them, by ascending blocks and edges. Edges face each other if they are parallel to within tolerance::parallel_full_rad and no farther
/// apart, nor deeper in each other, than tolerance::farthest_point_from_joint_m or a thousandth of the median block's size; pairs of fixed blocks are
/// none.
std::vector<DrawnJoint> drawn_joints(const Scene& scene);

/// The joint between two blocks at a point of it, of no length: that of the two edges there which face each other best.
DrawnJoint joint_at(const Scene& scene, int block_a, int block_b, const Vec2& point);

/// Of the joint that acts there: the one that both edges name, else that of the two materials. Empty if it has no name.
const std::string& name_of_joint(const Scene& scene, const DrawnJoint& joint);

/// Of which edge of b the normal and the tangent of a gap are.
enum class JointDirection {
  moved,  ///< where the block is now
  drawn,  ///< of the drawing: gaps are then linear in the motions of the blocks, as velocities are
};
JointMotion joint_motion(const DrawnJoint& joint, const BlockSystem& system, JointDirection direction = JointDirection::moved);

}  // namespace openclose
