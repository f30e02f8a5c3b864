#include <cstring>

#include "openclose/integrator/batch_pose.h"
#include "openclose/integrator/contact_batch.h"

namespace openclose {
namespace {

using namespace lanes;
constexpr int entries = 9;  ///< of a block of the matrix, column by column

/// What one block of the matrix gets of four contacts, its entries column by column: for each contact in one piece once they are transposed.
struct Entries {
  Lanes first[batch_size], second[batch_size], last;

  OPENCLOSE_KERNEL void add_to(double* block, int lane) const {
    const Lanes a = load(block) + first[lane], b = load(block + batch_size) + second[lane];
    std::memcpy(block, &a, sizeof a);
    std::memcpy(block + batch_size, &b, sizeof b);
    block[entries - 1] += last[lane];
  }
};

OPENCLOSE_KERNEL double* block(double* values, int slot) {
  return values + static_cast<std::ptrdiff_t>(entries) * slot;
}

/// As ContactStiffness.
struct Stiffness {
  Lanes xx, xy, yx, yy;

  OPENCLOSE_KERNEL void find(Entries& found, double sign, Lanes force_x, Lanes force_y, Lanes path_x, Lanes path_y, Lanes corner, Lanes column_x,
                             Lanes column_y, Lanes row_x, Lanes row_y) const {
    const Lanes by_turn_x = xy * path_x - xx * path_y, by_turn_y = yy * path_x - yx * path_y;
    const Lanes moment_x = yx * force_x - xx * force_y, moment_y = yy * force_x - xy * force_y;
    found = {{sign * xx, sign * yx, sign * moment_x + row_x, sign * xy},
             {sign * yy, sign * moment_y + row_y, sign * by_turn_x + column_x, sign * by_turn_y + column_y},
             sign * (force_x * by_turn_y - force_y * by_turn_x) + corner};
    transpose(found.first[0], found.first[1], found.first[2], found.first[3]);
    transpose(found.second[0], found.second[1], found.second[2], found.second[3]);
  }
};

/// Whether the linear equations know nothing of these contacts.
OPENCLOSE_KERNEL bool adds_nothing(const TrialBatch& at, const Branch* branches, bool open_ones_too) {
  if (!all_are_open(branches)) return false;
  return !open_ones_too || !any((at.normal != 0.0) | (at.normal_by_gap != 0.0) | (at.shear_by_slip != 0.0));
}

/// \param averaged  forces act in the mean pose, gap and slip change with the pose at the end
template <bool averaged>
OPENCLOSE_KERNEL void add_stiffness(const ContactBatch* contacts, const BlockMove* moves, const TrialBatch* trials, std::size_t count,
                                    const Branch* branches, const BatchTangent& tangent, const MatrixSlots& slots, double* values) {
  const Lanes zero{}, theta = all(tangent.end_weight);
  const ContactSlots* of_contacts = slots.of_contacts.data();
  const int* const diagonals = slots.diagonals.data();
  for (std::size_t i = 0; i < count; ++i, branches += batch_size, of_contacts += batch_size) {
    const TrialBatch& at = trials[i];
    if (adds_nothing(at, branches, tangent.open_ones_too)) continue;
    const Pose pose(contacts[i], Moves(moves, contacts[i].vertex_at), Moves(moves, contacts[i].edge_at));
    const ActingPose acting = averaged ? mean_acting_pose(contacts[i], pose) : acting_pose(pose);
    const Lanes nn = -theta * at.normal_by_gap, tn = tangent.exact ? -theta * at.shear_by_gap : zero;
    Lanes tt = -theta * at.shear_by_slip;
    if (!tangent.exact && tangent.static_slip_stiffness > 0.0) {
      for (int k = 0; k < batch_size; ++k) {
        if (status(branches[k]) == ContactStatus::sliding) tt[k] = tangent.static_slip_stiffness * contacts[i].shear[k];
      }
    }
    const Lanes nx = pose.normal_x, ny = pose.normal_y, tx = -ny, ty = nx;
    const Lanes force_nx = acting.normal_x, force_ny = acting.normal_y, force_tx = -force_ny, force_ty = force_nx;
    const Lanes by_gap_x = nn * force_nx + tn * force_tx, by_gap_y = nn * force_ny + tn * force_ty, by_slip_x = tt * force_tx,
                by_slip_y = tt * force_ty;
    const Stiffness k{by_gap_x * nx + by_slip_x * tx, by_gap_x * ny + by_slip_x * ty, by_gap_y * nx + by_slip_y * tx, by_gap_y * ny + by_slip_y * ty};
    // As in ContactStiffness. Means over a path change by half of what its end does.
    Lanes turning_x = zero, turning_y = zero, on_arms_x = zero, on_arms_y = zero;
    if (tangent.exact) {
      const Lanes share = averaged ? all(0.5) : theta;
      turning_x = share * (at.normal * nx + at.shear * tx);
      turning_y = share * (at.normal * ny + at.shear * ty);
      on_arms_x = averaged ? share * (at.normal * force_nx + at.shear * force_tx) : turning_x;
      on_arms_y = averaged ? share * (at.normal * force_ny + at.shear * force_ty) : turning_y;
    }
    const Lanes vx = pose.vertex_arm_x, vy = pose.vertex_arm_y, ex = pose.edge_arm_x, ey = pose.edge_arm_y;
    const Lanes force_vx = acting.vertex_arm_x, force_vy = acting.vertex_arm_y, force_ex = acting.edge_arm_x, force_ey = acting.edge_arm_y;
    const Lanes turning_at_vertex = turning_x * force_vx + turning_y * force_vy, turning_at_edge = turning_x * force_ex + turning_y * force_ey;
    const Lanes along_vertex = on_arms_x * vx + on_arms_y * vy;
    Entries vertex, edge, vertex_edge, edge_vertex;
    k.find(vertex, 1.0, force_vx, force_vy, vx, vy, along_vertex, zero, zero, zero, zero);
    k.find(edge, 1.0, force_ex, force_ey, ex, ey, turning_at_edge, -turning_y, turning_x, -on_arms_y, on_arms_x);
    k.find(vertex_edge, -1.0, force_vx, force_vy, ex, ey, -turning_at_vertex, turning_y, -turning_x, zero, zero);
    k.find(edge_vertex, -1.0, force_ex, force_ey, vx, vy, -along_vertex, zero, zero, on_arms_y, -on_arms_x);
    for (int lane = 0; lane < batch_size; ++lane) {
      vertex.add_to(block(values, diagonals[contacts[i].vertex_place(lane)]), lane);
      edge.add_to(block(values, diagonals[contacts[i].edge_place(lane)]), lane);
      vertex_edge.add_to(block(values, of_contacts[lane].vertex_edge), lane);
      edge_vertex.add_to(block(values, of_contacts[lane].edge_vertex), lane);
    }
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void add_all_stiffness(const ContactBatch* contacts, const BlockMove* moves, const TrialBatch* trials,
                                                        std::size_t count, const Branch* branches, const BatchTangent& tangent,
                                                        const MatrixSlots& slots, double* values) {
  // The symmetric tangent of means over a path knows one pose.
  if (tangent.exact && tangent.forces == StepForces::averaged)
    return add_stiffness<true>(contacts, moves, trials, count, branches, tangent, slots, values);
  add_stiffness<false>(contacts, moves, trials, count, branches, tangent, slots, values);
}

}  // namespace

void add_stiffness(const std::vector<ContactBatch>& contacts, const BlockMove* moves, const std::vector<TrialBatch>& trials,
                   const std::vector<Branch>& branches, const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) {
  if (matrix.rows() == 0) return;
  add_all_stiffness(contacts.data(), moves, trials.data(), trials.size(), branches.data(), tangent, slots, matrix.value(0).data());
}

}  // namespace openclose
