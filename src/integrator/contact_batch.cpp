#include "openclose/integrator/contact_batch.h"

#include <algorithm>
#include <cstring>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/batch_pose.h"
#include "openclose/integrator/lane_operations.h"
#include "openclose/law/path_average.h"

namespace openclose {
namespace {

using namespace lanes;
using Bytes = Branch __attribute__((vector_size(sizeof(Lanes))));

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
    c.normal_x = quotient(edge > 0.0, edge_y, edge);
    c.normal_y = quotient(edge > 0.0, -edge_x, edge);
    largest = larger(largest, larger(c.shift - c.normal * c.gap_off_target, magnitude(c.initial_shear)));
  }
  return std::max({largest[0], largest[1], largest[2], largest[3]});
}

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
  // By how much the gap is wider than where the spring opens.
  const Lanes parted = larger(zero, c.gap_off_target - quotient(c.normal > 0.0, c.shift + c.tension, c.normal));
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

/// The means of path_average() in place of the forces of the joint law; returns which contacts carry something on the way.
OPENCLOSE_KERNEL Mask find_mean_forces(const ContactBatch& c, TrialBatch& trial, Branch* branches) {
  const Lanes zero{};
  const Lanes start = c.shift - c.normal * c.gap_off_target, end = start - c.normal * trial.gap_change;
  const Mask starts_closed = start + c.tension > 0.0, ends_closed = end + c.tension > 0.0;
  const Lanes viscous = c.normal_damping * trial.gap_change, first = start - viscous, last = end - viscous;
  const Lanes kink = kink_of_bound(c.friction, c.cohesion, c.tension, tolerance::cohesion_ramp);
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

/// \param at  as in ContactBatch
OPENCLOSE_KERNEL Lanes& sums_at(ForceRow* rows, unsigned at, int lane) {
  static_assert(sizeof(ForceRow) == doubles_of_move * sizeof(double));
  double* const row = reinterpret_cast<double*>(rows) + at;
  return *reinterpret_cast<Lanes*>(lane % 2 == 0 ? row : row + batch_size);
}

/// Adds the forces of four contacts to their blocks, those of even and of odd lanes to sums of their own.
OPENCLOSE_KERNEL void push(const ContactBatch& c, const TrialBatch& trial, const ActingPose& at, Lanes rounding, ForceRow* rows) {
  const ContactPush<Lanes> push(trial.normal, trial.shear, at);
  Lanes forward[] = {push.x, push.y, push.on_vertex, rounding}, back[] = {-push.x, -push.y, -push.on_edge, rounding};
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
      acting[i] = averaged ? mean_acting_pose(starts[i], pose) : acting_pose(pose);
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
}  // namespace

double begin(std::vector<ContactBatch>& contacts) {
  return begin_all(contacts.data(), contacts.size());
}

double evaluate(StepForces forces, double ramp, const std::vector<ContactBatch>& contacts, const BlockMove* moves, double rounding_of_sums,
                std::vector<TrialBatch>& trials, std::vector<Branch>& branches, std::vector<ForceRow>& rows) {
  return evaluate_all(forces, ramp, contacts.data(), contacts.size(), moves, rounding_of_sums, trials.data(), branches.data(), rows.data());
}

void find_elastic(double ramp, const std::vector<ContactBatch>& contacts, const std::vector<TrialBatch>& trials, std::vector<ElasticBatch>& elastic) {
  find_all_elastic(ramp, contacts.data(), trials.data(), elastic.size(), elastic.data());
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

void TrialBatch::set_forces(int lane, const ContactForces& f) {
  normal[lane] = f.normal;
  shear[lane] = f.shear;
  normal_by_gap[lane] = f.normal_by_gap;
  shear_by_gap[lane] = f.shear_by_gap;
  shear_by_slip[lane] = f.shear_by_slip;
}

}  // namespace openclose
