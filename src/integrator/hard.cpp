// `hard`: no penetration beyond solver.gap_tolerance_m, by multipliers that are iterated within the step (method of multipliers with Newton inside).
//
// Each outer pass solves N = max(0, shift - k (gap - target)), T = clamp(initial shear - k s) and takes N, T as the next pass's shift and initial
// shear, in motion with momentum, see carry_on(). The passes converge whatever the stiffness k is (it only sets how fast), so the answer does not
// depend on the joint's stiffness: a closed contact keeps its gap, a sticking one its place, to the tolerance. In motion k is a multiple of the
// inertia, in proportion to the contact's length, in statics the joint's own stiffness: it decides how rigid contacts share what they leave
// undetermined. With springs that are as stiff at a short contact as at a long one a joint's short end gives its normal force away first, and its
// cohesion with it.
//
// In statics the blocks go back to their places with every pass, and what springs have stretched, slipped or parted is remembered instead, not only
// what they carry: the next pass starts from N - k gap and T - k s as they are, below zero where a contact is open and beyond its strength where it
// slides. With the forces alone every contact that slides would stand between sliding and sticking, and every open one between open and closed, and
// Newton's method would have to find out for each of them again. So the passes are the steps that `soft` would take to its rest, with one difference:
// the forces act on the blocks where they were. How far open contacts have parted in this way (their slack) is kept for the next step. Where contacts
// close within a step and stick, the passes may have no end, and stiff springs hold the blocks, see hold_by_stiff_springs().
//
// Gravity that comes at once, or a strength that is gone at once, asks a motion's step for all multipliers anew, and two things fail. Newton's method
// gets lost: where a contact that hardly carries turns its neighbours by its friction, which on the ramp of the cohesion is ten times its normal
// force, it has several states of balance, and residuals have minima between them. There the step is solved with a longer ramp first, from which the
// usual one is found. And the passes converge slowly: a column of n blocks yields n^2 times as much as one of them, so that springs that a block
// hardly feels are soft for it, and takes some n passes for all their momentum. But what is missing from the multipliers moves the blocks by less
// than is tolerated in a step that is short enough, and the next one goes on from there: such steps are cut to the length that the error tells, with
// softer springs that Newton's method takes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/hard_springs.h"
#include "openclose/integrator/momentum.h"
#include "openclose/integrator/newton.h"
#include "openclose/integrator/registry.h"
#include "openclose/integrator/spring_groups.h"

namespace openclose {
namespace {

/// [-] Stiffness of the springs inside, in motion over the inertia. Each outer pass reduces the error of the multipliers about by this factor. The
/// first is as high as Newton takes without more iterations; where it gets lost among the contact states, the softer ones are easier. (1,000 random
/// small scenes and seven slopes and piles: as much and as often to the end with 100 between the first two.)
constexpr std::array stiffness_over_inertia = {300.0, 30.0, 1.0};
/// [-] Statics: by which springs are multiplied, one after the other as long as no passes hold the contacts. On the springs of soft joints a slope
/// sinks by metres in the first pass, and the blocks do not fit each other where that has turned them.
constexpr std::array stiffer_static_springs = {1.0, 100.0};
/// Where softer springs were needed, the next steps begin with them. The next stiffer ones are tried again after a step, and after twice as many each
/// time that they fail, up to this number of times: however long it goes on, trials in vain cost a small part of the whole. 1,000 boxes that fall on
/// a heap took 0.67 of the iterations of a method that begins every step with the stiffest, failing slopes of 500 to 5,000 blocks 0.82 to 1.0, before
/// passes had momentum.
constexpr int most_failed_trials = 4;
/// [-] Where a surface begins to slip or to open, one contact after the other gives its force to the next, and a pass takes that on by one contact.
/// So the springs of single contacts become stiffer by this factor from pass to pass if their error is more than what is tolerated and hardly
/// becomes less, up to the stiffest over the inertia. (1,000 boxes that fall on a heap: 0.3 of the iterations.)
constexpr double stiffening = 3.0, stiffest_over_inertia = 1000.0;
/// [-] Instead of tolerance::cohesion_ramp where Newton's method gets lost: friction and cohesion together never grow faster than about the normal
/// force.
constexpr double long_cohesion_ramp = 1.0;
/// [m] The tolerance of statics: what passes leave there is a share of the forces themselves, on which hangs what joints lose their strength, and
/// there is no inertia to carry the rest.
constexpr double static_gap = 1e-11;
constexpr int most_outer_passes = 100;
/// Statics: solutions with springs that are stiffer from one to the next, if no passes hold the contacts. The first makes all of them stiffer, each
/// further one those of the few contacts that carry more than before.
constexpr int most_stiffenings = 6;
/// [-] A step that needs more of them in motion is repeated with the part of its length in which what multipliers lack would move the blocks by this
/// part of what is tolerated, the error going with the square of the length; at most the longest part. What would take less than the shortest is no
/// matter of its length: blocks that hit each other, whose impulse does not become less.
constexpr double aimed_error = 0.8, shortest_part = 1.0 / 32.0, longest_part = 0.5;
/// [-] Redundant contacts whose targets exclude each other by what earlier steps tolerated leave an error that no pass reduces: a pass that keeps
/// more than this part of the error ends the iteration if what is left is below this multiple of what is tolerated. In statics, whose tolerance is
/// far below that of motion, gaps that motion has left may exclude each other by more.
constexpr double slow_convergence = 0.5;
constexpr double incompatible_static_gaps = 100.0;  // of motion: incompatible_gaps
/// [-] Statics: passes whose error grows by more than this lead nowhere, and another step is tried. The passes are the proximal point iteration for
/// the multipliers, whose steps, in the energy of the springs, never grow while gaps and slips are linear in the way of the blocks and the contacts'
/// law has a potential (Rockafellar, Math. Oper. Res. 1 (1976) 97-116). Friction and turning blocks may add a little, less than what doubles the
/// error. Blocks that topple have jammed on what such passes pumped into their contacts.
constexpr double largest_growth_of_energy = 4.0;
/// [-] Statics: blocks that go farther than this part of their way in the last pass move on, and the next pass starts where they are; those that come
/// to rest leave about a thousandth from pass to pass. A step in which they move on is not the last one, and need not be more exact than motion is,
/// nor than this part of its way.
constexpr double going_on = 0.5, part_of_way = 0.01;

class Hard final : public Enforcement {
 public:
  ContactSprings springs(const StepProblem& problem, const Contact& contact) const override {
    return hard_springs_of_inertia(problem, contact, stiffness_over_inertia.front());
  }

  void solve(const StepProblem& problem, StepSolution& solution) override {
    if (problem.statics) {
      newton_.set_another_way(false);
      // Softer springs would take more passes.
      for (const double stiffer : stiffer_static_springs) {
        set_static_springs(problem, stiffer);
        pass_until_held(problem, Cohesion::as_it_is, solution);
        if (solution.converged) break;
        begin_anew(solution);
      }
      if (!solution.converged) hold_by_stiff_springs(problem, solution);
      if (solution.converged) note_slack(solution);
      return;
    }
    const std::size_t first = first_level(problem);
    for (std::size_t level = first; level < stiffness_over_inertia.size(); ++level) {
      set_springs(problem, stiffness_over_inertia[level]);
      newton_.set_another_way(level + 1 < stiffness_over_inertia.size());
      pass_until_held(problem, level == 0 ? Cohesion::as_it_is : Cohesion::may_be_eased, solution);
      if (solution.converged || solution.part > 0.0) {  // with softer springs the passes are even slower
        if (first < level_) failed_trials_ = level > first ? std::min(failed_trials_ + 1, most_failed_trials) : 0;
        level_ = level;
        return;
      }
    }
  }

  std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const override {
    refuse_integrators(method);
    return make_midstep_scheme();
  }
  bool has_elastic_contacts() const override { return false; }
  LinearCounters linear_counters() const override { return newton_.linear_counters(); }
  Memory memory() const override {
    Memory of = newton_.memory();
    of.contacts += bytes_of(springs_, carried_);
    return of;
  }
  void exchange(Archive& archive) override {
    newton_.exchange(archive);
    archive(level_, failed_trials_, steps_since_trial_);
    const bool is_level = level_ < stiffness_over_inertia.size() && failed_trials_ >= 0 && failed_trials_ <= most_failed_trials;
    archive.require(is_level && steps_since_trial_ >= 0 && steps_since_trial_ < 1 << failed_trials_,
                    "the saved state has springs of hard contacts that there are not");
  }

 private:
  /// Of stiffness_over_inertia: what an attempt at a step begins with, which is what the last one ended with, or a trial of the next stiffer ones.
  std::size_t first_level(const StepProblem& problem) {
    if (level_ == 0 || problem.failed_attempts > 0 || ++steps_since_trial_ < 1 << failed_trials_) return level_;
    steps_since_trial_ = 0;
    return level_ - 1;
  }

  /// Whether the first pass may take the longer ramp.
  enum class Cohesion { as_it_is, may_be_eased };

  void set_springs(const StepProblem& problem, double ratio) {
    springs_.resize(problem.contacts.size());
    for (std::size_t c = 0; c < springs_.size(); ++c) springs_[c] = hard_springs_of_inertia(problem, problem.contacts[c], ratio);
  }

  /// What blocks that hang together leave undetermined they share as the springs of their joints would: all of these become stiffer by one factor,
  /// until around each block their mean is stiff over its inertia.
  void set_static_springs(const StepProblem& problem, double stiffer) {
    const SpringGroups groups(problem, stiffness_over_inertia.front());
    springs_.resize(problem.contacts.size());
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const Contact& contact = problem.contacts[c];
      const double relative = problem.joints.joint(contact.joint).normal_stiffness / groups.stiffest_joint(contact);
      // Contacts that are short beside the others of their block have springs as in motion, the first of those that Newton takes more easily.
      const double least = stiffer * stiffness_over_inertia[1] * relative * inertia_at(problem, contact);
      springs_[c] = hard_springs_of_joint(problem, contact, stiffer * groups.factor(contact), least);
    }
  }

  /// Passes until the contacts are held.
  void pass_until_held(const StepProblem& problem, Cohesion cohesion, StepSolution& solution) {
    // From the drift dt v: the stiff matrix costs digits of what is solved for, and these are better lost from the change of motion than from the
    // motion.
    solution.d = drift(problem);
    solution.eased = false;
    Eigen::VectorXd first;                                      // where the first pass of statics has brought the blocks
    double last_way = std::numeric_limits<double>::infinity();  // [m] of the farthest block in the last pass
    double last_error = std::numeric_limits<double>::infinity(), least_error = last_error, last_energy = last_error;
    std::vector<float> errors;  // [-] of the contacts in the last pass
    for (int pass = 0; pass < most_outer_passes; ++pass) {
      solve_pass(problem, pass, pass > 0 ? Cohesion::may_be_eased : cohesion, solution);
      if (!solution.converged) {
        if (pass > 0) solution.part = shorter(least_error);
        return;
      }
      const auto [error, energy] = misfit(problem, solution);
      const double way = solution.d.lpNorm<Eigen::Infinity>();
      const bool moves_on = problem.statics && way >= going_on * last_way;
      if (problem.statics && energy > largest_growth_of_energy * last_energy && error > incompatible_static_gaps) break;
      if (error <= 1.0) return;
      if (error > slow_convergence * last_error && error <= (problem.statics ? incompatible_static_gaps : incompatible_gaps)) return;
      if (moves_on && error * tolerated(problem) <= std::min(problem.method.gap_tolerance, part_of_way * way)) return;
      if (problem.statics) {
        for (std::size_t c = 0; c < springs_.size(); ++c) remember(solution.contacts, c);
      } else {
        carry_on(solution.contacts, pass);
        if (error > incompatible_gaps) stiffen(problem, solution, errors);
      }
      if (pass == 0) first = solution.d;
      if (pass == 1 && problem.statics && !moves_on) straighten(problem, solution, first);
      if (problem.statics && !moves_on) solution.d.setZero();
      last_error = error;
      least_error = std::min(least_error, error);
      last_energy = energy;
      last_way = way;
    }
    if (!problem.statics) solution.part = shorter(least_error);
    give_up(solution);
  }

  static void begin_anew(StepSolution& solution) {
    const StepEffort before = solution.effort;
    solution.clear();
    solution.effort = before;
  }

  static void give_up(StepSolution& solution) {
    solution.converged = false;
    solution.reason = "the multipliers of hard contacts did not converge";
  }

  /// Contacts that close, and stick from there, may ask for places that exclude each other, and no passes come to an end. Then springs hold the
  /// blocks: those of the joints, made stiffer by one factor until what they close by in this step is part of the tolerance. Contacts of small
  /// tributary length that still give way become stiffer by themselves.
  void hold_by_stiff_springs(const StepProblem& problem, StepSolution& solution) {
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const Contact& contact = problem.contacts[c];
      springs_[c] = hard_springs_of_joint(problem, contact, 1.0, 0.0);
      if (contact.status == ContactStatus::open) {
        springs_[c].shift = 0.0;
      } else {
        springs_[c].target = held_gap(problem, contact);
      }
    }
    solution.d = drift(problem);
    newton_.solve(problem, springs_, solution);
    const double tolerated = kept_penetration * problem.method.gap_tolerance;
    const double common = largest_closure(solution) / tolerated;
    for (int round = 0; solution.converged && round < most_stiffenings; ++round) {
      bool is_held = true;
      for (std::size_t c = 0; c < springs_.size(); ++c) {
        const double factor = round == 0 ? common : closure(solution, c) / tolerated;
        if (factor <= 1.0) continue;
        springs_[c].normal *= stiffening * factor;
        springs_[c].shear *= stiffening * factor;
        is_held = false;
      }
      if (is_held) return;
      solution.d = drift(problem);
      newton_.solve_again(springs_, solution, FirstTangent::present);
    }
    if (solution.converged && largest_closure(solution) > incompatible_gaps * problem.method.gap_tolerance) give_up(solution);
  }

  /// [m] Of all contacts that carry.
  double largest_closure(const StepSolution& solution) const {
    double largest = 0.0;
    for (std::size_t c = 0; c < springs_.size(); ++c) largest = std::max(largest, closure(solution, c));
    return largest;
  }

  /// [m] Of a contact that carries: by how much it misses its target gap.
  double closure(const StepSolution& solution, std::size_t c) const {
    if (solution.contacts.status(c) == ContactStatus::open) return 0.0;
    return std::abs(springs_[c].gap - springs_[c].target + solution.contacts.gap_change(c));
  }

  /// One pass. Where Newton's method gets lost with the cohesion as it is, and from a solution with the longer ramp, too, the latter stands for this
  /// step.
  void solve_pass(const StepProblem& problem, int pass, Cohesion cohesion, StepSolution& solution) {
    const Eigen::VectorXd start = solution.d;
    if (!solution.eased) {
      if (pass == 0) {
        newton_.solve(problem, springs_, solution);
      } else {
        // In statics the blocks are back in their places, where contacts remember their state.
        newton_.solve_again(springs_, solution, problem.statics ? FirstTangent::present : FirstTangent::last_solution);
      }
      if (solution.converged || problem.statics || cohesion == Cohesion::as_it_is) return;
    }
    solution.contacts.set_cohesion_ramp(long_cohesion_ramp);
    solution.d = start;
    newton_.solve_again(springs_, solution,
                        solution.eased ? FirstTangent::last_solution
                        : pass == 0    ? FirstTangent::last_step
                                       : FirstTangent::present);
    solution.contacts.set_cohesion_ramp(tolerance::cohesion_ramp);
    if (!solution.converged || solution.eased) return;
    StepSolution eased = solution;
    newton_.solve_again(springs_, solution, FirstTangent::present);
    if (solution.converged) return;
    eased.effort = solution.effort;
    eased.eased = true;
    std::swap(solution, eased);
  }

  /// [-] Part of a step with this error that is likely to do.
  static double shorter(double error) {
    const double part = std::sqrt(aimed_error / error);
    return part >= shortest_part ? std::min(part, longest_part) : longest_part;
  }

  /// Motion: what the springs of the next pass start from, which is what they carry now and, by the momentum of the passes, a part of what that has
  /// become more since the last one. The passes are the proximal point iteration for the multipliers, which leaves an error that falls with the
  /// number of passes; with momentum it falls with the square of it (O. Gueler, New proximal point algorithms for convex minimization, SIAM J. Optim.
  /// 2 (1992) 649-664). The theorem is for a law with a potential, which friction has not, and for springs that stay as they are, see stiffen():
  /// momentum begins anew where a pass turns against it, measured in what the springs store.
  void carry_on(const ContactTrial& contacts, int pass) {
    if (pass == 0) {
      momentum_.restart();
      carried_.resize(springs_.size());
      for (std::size_t c = 0; c < springs_.size(); ++c) carried_[c] = {springs_[c].shift, springs_[c].initial_shear};
    }
    double turn = 0.0;  // [J]
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const ContactSprings& s = springs_[c];
      const CarriedForces now = contacts.forces(c);
      turn += (s.shift - now.normal) * (now.normal - carried_[c].normal) / s.normal;
      turn += (s.initial_shear - now.shear) * (now.shear - carried_[c].shear) / s.shear;
    }
    if (turn > 0.0) momentum_.restart();
    const double again = momentum_.next();
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const CarriedForces now = contacts.forces(c);
      springs_[c].shift = now.normal + again * (now.normal - carried_[c].normal);
      springs_[c].initial_shear = now.shear + again * (now.shear - carried_[c].shear);
      carried_[c] = {now.normal, now.shear};
    }
  }

  /// Statics: what the springs of the next pass start from.
  void remember(const ContactTrial& contacts, std::size_t c) {
    ContactSprings& s = springs_[c];
    const CarriedForces forces = contacts.forces(c);
    if (forces.status == ContactStatus::open) {
      // A gap that was there before is one on every pass; only what has come to it is remembered.
      const double parted = contacts.gap_change(c) + std::min(0.0, s.gap - s.target);
      s.shift = std::min(0.0, s.shift - s.normal * parted);
      s.initial_shear = 0.0;
    } else {
      s.shift = forces.normal;
      s.initial_shear -= s.shear * contacts.slip_change(c);
    }
  }

  /// The springs of contacts whose error the last pass has hardly reduced become stiffer.
  /// \param errors  [-] of the pass before, if any; becomes that of the last one
  void stiffen(const StepProblem& problem, const StepSolution& solution, std::vector<float>& errors) {
    errors.resize(springs_.size(), std::numeric_limits<float>::max());
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const auto error = static_cast<float>(constraint_error(problem, solution, c));
      const bool is_slow = error > 1.0F && error > slow_convergence * errors[c];
      errors[c] = error;
      const double stiffer = stiffening * springs_[c].normal;
      if (is_slow && stiffer <= stiffest_over_inertia * inertia_at(problem, problem.contacts[c])) springs_[c].normal = springs_[c].shear = stiffer;
    }
  }

  /// Takes from what closed contacts remember of the first pass that they turned on its way. What rigid contacts leave undetermined is then shared as
  /// springs do whose changes of gap and slip are linear in the motion of the blocks, which is the same however stiff they are.
  void straighten(const StepProblem& problem, const StepSolution& solution, const Eigen::VectorXd& first) {
    StepSolution turned;
    turned.d = first;
    const RotationKind kind = problem.system.rotation_kind();
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      if (solution.contacts.status(c) == ContactStatus::open) continue;
      const Contact& contact = problem.contacts[c];
      const auto of_vertex = turned.of(problem.system, contact.vertex_block), of_edge = turned.of(problem.system, contact.edge_block);
      const ContactStart start(problem.system, contact);
      const BlockMove vertex(of_vertex, kind, problem.system.block(contact.vertex_block).radius);
      const BlockMove edge(of_edge, kind, problem.system.block(contact.edge_block).radius);
      const ContactPose before(start, {}, {}), after(start, vertex, edge);
      springs_[c].shift += springs_[c].normal * (after.gap_change - before.normal_way(of_vertex, of_edge));
      springs_[c].initial_shear += springs_[c].shear * (after.slip_change - before.shear_way(of_vertex, of_edge));
    }
  }

  void note_slack(StepSolution& solution) const {
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      if (solution.contacts.status(c) == ContactStatus::open) solution.contacts.set_slack(c, std::max(0.0, -springs_[c].shift / springs_[c].normal));
    }
  }

  /// [m]
  static double tolerated(const StepProblem& problem) {
    return problem.statics ? std::min(static_gap, problem.method.gap_tolerance) : problem.method.gap_tolerance;
  }

  struct Misfit {
    double error = 0.0;   ///< [-] the largest of a contact
    double energy = 0.0;  ///< [N/m] of all, their springs' stiffness times the square of the error
  };
  Misfit misfit(const StepProblem& problem, const StepSolution& solution) const {
    Misfit of;
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const double error = constraint_error(problem, solution, c);
      of.error = std::max(of.error, error);
      of.energy += springs_[c].normal * error * error;
    }
    return of;
  }

  /// [-] Error of contact c over what is tolerated: closed contacts off their target gaps, sticking ones off their places. Where more than forces is
  /// remembered also open ones that penetrate and sliding ones that go against their friction.
  double constraint_error(const StepProblem& problem, const StepSolution& solution, std::size_t c) const {
    const CarriedForces forces = solution.contacts.forces(c);
    const double off_target = (springs_[c].gap - springs_[c].target) + solution.contacts.gap_change(c);
    double error;
    if (forces.status == ContactStatus::open) {
      error = -off_target;
    } else {
      const double change = solution.contacts.slip_change(c);
      const double slip = forces.status == ContactStatus::sticking ? std::abs(change) : std::copysign(1.0, forces.shear) * change;
      // What is pushed out by that part of the tolerance may miss it by no more, or a force that grows from step to step drives it in.
      const bool is_pushed_out = !problem.statics && springs_[c].gap < springs_[c].target;
      const double inward = is_pushed_out ? -off_target / recovered_penetration : 0.0;
      error = std::max({std::abs(off_target), slip, inward});
    }
    if (error <= 0.0) return 0.0;
    const double rounding = tolerance::rounding_of_sums * coordinates(problem, solution, problem.contacts[c]);
    return error / std::max(tolerated(problem), rounding);
  }

  /// [m] the coordinates and displacements of which a gap is the small difference; two contacts at one place differ by their rounding.
  static double coordinates(const StepProblem& problem, const StepSolution& solution, const Contact& contact) {
    double sum =
        problem.system.position(contact.vertex_block, contact.vertex).norm() + problem.system.position(contact.edge_block, contact.edge).norm();
    for (int b : {contact.vertex_block, contact.edge_block}) {
      sum += Motion::displacement_bound(solution.of(problem.system, b), problem.system.block(b).radius);
    }
    return sum;
  }

  Newton newton_;
  struct Multipliers {
    double normal, shear;  ///< [N]
  };
  std::vector<ContactSprings> springs_;
  std::vector<Multipliers> carried_;  ///< by the contacts in the last pass of a step in motion
  Momentum momentum_;
  std::size_t level_ = 0;  ///< of stiffness_over_inertia, in the last attempt at a step in motion
  int failed_trials_ = 0;  ///< of stiffer springs, in a row
  int steps_since_trial_ = 0;
};

}  // namespace

std::unique_ptr<Enforcement> make_hard() {
  return std::make_unique<Hard>();
}

}  // namespace openclose
