#include "openclose/integrator/contact_batch.h"

#include <algorithm>
#include <cstring>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/lane_operations.h"
#include "openclose/law/path_average.h"

namespace openclose {
namespace {

using namespace lanes;
using Bytes = Branch __attribute__((vector_size(sizeof(Lanes))));
constexpr int entries = 9;  ///< of a block of the matrix, column by column

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

OPENCLOSE_KERNEL Lanes length(Lanes x, Lanes y) {
  return square_root(x * x + y * y);
}

/// As ContactStart.
OPENCLOSE_KERNEL double begin(ContactBatch* contacts, std::size_t count) {
  Lanes largest{};
  for (std::size_t i = 0; i < count; ++i) {
    ContactBatch& c = contacts[i];
    const Lanes edge_x = c.normal_x, edge_y = c.normal_y, edge = length(edge_x, edge_y);
    // Places without a contact have no edge.
    c.normal_x = edge > 0.0 ? edge_y / edge : Lanes{};
    c.normal_y = edge > 0.0 ? -(edge_x / edge) : Lanes{};
    largest = larger(largest, larger(c.shift - c.normal * c.gap_off_target, magnitude(c.initial_shear)));
  }
  return std::max({largest[0], largest[1], largest[2], largest[3]});
}

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

/// Each lane's branch in a byte of its own, at the place that it has in the list of branches.
template <Branch b>
OPENCLOSE_KERNEL Mask in_own_byte() {
  return (Mask)Bytes{b, 0, 0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0, 0, 0, 0, 0, b, 0, 0, 0, 0};
}
/// Writes the branches of four contacts, all others being open. A sliding contact is on minus its branch where it slides backward.
OPENCLOSE_KERNEL void write_branches(Branch* branches, Mask sticking, Mask sliding, Mask backward) {
  constexpr auto sticking_branch = static_cast<Branch>(ContactStatus::sticking);
  Mask all = (sticking & in_own_byte<sticking_branch>()) | (sliding & ~backward & in_own_byte<sliding_branch>()) |
             (sliding & backward & in_own_byte<static_cast<Branch>(-sliding_branch)>());
  all |= __builtin_shufflevector(all, all, 2, 3, 0, 1);
  all |= __builtin_shufflevector(all, all, 1, 0, 3, 2);
  std::memcpy(branches, &all, batch_size);
}
OPENCLOSE_KERNEL bool all_are_open(const Branch* branches) {
  int all;
  static_assert(sizeof all == batch_size * sizeof(Branch));
  std::memcpy(&all, branches, sizeof all);
  return all == 0;
}

/// What springs would carry that nothing bounds.
OPENCLOSE_KERNEL Lanes elastic_normal_at(const ContactBatch& c, const TrialBatch& trial) {
  return c.shift - c.normal * (c.gap_off_target + trial.gap_change);
}
OPENCLOSE_KERNEL Lanes elastic_shear_at(const ContactBatch& c, const TrialBatch& trial) {
  return c.initial_shear - c.shear * trial.slip_change;
}

OPENCLOSE_KERNEL void find_elastic(double ramp, const ContactBatch* contacts, const TrialBatch* trials, std::size_t count, ElasticBatch* elastic) {
  for (std::size_t i = 0; i < count; ++i) {
    const ContactBatch& c = contacts[i];
    const Lanes normal = elastic_normal_at(c, trials[i]);
    const Mask closed = ~spring_is_open(c.tension, normal);
    const ShearLimit limit(c.friction, c.cohesion, c.tension, trials[i].normal, ramp);
    elastic[i].normal = only_where(closed, normal);
    elastic[i].shear = only_where(closed, limit.of(elastic_shear_at(c, trials[i])));
  }
}

/// The joint law; returns which contacts are closed.
OPENCLOSE_KERNEL Mask find_forces(const ContactBatch& c, double ramp, TrialBatch& trial, Branch* branches) {
  const Lanes zero{};
  const Lanes elastic_normal = elastic_normal_at(c, trial);
  // By how much the gap is wider than where the spring opens; not a number where there is no contact.
  const Lanes parted = larger(zero, c.gap_off_target - (c.shift + c.tension) / c.normal);
  const Lanes viscous_normal = -c.normal_damping * (parted + trial.gap_change);
  const Lanes shear = elastic_shear_at(c, trial) + -c.shear_damping * trial.slip_change;
  const Mask closed = ~spring_is_open(c.tension, elastic_normal);

  const MohrCoulomb carried(c.friction, c.cohesion, c.tension, elastic_normal + viscous_normal, shear, ramp);
  const auto& limit = carried.limit;
  const Mask sticking = closed & carried.is_sticking, sliding = closed & ~sticking;

  const Mask spring_works = closed & ~((c.normal_damping > 0.0) & (carried.normal <= -c.tension));
  const Lanes normal_by_gap = only_where(spring_works, -(c.normal + c.normal_damping));
  const Lanes slope = only_where(limit.value > 0.0, limit.on_ramp < limit.on_slope ? limit.steep : c.friction);
  const Lanes signed_slope = (Lanes)((Mask)slope | ((Mask)shear & (Mask)-zero));
  trial.normal = only_where(closed, carried.normal);
  trial.shear = only_where(closed, carried.shear);
  trial.normal_by_gap = normal_by_gap;
  trial.shear_by_gap = only_where(sliding, signed_slope * normal_by_gap);
  trial.shear_by_slip = only_where(sticking, -(c.shear + c.shear_damping));

  write_branches(branches, sticking, sliding, carried.shear < 0.0);
  return closed;
}

/// The normal force at which the shear bound changes its slope.
OPENCLOSE_KERNEL Lanes kink_of_bound(const ContactBatch& c) {
  const Lanes lowest = c.friction * c.tension;
  const Lanes on_ramp = (c.cohesion - lowest) * tolerance::cohesion_ramp - c.tension;
  return c.cohesion > lowest ? on_ramp : (c.friction > 0.0 ? -c.cohesion / c.friction : -c.tension);
}

/// The means of path_average() in place of the forces of the joint law; returns which contacts carry something on the way.
OPENCLOSE_KERNEL Mask find_mean_forces(const ContactBatch& c, TrialBatch& trial, Branch* branches) {
  const Lanes zero{};
  const Lanes start = c.shift - c.normal * c.gap_off_target, end = start - c.normal * trial.gap_change;
  const Mask starts_closed = start + c.tension > 0.0, ends_closed = end + c.tension > 0.0;
  const Lanes viscous = c.normal_damping * trial.gap_change, first = start - viscous, last = end - viscous;
  const Lanes kink = kink_of_bound(c);
  const auto bound = [&](Lanes normal) { return ShearLimit(c.friction, c.cohesion, c.tension, normal, tolerance::cohesion_ramp).value; };
  const Lanes bound_0 = bound(first), bound_1 = bound(last);
  const Lanes shear_0 = c.initial_shear, shear_1 = shear_0 - c.shear * trial.slip_change;
  const Lanes viscous_shear = -c.shear_damping * trial.slip_change, total_0 = shear_0 + viscous_shear, total_1 = shear_1 + viscous_shear;
  const Mask no_kink = (first > -c.tension) & (last > -c.tension) & ~((kink - first) * (kink - last) < 0.0);
  const Mask within =
      (magnitude(shear_0) <= bound_0) & (magnitude(shear_1) <= bound_1) & (magnitude(total_0) <= bound_0) & (magnitude(total_1) <= bound_1);
  const Mask sticks = starts_closed & ends_closed & (c.dissipation == 0.0) & no_kink & within;

  trial.normal = sticks ? 0.5 * (first + last) : zero;
  trial.shear = sticks ? 0.5 * (total_0 + total_1) : zero;
  trial.normal_by_gap = sticks ? 0.5 * (-c.normal_damping + (-c.normal - c.normal_damping)) : zero;
  trial.shear_by_gap = zero;
  trial.shear_by_slip = sticks ? 0.5 * (-c.shear_damping + (-c.shear - c.shear_damping)) : zero;
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

/// Where the forces of four contacts act.
struct ActingPose {
  Lanes normal_x, normal_y, vertex_arm_x, vertex_arm_y, edge_arm_x, edge_arm_y;

  ActingPose() = default;
  OPENCLOSE_KERNEL explicit ActingPose(const Pose& t)
      : normal_x(t.normal_x),
        normal_y(t.normal_y),
        vertex_arm_x(t.vertex_arm_x),
        vertex_arm_y(t.vertex_arm_y),
        edge_arm_x(t.edge_arm_x),
        edge_arm_y(t.edge_arm_y) {}
  /// As mean_pose().
  OPENCLOSE_KERNEL ActingPose(const ContactBatch& c, const Pose& t)
      : normal_x(0.5 * (c.normal_x + t.normal_x)),
        normal_y(0.5 * (c.normal_y + t.normal_y)),
        vertex_arm_x(0.5 * (c.vertex_arm_x + t.vertex_arm_x)),
        vertex_arm_y(0.5 * (c.vertex_arm_y + t.vertex_arm_y)),
        edge_arm_x(0.5 * ((c.end_arm_x + c.lever_x) + t.edge_arm_x)),
        edge_arm_y(0.5 * ((c.end_arm_y + c.lever_y) + t.edge_arm_y)) {}
};

/// \param at  as in ContactBatch
OPENCLOSE_KERNEL Lanes& sums_at(ForceRow* rows, unsigned at, int lane) {
  static_assert(sizeof(ForceRow) == doubles_of_move * sizeof(double));
  double* const row = reinterpret_cast<double*>(rows) + at;
  return *reinterpret_cast<Lanes*>(lane % 2 == 0 ? row : row + batch_size);
}

/// Adds the forces of four contacts to their blocks, those of even and of odd lanes to sums of their own.
OPENCLOSE_KERNEL void push(const ContactBatch& c, const TrialBatch& trial, const ActingPose& at, Lanes rounding, ForceRow* rows) {
  const Lanes x = trial.normal * at.normal_x - trial.shear * at.normal_y, y = trial.normal * at.normal_y + trial.shear * at.normal_x;
  const Lanes on_vertex = at.vertex_arm_x * y - at.vertex_arm_y * x, on_edge = at.edge_arm_x * y - at.edge_arm_y * x;
  Lanes forward[] = {x, y, on_vertex, rounding}, back[] = {-x, -y, -on_edge, rounding};
  transpose(forward[0], forward[1], forward[2], forward[3]);
  transpose(back[0], back[1], back[2], back[3]);
  for (int k = 0; k < batch_size; ++k) {
    sums_at(rows, c.vertex_at[k], k) += forward[k];
    sums_at(rows, c.edge_at[k], k) += back[k];
  }
}

/// Batches go through the loops of evaluate() so many at a time: each loop is short enough for the processor to work on several of them at once, and
/// what one leaves to the next stays at hand.
constexpr std::size_t batches_at_once = 8;

template <StepForces forces>
OPENCLOSE_KERNEL double evaluate(double ramp, const ContactBatch* contacts, std::size_t count, const BlockMove* moves, double rounding_of_sums,
                                 TrialBatch* trials, Branch* branches, ForceRow* rows) {
  constexpr bool averaged = forces == StepForces::averaged;
  Lanes largest{}, moved[batches_at_once];
  ActingPose acting[batches_at_once];
  Mask carries[batches_at_once];
  for (std::size_t first = 0; first < count; first += batches_at_once) {
    const std::size_t at_once = std::min(batches_at_once, count - first);
    const ContactBatch* const starts = contacts + first;
    TrialBatch* const trial = trials + first;
    Branch* const branches_now = branches + batch_size * first;
    for (std::size_t i = 0; i < at_once; ++i) {
      const Moves vertex(moves, starts[i].vertex_at), edge(moves, starts[i].edge_at);
      const Pose pose(starts[i], vertex, edge);
      trial[i].gap_change = pose.gap_change;
      trial[i].slip_change = pose.slip_change;
      acting[i] = averaged ? ActingPose(starts[i], pose) : ActingPose(pose);
      moved[i] = vertex.bound + edge.bound;
    }
    for (std::size_t i = 0; i < at_once; ++i) {
      Branch* const now = branches_now + batch_size * i;
      carries[i] = averaged ? find_mean_forces(starts[i], trial[i], now) : find_forces(starts[i], ramp, trial[i], now);
    }
    for (std::size_t i = 0; i < at_once; ++i) {
      if (averaged ? !any(carries[i]) : all_are_open(branches_now + batch_size * i)) continue;
      const ContactBatch& c = starts[i];
      const Lanes normal = magnitude(trial[i].normal), shear = magnitude(trial[i].shear);
      const Lanes stiffness = c.normal + c.normal_damping + c.shear + c.shear_damping;
      const Lanes rounding = only_where(carries[i], rounding_of_sums * (stiffness * moved[i] + normal + shear));
      push(c, trial[i], acting[i], rounding, rows);
      largest = larger(largest, larger(normal, shear));
    }
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
    const ActingPose acting = averaged ? ActingPose(contacts[i], pose) : ActingPose(pose);
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

OPENCLOSE_FOR_WIDE_REGISTERS_TOO double begin_all(ContactBatch* contacts, std::size_t count) {
  return begin(contacts, count);
}
OPENCLOSE_FOR_WIDE_REGISTERS_TOO void find_all_elastic(double ramp, const ContactBatch* contacts, const TrialBatch* trials, std::size_t count,
                                                       ElasticBatch* elastic) {
  find_elastic(ramp, contacts, trials, count, elastic);
}
OPENCLOSE_FOR_WIDE_REGISTERS_TOO double evaluate_all(StepForces forces, double ramp, const ContactBatch* contacts, std::size_t count,
                                                     const BlockMove* moves, double rounding_of_sums, TrialBatch* trials, Branch* branches,
                                                     ForceRow* rows) {
  if (forces == StepForces::averaged) return evaluate<StepForces::averaged>(ramp, contacts, count, moves, rounding_of_sums, trials, branches, rows);
  return evaluate<StepForces::at_end>(ramp, contacts, count, moves, rounding_of_sums, trials, branches, rows);
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

double begin(std::vector<ContactBatch>& contacts) {
  return begin_all(contacts.data(), contacts.size());
}

double evaluate(StepForces forces, double ramp, const std::vector<ContactBatch>& contacts, const BlockMove* moves, double rounding_of_sums,
                std::vector<TrialBatch>& trials, std::vector<Branch>& branches, std::vector<ForceRow>& rows) {
  return evaluate_all(forces, ramp, contacts.data(), contacts.size(), moves, rounding_of_sums, trials.data(), branches.data(), rows.data());
}

void evaluate_one(StepForces forces, double ramp, const std::vector<ContactBatch>& contacts, std::size_t batch, const BlockMove* moves,
                  double rounding_of_sums, std::vector<TrialBatch>& trials, std::vector<Branch>& branches, std::vector<ForceRow>& rows) {
  evaluate_all(forces, ramp, &contacts[batch], 1, moves, rounding_of_sums, &trials[batch], &branches[batch_size * batch], rows.data());
}

void find_elastic(double ramp, const std::vector<ContactBatch>& contacts, const std::vector<TrialBatch>& trials, std::vector<ElasticBatch>& elastic) {
  find_all_elastic(ramp, contacts.data(), trials.data(), elastic.size(), elastic.data());
}

void add_stiffness(const std::vector<ContactBatch>& contacts, const BlockMove* moves, const std::vector<TrialBatch>& trials,
                   const std::vector<Branch>& branches, const BatchTangent& tangent, const MatrixSlots& slots, BlockMatrix& matrix) {
  if (matrix.rows() == 0) return;
  add_all_stiffness(contacts.data(), moves, trials.data(), trials.size(), branches.data(), tangent, slots, matrix.value(0).data());
}

double largest_force(const std::vector<TrialBatch>& trials) {
  Lanes largest{};
  for (const TrialBatch& trial : trials) largest = larger(largest, larger(magnitude(trial.normal), magnitude(trial.shear)));
  return std::max({largest[0], largest[1], largest[2], largest[3]});
}

ContactStrength ContactBatch::strength(int lane) const {
  ContactStrength s;
  s.friction = friction[lane];
  s.cohesion = cohesion[lane];
  s.tension = tension[lane];
  return s;
}

ContactSprings ContactBatch::springs(int lane) const {
  ContactSprings s;
  s.normal = normal[lane];
  s.shear = shear[lane];
  s.gap = gap_off_target[lane];
  s.shift = shift[lane];
  s.initial_shear = initial_shear[lane];
  s.normal_damping = normal_damping[lane];
  s.shear_damping = shear_damping[lane];
  s.dissipation = dissipation[lane];
  return s;
}

ContactForces TrialBatch::forces(int lane, Branch branch) const {
  ContactForces f;
  f.status = status(branch);
  f.normal = normal[lane];
  f.shear = shear[lane];
  f.normal_by_gap = normal_by_gap[lane];
  f.shear_by_gap = shear_by_gap[lane];
  f.shear_by_slip = shear_by_slip[lane];
  return f;
}

void TrialBatch::set_forces(int lane, const ContactForces& f) {
  normal[lane] = f.normal;
  shear[lane] = f.shear;
  normal_by_gap[lane] = f.normal_by_gap;
  shear_by_gap[lane] = f.shear_by_gap;
  shear_by_slip[lane] = f.shear_by_slip;
}

}  // namespace openclose
