// Where four contacts are at a trial displacement, for the kernels that evaluate them and add up their stiffness.
#pragma once

#include <cstring>

#include "openclose/integrator/contact_batch.h"
#include "openclose/integrator/lane_operations.h"

namespace openclose::lanes {

/// Of four blocks.
struct Moves {
  Lanes x, y, sine, versine;
  Lanes edge_sine, edge_versine, bound, unused;

  /// \param at  as in ContactBatch
  OPENCLOSE_KERNEL Moves(const BlockMove* moves, const unsigned* at) {
    Lanes* const first[] = {&x, &y, &sine, &versine};
    Lanes* const second[] = {&edge_sine, &edge_versine, &bound, &unused};
    for (int k = 0; k < batch_size; ++k) {
      const double* const move = moves->translation.data() + at[k];
      *first[k] = load(move);
      *second[k] = load(move + batch_size);
    }
    transpose(x, y, sine, versine);
    transpose(edge_sine, edge_versine, bound, unused);
  }
};
static_assert(sizeof(BlockMove) == 2 * sizeof(Lanes), "its members are loaded in their order");

/// As ContactPose.
struct Pose {
  Lanes normal_x, normal_y, vertex_arm_x, vertex_arm_y, edge_arm_x, edge_arm_y, gap_change, slip_change;

  OPENCLOSE_KERNEL Pose(const ContactBatch& c, const Moves& vertex, const Moves& edge) {
    const Lanes dnx = -edge.edge_sine * c.normal_y - edge.edge_versine * c.normal_x,
                dny = edge.edge_sine * c.normal_x - edge.edge_versine * c.normal_y;
    normal_x = c.normal_x + dnx;
    normal_y = c.normal_y + dny;
    const Lanes turn_x = -vertex.sine * c.vertex_arm_y - vertex.versine * c.vertex_arm_x,
                turn_y = vertex.sine * c.vertex_arm_x - vertex.versine * c.vertex_arm_y;
    const Lanes shift_x = (vertex.x - edge.x) + turn_x, shift_y = (vertex.y - edge.y) + turn_y;
    const Lanes apart_x = shift_x + (edge.sine * c.end_arm_y + edge.versine * c.end_arm_x),
                apart_y = shift_y - (edge.sine * c.end_arm_x - edge.versine * c.end_arm_y);
    gap_change = (dnx * c.lever_x + dny * c.lever_y) + (normal_x * apart_x + normal_y * apart_y);
    slip_change = (dnx * c.lever_y - dny * c.lever_x) + (normal_x * apart_y - normal_y * apart_x);
    vertex_arm_x = c.vertex_arm_x + turn_x;
    vertex_arm_y = c.vertex_arm_y + turn_y;
    edge_arm_x = (c.end_arm_x + c.lever_x) + shift_x;
    edge_arm_y = (c.end_arm_y + c.lever_y) + shift_y;
  }
};

/// Where the forces of four contacts act.
using ActingPose = ForcePlace<Lanes>;
OPENCLOSE_KERNEL ActingPose acting_pose(const Pose& t) {
  return {t.normal_x, t.normal_y, t.vertex_arm_x, t.vertex_arm_y, t.edge_arm_x, t.edge_arm_y};
}
/// As mean_pose().
OPENCLOSE_KERNEL ActingPose mean_acting_pose(const ContactBatch& c, const Pose& t) {
  return {0.5 * (c.normal_x + t.normal_x),
          0.5 * (c.normal_y + t.normal_y),
          0.5 * (c.vertex_arm_x + t.vertex_arm_x),
          0.5 * (c.vertex_arm_y + t.vertex_arm_y),
          0.5 * ((c.end_arm_x + c.lever_x) + t.edge_arm_x),
          0.5 * ((c.end_arm_y + c.lever_y) + t.edge_arm_y)};
}

OPENCLOSE_KERNEL bool all_are_open(const Branch* branches) {
  int all;
  static_assert(sizeof all == batch_size * sizeof(Branch));
  std::memcpy(&all, branches, sizeof all);
  return all == 0;
}

}  // namespace openclose::lanes
