#include "openclose/integrator/contact_batch.h"

#include <algorithm>
#include <cstring>

#include "openclose/contact/mean_pose.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/lane_operations.h"
#include "openclose/law/path_average.h"

namespace openclose {
namespace {

using namespace lanes;
using Bytes = Branch __attribute__((vector_size(sizeof(Lanes))));

OPENCLOSE_KERNEL Lanes length(Lanes x, Lanes y) {
  return square_root(x * x + y * y);
}

/// Of four blocks.
struct Moves {
  Lanes x, y, sine, versine;
  Lanes edge_sine, edge_versine, bound, unused;

  /// \param at  as in ContactBatch
  OPENCLOSE_KERNEL Moves(const BlockMove* moves, const unsigned* at) {
    Lanes* const first[] = {&x, &y, &sine, &versine};
    Lanes* const second[] = {&edge_sine, &edge_versine, &bound, &unused};
    for (int k = 0; k < batch_size; ++k) {
      const double* const move = &moves->x + at[k];
      *first[k] = load(move);
      *second[k] = load(move + batch_size);
    }
    transpose(x, y, sine, versine);
    transpose(edge_sine, edge_versine, bound, unused);
  }
};
static_assert(sizeof(BlockMove) == 2 * sizeof(Lanes), "its members are loaded in their order");

OPENCLOSE_KERNEL bool all_are_open(const Branch* branches) {
  int all;
  static_assert(sizeof all == batch_size * sizeof(Branch));
  std::memcpy(&all, branches, sizeof all);
  return all == 0;
}

/// Each lane's branch in a byte of its own, at the place that it has in the list of branches.
template <Branch b>
OPENCLOSE_KERNEL Mask in_own_byte() {
  return (Mask)Bytes{b, 0, 0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0};
}
/// Writes the branches of four contacts, all others being open. A sliding contact is on minus its branch where it slides backward.
OPENCLOSE_KERNEL void write_branches(Branch* branches, Mask sticking, Mask sliding, Mask backward) {
  Mask all = (sticking & in_own_byte<branch(ContactStatus::sticking)>()) | (sliding & ~backward & in_own_byte<branch(ContactStatus::sliding)>()) |
             (sliding & backward & in_own_byte<branch(ContactStatus::sliding, true)>());
  all |= __builtin_shufflevector(all, all, 2, 3, 0, 1);
  all |= __builtin_shufflevector(all, all, 1, 0, 3, 2);
  std::memcpy(branches, &all, batch_size);
}
/// What springs would carry that nothing bounds.
OPENCLOSE_KERNEL Lanes elastic_normal_at(const ContactBatch& c, const TrialBatch& trial) {
  return c.shift - c.normal * (c.gap_off_target + trial.gap_change);
}
OPENCLOSE_KERNEL Lanes elastic_shear_at(const ContactBatch& c, const TrialBatch& trial) {
  return c.initial_shear - c.shear * trial.slip_change;
}

/// The joint law; returns which contacts are closed.
OPENCLOSE_KERNEL Mask find_forces(const ContactBatch& c, double ramp, TrialBatch& trial, Branch* branches) {
  const Lanes zero{};
  const Lanes elastic_normal = elastic_normal_at(c, trial);
  // By how much the gap is wider than where the spring opens.
  const Lanes parted = larger(zero, c.gap_off_target - quotient(c.normal > 0.0, c.shift + c.tension, c.normal));
  const Lanes viscous_normal = -c.normal_damping * (parted + trial.gap_change);
  const Lanes shear = elastic_shear_at(c, trial) + -c.shear_damping * trial.slip_change;
  const Mask closed = ~spring_is_open(c.tension, elastic_normal);

  const MohrCoulomb carried(c.friction, c.cohesion, c.tension, elastic_normal + viscous_normal, shear, ramp);
  const Mask sticking = closed & carried.is_sticking, sliding = closed & ~sticking;

  const Mask spring_works = closed & ~((c.normal_damping > 0.0) & (carried.normal <= -c.tension));
  const Lanes normal_by_gap = only_where(spring_works, -(c.normal + c.normal_damping));
  const Lanes signed_slope = (Lanes)((Mask)carried.limit.slope | ((Mask)shear & (Mask)-zero));
  trial.normal = only_where(closed, carried.normal);
  trial.shear = only_where(closed, carried.shear);
  trial.normal_by_gap = normal_by_gap;
  trial.shear_by_gap = only_where(sliding, signed_slope * normal_by_gap);
  trial.shear_by_slip = only_where(sticking, -(c.shear + c.shear_damping));

  write_branches(branches, sticking, sliding, carried.shear < 0.0);
  return closed;
}

/// The means of path_average() in place of the forces of the joint law; returns which contacts carry something on the way.
OPENCLOSE_KERNEL Mask find_mean_forces(const ContactBatch& c, TrialBatch& trial, Branch* branches) {
  const Lanes start = c.shift - c.normal * c.gap_off_target, end = start - c.normal * trial.gap_change;
  const Mask starts_closed = start + c.tension > 0.0, ends_closed = end + c.tension > 0.0;
  const StickingPath<Lanes> path(c, c, start, end, trial.gap_change, trial.slip_change);
  const Mask sticks = starts_closed & ends_closed & (c.dissipation == 0.0) & path.is_one;

  trial.normal = only_where(sticks, 0.5 * (path.normal_0 + path.normal_1));
  trial.shear = only_where(sticks, 0.5 * (path.shear_0 + path.shear_1));
  trial.normal_by_gap = only_where(sticks, path.normal_by_gap);
  trial.shear_by_gap = Lanes{};
  trial.shear_by_slip = only_where(sticks, path.shear_by_slip);
  write_branches(branches, sticks, Mask{}, Mask{});

  Mask carries = sticks;
  const Mask others = (starts_closed | ends_closed) & ~sticks;
  if (!any(others)) return carries;
  for (int k = 0; k < batch_size; ++k) {
    if (others[k] == 0) continue;
    const ContactForces mean = path_average_by_pieces(c.springs(k), c.strength(k), trial.gap_change[k], trial.slip_change[k], c.dissipation[k]).mean;
    trial.set_forces(k, mean);
    branches[k] = branch(mean);
    // Open at the end of the step, it may have carried a force on the way.
    carries[k] = mean.status != ContactStatus::open || mean.normal != 0.0 || mean.normal_by_gap != 0.0 ? -1 : 0;
  }
  return carries;
}

/// \param at  as in ContactBatch
OPENCLOSE_KERNEL Lanes& sums_at(ForceRow* rows, unsigned at, int lane) {
  static_assert(sizeof(ForceRow) == doubles_of_move * sizeof(double));
  double* const row = reinterpret_cast<double*>(rows) + at;
  return *reinterpret_cast<Lanes*>(lane % 2 == 0 ? row : row + batch_size);
}

/// Adds the forces of four contacts to their blocks, those of even and of odd lanes to sums of their own.
OPENCLOSE_KERNEL void push(const ContactBatch& c, const TrialBatch& trial, const ForcePlace<Lanes>& at, Lanes rounding, ForceRow* rows) {
  const ContactPush<Lanes> push(trial.normal, trial.shear, at);
  Lanes forward[] = {push.x, push.y, push.on_vertex, rounding}, back[] = {-push.x, -push.y, -push.on_edge, rounding};
  transpose(forward[0], forward[1], forward[2], forward[3]);
  transpose(back[0], back[1], back[2], back[3]);
  for (int k = 0; k < batch_size; ++k) {
    sums_at(rows, c.vertex_at[k], k) += forward[k];
    sums_at(rows, c.edge_at[k], k) += back[k];
  }
}

template <bool averaged>
OPENCLOSE_KERNEL double evaluate(double ramp, const std::vector<ContactBatch>& contacts, const BlockMove* moves, TrialBatch* trials, Branch* branches,
                                 ForceRow* rows) {
  Lanes largest{};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactBatch& c = contacts[i];
    TrialBatch& trial = trials[i];
    Branch* const now = branches + batch_size * i;
    const Moves vertex(moves, c.vertex_at), edge(moves, c.edge_at);
    const MovedContact<Lanes> moved(c, vertex, edge);
    trial.gap_change = moved.gap_change;
    trial.slip_change = moved.slip_change;
    const Mask carries = averaged ? find_mean_forces(c, trial, now) : find_forces(c, ramp, trial, now);
    if (averaged ? !any(carries) : all_are_open(now)) continue;
    const Lanes normal = magnitude(trial.normal), shear = magnitude(trial.shear);
    const Lanes stiffness = c.normal + c.normal_damping + c.shear + c.shear_damping;
    const Lanes rounding = only_where(carries, tolerance::rounding_of_sums * (stiffness * (vertex.bound + edge.bound) + normal + shear));
    push(c, trial, averaged ? mean_place(c, moved.at) : moved.at, rounding, rows);
    largest = larger(largest, larger(normal, shear));
  }
  return std::max({largest[0], largest[1], largest[2], largest[3]});
}

/// What one block of the matrix gets of four contacts, its entries column by column: for each contact in one piece once they are transposed.
struct Entries {
  Lanes first[batch_size], second[batch_size], last;

  OPENCLOSE_KERNEL void add_to(double* block, int lane) const {
    const Lanes a = load(block) + first[lane], b = load(block + batch_size) + second[lane];
    std::memcpy(block, &a, sizeof a);
    std::memcpy(block + batch_size, &b, sizeof b);
    block[dofs * dofs - 1] += last[lane];
  }
};

OPENCLOSE_KERNEL double* block(double* values, int slot) {
  return values + static_cast<std::ptrdiff_t>(dofs * dofs) * slot;
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
OPENCLOSE_KERNEL void add_stiffness(const std::vector<ContactBatch>& contacts, const BlockMove* moves, const std::vector<TrialBatch>& trials,
                                    const Branch* branches, const BatchTangent& tangent, const MatrixSlots& slots, double* values) {
  const Lanes zero{}, theta = all(tangent.end_weight);
  const ContactSlots* of_contacts = slots.of_contacts.data();
  const int* const diagonals = slots.diagonals.data();
  for (std::size_t i = 0; i < trials.size(); ++i, branches += batch_size, of_contacts += batch_size) {
    const TrialBatch& at = trials[i];
    if (adds_nothing(at, branches, tangent.open_ones_too)) continue;
    const ForcePlace<Lanes> pose = MovedContact<Lanes>(contacts[i], Moves(moves, contacts[i].vertex_at), Moves(moves, contacts[i].edge_at)).at;
    const ForcePlace<Lanes> acting = averaged ? mean_place(contacts[i], pose) : pose;
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

}  // namespace

OPENCLOSE_FOR_WIDE_REGISTERS_TOO double begin(std::vector<ContactBatch>& contacts) {
  Lanes largest{};
  for (ContactBatch& c : contacts) {
    const Lanes edge_x = c.normal_x, edge_y = c.normal_y, edge = length(edge_x, edge_y);
    // Places without a contact have no edge.
    c.normal_x = quotient(edge > 0.0, edge_y, edge);
    c.normal_y = quotient(edge > 0.0, -edge_x, edge);
    largest = larger(largest, larger(c.shift - c.normal * c.gap_off_target, magnitude(c.initial_shear)));
  }
  return std::max({largest[0], largest[1], largest[2], largest[3]});
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO double evaluate(bool averaged, double ramp, const std::vector<ContactBatch>& contacts, const BlockMove* moves,
                                                 std::vector<TrialBatch>& trials, std::vector<Branch>& branches, std::vector<ForceRow>& rows) {
  if (averaged) return evaluate<true>(ramp, contacts, moves, trials.data(), branches.data(), rows.data());
  return evaluate<false>(ramp, contacts, moves, trials.data(), branches.data(), rows.data());
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void find_elastic(double ramp, const std::vector<ContactBatch>& contacts, const std::vector<TrialBatch>& trials,
                                                   std::vector<ElasticBatch>& elastic) {
  for (std::size_t i = 0; i < elastic.size(); ++i) {
    const ContactBatch& c = contacts[i];
    const Lanes normal = elastic_normal_at(c, trials[i]);
    const Mask closed = ~spring_is_open(c.tension, normal);
    const ShearLimit limit(c.friction, c.cohesion, c.tension, trials[i].normal, ramp);
    elastic[i].normal = only_where(closed, normal);
    elastic[i].shear = only_where(closed, limit.of(elastic_shear_at(c, trials[i])));
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void add_stiffness(const std::vector<ContactBatch>& contacts, const BlockMove* moves,
                                                    const std::vector<TrialBatch>& trials, const std::vector<Branch>& branches,
                                                    const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) {
  if (matrix.rows() == 0) return;
  double* const values = matrix.value(0).data();
  // The symmetric tangent of means over a path knows one pose.
  if (tangent.exact && tangent.averaged) return add_stiffness<true>(contacts, moves, trials, branches.data(), tangent, slots, values);
  add_stiffness<false>(contacts, moves, trials, branches.data(), tangent, slots, values);
}

void TrialBatch::set_forces(int lane, const ContactForces& f) {
  normal[lane] = f.normal;
  shear[lane] = f.shear;
  normal_by_gap[lane] = f.normal_by_gap;
  shear_by_gap[lane] = f.shear_by_gap;
  shear_by_slip[lane] = f.shear_by_slip;
}

}  // namespace openclose
