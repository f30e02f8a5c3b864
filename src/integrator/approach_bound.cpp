#include "openclose/integrator/approach_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace openclose {
namespace {

/// [1/kg] Largest acceleration of any point of a block by a force of 1 N there.
double mobility(const BlockSystem& system, int b) {
  const auto& block = system.block(b);
  if (block.equation < 0) return 0.0;
  return 1.0 / block.mass[0] + (block.rotation_locked ? 0.0 : block.radius * block.radius / block.mass[2]);
}

/// [m/s] Of any point of a block.
double speed(const BlockSystem& system, int b) {
  const auto& v = system.velocity(b);
  return Vec2(v[0], v[1]).norm() + system.block(b).radius * std::abs(v[2]);
}

/// [Pa/m]
double largest_stiffness(const JointProperties& joint) {
  return std::max(joint.normal_stiffness, joint.shear_stiffness);
}

}  // namespace

double ApproachBound::step(const BlockSystem& system, const JointTable& joints, const std::vector<std::pair<int, int>>& pairs, double room,
                           double skin, double fraction) {
  if (longest_edges_.empty()) {
    for (const auto& block : system.blocks()) {
      double longest = 0.0, stiffest = 0.0;
      for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v)
        longest = std::max(longest, (system.arm(system.next(v)) - system.arm(v)).norm());
      for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) {
        if (system.edge_joint(v) != BlockInput::by_materials) stiffest = std::max(stiffest, largest_stiffness(joints.joint(system.edge_joint(v))));
      }
      longest_edges_.push_back(longest);
      stiffest_seams_.push_back(stiffest);
    }
  }
  double step = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : pairs) {
    const double relative = speed(system, a) + speed(system, b);
    if (relative == 0.0 || relative * step <= skin) continue;  // as long as the shortest one so far it moves less than the skin
    const double apart = (system.centroid(a) - system.centroid(b)).norm() - system.block(a).radius - system.block(b).radius;
    if (apart > room) continue;
    const JointProperties& joint = joints.joint(joints.index(system.block(a).material, system.block(b).material));
    // A seam names the joint of both its sides.
    const double stiffest = std::max(largest_stiffness(joint), std::min(stiffest_seams_[a], stiffest_seams_[b]));
    const double stiffness = stiffest * std::min(longest_edges_[a], longest_edges_[b]);
    const double own = 2.0 * fraction / std::sqrt(stiffness * (mobility(system, a) + mobility(system, b)));
    step = std::min(step, std::max(own, skin / relative));
  }
  return step;
}

}  // namespace openclose
