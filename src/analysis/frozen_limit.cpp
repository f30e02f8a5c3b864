#include "openclose/analysis/frozen_limit.h"

namespace openclose {
namespace {

Eigen::Vector3d in_newtons(const FrozenSystem& system, const FrozenBlock& block, const BlockVector& force) {
  return system.force_unit() * Eigen::Vector3d(force[0], force[1], force[2] * block.radius * system.length_unit());
}

}  // namespace

limit_analysis::Problem limit_problem(const FrozenSystem& system, const FrozenStrength& strength, LoneCorners lone_corners) {
  limit_analysis::Problem problem;
  problem.varied = system.has_live_load() ? limit_analysis::Varied::live_loads : limit_analysis::Varied::strength;
  for (const FrozenBlock& block : system.blocks()) {
    limit_analysis::Block b;
    b.centroid = block.centroid;
    b.load = in_newtons(system, block, block.dead_load);
    b.live = in_newtons(system, block, block.live_load);
    b.radius = block.radius * system.length_unit();
    b.free[2] = !block.rotation_locked;
    problem.blocks.push_back(b);
  }
  for (std::size_t i = 0; i < system.contacts().size(); ++i) {
    const FrozenContact& c = system.contacts()[i];
    if (lone_corners == LoneCorners::left_out && c.joined_length == 0.0) continue;
    const ContactStrength s = strength.of(i, {});
    // A fixed block is the outside world, which is the second one.
    const bool corner_is_free = c.a >= 0;
    problem.contacts.push_back({corner_is_free ? c.a : c.b, corner_is_free ? c.b : -1, c.point, corner_is_free ? c.normal : Vec2(-c.normal),
                                s.cohesion * system.force_unit(), s.friction, s.tension * system.force_unit()});
  }
  for (const FrozenSupport& s : system.supports()) {
    problem.free_forces.push_back({s.row, in_newtons(system, system.blocks()[s.row], s.direction) / system.force_unit()});
  }
  return problem;
}

}  // namespace openclose
