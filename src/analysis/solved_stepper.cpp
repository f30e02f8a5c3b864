#include "openclose/analysis/solved_stepper.h"

#include <algorithm>
#include <cmath>

#include "openclose/analysis/solved_step.h"
#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// [-] of the largest displacement of a step, to be aimed at where steps have to be shorter.
constexpr double part_of_limit = 0.9;

/// [-] Of what slip takes from a joint, in one adaptive step: the strength is then too high by half of this on the average.
constexpr double most_weakening_in_a_step = 0.02;

/// [rad] No block that is in contact turns by more than this in a step: then other edges face each other than those whose contacts the step knows,
/// and a splinter that may turn as it likes finds states of balance after whole turns. Where facing edges have become corners, nothing is left of
/// them.
constexpr double largest_turn_in_contact_rad = tolerance::parallel_none_rad;

/// Whether a block that is in contact at the start or the end of a step turns by more than that.
bool turns_too_far(const BlockSystem& system, const std::vector<Contact>& contacts, const StepSolution& solution) {
  const auto turns = [&](int b) { return std::abs(Motion::rotation(solution.of(system, b))) > largest_turn_in_contact_rad; };
  if (std::ranges::none_of(system.free_blocks(), turns)) return false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const bool touches = contacts[i].status != ContactStatus::open || solution.contacts.status(i) != ContactStatus::open;
    if (touches && (turns(contacts[i].vertex_block) || turns(contacts[i].edge_block))) return true;
  }
  return false;
}

}  // namespace

void SolvedStepper::restart_ledger() {
  cuts_.restart_ledger();
  books_steps_ = true;
}

void SolvedStepper::forget() {
  failed_attempts_ = 0;
  cuts_.forget();
  last_speed_ = 0.0;
}

void SolvedStepper::exchange(Archive& archive) {
  if (still_since_ != state_.changes) still_step_ = 0.0;
  archive(failed_attempts_, cuts_, last_speed_, still_step_, step_ledger_, control_);
  still_since_ = state_.changes;
}

StepProblem SolvedStepper::problem(double dt, bool statics) {
  still_step_ = 0.0;
  if (state_.move_base(dt, statics)) state_.wake_all();
  state_.note_change();
  state_.find_contacts(statics ? 0.0 : state_.scene.step.look_ahead * dt);
  StepProblem p = state_.problem(dt, statics);
  p.failed_attempts = failed_attempts_;
  if (statics) p.heaviest_weight = state_.force_scale();
  // Elsewhere it would show in the places of the blocks.
  if (statics && state_.enforcement->has_elastic_contacts()) p.negligible_force = negligible_force_;
  if (!statics && state_.scheme->wants_accelerations()) {
    const Eigen::VectorXd force = forces_now(p, *state_.enforcement);
    for (int b : state_.system.free_blocks()) {
      const auto& block = state_.system.block(b);
      state_.scheme->start(b, force.segment<dofs>(dofs * block.equation).cwiseQuotient(block.mass));
    }
  }
  return p;
}

void SolvedStepper::solve(const StepProblem& problem) {
  const Stopwatch watch(state_.stage_times.solution);
  solution_.clear();
  state_.enforcement->solve(problem, solution_);
  state_.counters.add(solution_.effort);
  state_.note_memory({});
}

StepResult SolvedStepper::step(double dt, bool statics) {
  if (!statics && repeats_still_step(dt)) return repeat_still_step();
  if (statics) state_.take_back();
  const StepProblem p = problem(dt, statics);
  solve(p);
  if (solution_.converged && wake_in_haste(dt)) {
    ++state_.counters.repeated_to_wake;
    return step(dt, statics);
  }
  StepResult result;
  if (is_no_step(result)) return result;
  const LossesOfStep lost = losses(p, solution_, state_.enforcement->has_elastic_contacts());
  if (is_too_wrong(p, lost, result) || enters_unseen(p, result)) return result;
  const Stopwatch watch(state_.stage_times.bookkeeping);
  step_ledger_ = {};
  if (books_steps_) add_step(step_ledger_, p, solution_, *state_.scheme, state_.enforcement->has_elastic_contacts());
  if (creates_energy(p, result)) return result;
  if (statics) result.unbalanced_force = openclose::unbalanced_force(p, solution_);
  // What balances forces to this share of them balances strength to it.
  result.lost_strength = lost.any > state_.scene.settle.unbalanced_fraction;
  if (!statics) state_.fastest_weakening = std::max(state_.fastest_weakening, lost.along_slip);
  accept(p);
  result.accepted = true;
  state_.wake(state_.to_wake(Resting::Urgency::any));
  return result;
}

bool SolvedStepper::is_no_step(StepResult& result) {
  if (solution_.converged) {
    result.moved = largest_move(state_.system, solution_);
    const bool turned = turns_too_far(state_.system, state_.contacts.moving, solution_);
    if (!turned && result.moved <= state_.lengths.longest_displacement) return false;
    result.reason = turned ? "a block that is in contact turned by more than 15 degrees in one step"
                           : "a block moved farther in one step than step.max_displacement_m";
  } else {
    result.reason = solution_.reason;
  }
  result.part = solution_.part;
  ++state_.counters.cuts;
  ++failed_attempts_;
  return true;
}

bool SolvedStepper::is_too_wrong(const StepProblem& problem, const LossesOfStep& lost, StepResult& result) {
  if (problem.statics || !state_.scene.step.adaptive) return false;
  // The strength that a step has is the one before it. How much it lacks goes with its length, and the controller's errors with the third power.
  const double of_weakening = control_.tolerance() * std::pow(lost.along_slip / most_weakening_in_a_step, 3);
  result.error = std::max(local_error(problem, solution_), of_weakening);
  result.too_wrong = !(result.error <= control_.tolerance());
  if (!result.too_wrong) return false;
  result.reason = "the local error of a step stays above step.error_tolerance_m";
  ++state_.counters.cuts;
  ++state_.counters.error_cuts;
  return true;
}

bool SolvedStepper::enters_unseen(const StepProblem& problem, StepResult& result) {
  const double part = cuts_.part_before_entry(problem, solution_, *state_.enforcement, result.moved, state_.detector.candidate_pairs());
  if (part >= 1.0 || part * problem.dt < shortest_step()) return false;
  result.reason = "a corner enters a block that it is not in contact with";
  result.part = part;
  result.ends_at_entry = true;
  ++state_.counters.cuts;
  ++state_.counters.entry_cuts;
  cuts_.cut_at_entry(result.moved);
  return true;
}

bool SolvedStepper::creates_energy(const StepProblem& problem, StepResult& result) {
  if (!cuts_.creates_energy(problem, solution_, *state_.enforcement, state_.ledger, step_ledger_, shortest_step())) return false;
  result.reason = "a step creates energy";
  ++state_.counters.cuts;
  cuts_.cut_for_energy();
  return true;
}

bool SolvedStepper::repeats_still_step(double dt) const {
  return state_.scene.method.skip_still_steps && dt == still_step_ && still_since_ == state_.changes && !state_.scene.base_motion;
}

StepResult SolvedStepper::repeat_still_step() {
  if (books_steps_) state_.ledger += step_ledger_;
  state_.time += still_step_;
  ++state_.counters.steps;
  ++state_.counters.still;
  state_.count_moves();
  StepResult result;
  result.accepted = true;
  return result;
}

bool SolvedStepper::wake_in_haste(double dt) {
  BlockSystem& system = state_.system;
  if (system.resting_blocks().empty()) return false;
  std::vector<Unknowns>& pushes = state_.resting.pushes(system);
  for (std::size_t i = 0; i < state_.contacts.moving.size(); ++i) {
    const Contact& c = state_.contacts.moving[i];
    if (solution_.contacts.status(i) == ContactStatus::open || !(system.is_at_rest(c.vertex_block) || system.is_at_rest(c.edge_block))) continue;
    const ContactOutcome o = solution_.contacts[i];
    push_apart(c, o.pose, o.forces.normal, o.forces.shear, [&](int b, const Unknowns& force) {
      if (system.is_at_rest(b)) pushes[system.rest_number(b)] += force;
    });
  }
  state_.resting.judge(system, dt);
  const std::vector<int> woken = state_.to_wake(Resting::Urgency::in_haste);
  state_.wake(woken);
  return !woken.empty();
}

void SolvedStepper::accept(const StepProblem& problem) {
  if (books_steps_) state_.ledger += step_ledger_;
  const Enforcement& enforcement = *state_.enforcement;
  const bool may_be_still = moves_nothing(problem, solution_) && !cuts_.has_cut_at_entry() && state_.system.resting_blocks().empty();
  const bool may_be_struck = !problem.statics && !enforcement.has_elastic_contacts();
  const std::vector<Blow> struck = may_be_struck ? blows(problem, solution_) : std::vector<Blow>();
  const bool contacts_change = accept_contacts(problem), some_move = accept_velocities(problem);
  for (int b : state_.system.free_blocks()) state_.system.advance(b, solution_.of(state_.system, b));
  for (const Blow& blow : struck) end_of_blow(blow);
  if (!problem.statics) state_.scheme->accept(problem.dt);
  state_.book_kinetic_energy(0.0);
  state_.time += problem.dt;
  ++state_.counters.steps;
  state_.count_moves();
  if (!problem.statics) {
    state_.friction_work += solution_.friction_work;
    state_.lagging_friction_work += solution_.lagging_friction_work;
  }
  if (solution_.eased) ++state_.counters.eased;
  if (solution_.dissipative) ++state_.counters.dissipative;
  failed_attempts_ = 0;
  // The contact that the step has come to may be new to a pair that has hardly moved.
  if (cuts_.has_cut_at_entry()) state_.detector.look_again();
  cuts_.accept(state_.ledger);
  state_.contacts_current = false;
  still_step_ = may_be_still && !contacts_change && !some_move ? problem.dt : 0.0;
  still_since_ = state_.changes;
}

bool SolvedStepper::accept_contacts(const StepProblem& problem) {
  const bool elastic = state_.enforcement->has_elastic_contacts();
  bool some_change = false;
  for (std::size_t i = 0; i < state_.contacts.moving.size(); ++i) {
    Contact& c = state_.contacts.moving[i];
    const Contact start = c;
    c.status = solution_.contacts.status(i);
    c.joint_state = state_after(state_.joints.joint(c.joint), c.joint_state, c.status, friction_slip(problem, solution_, i, elastic));
    c.slack = solution_.contacts.slack(i);
    c.gap += solution_.contacts.gap_change(i);
    c.normal_force = c.shear_force = c.elastic_slip = c.stored_energy = 0.0;
    if (c.status != ContactStatus::open) {
      const CarriedForces f = solution_.contacts.forces(i);
      const double kn = solution_.contacts.normal_stiffness(i), ks = solution_.contacts.shear_stiffness(i);
      c.normal_force = f.normal;
      c.shear_force = f.shear;
      c.elastic_slip = -f.elastic_shear / ks;
      if (elastic) c.stored_energy = -c.crossing_energy + stored_energy(kn, ks, f.elastic_normal, f.elastic_shear);
      state_.max_penetration = std::max(state_.max_penetration, -c.gap);
    }
    some_change = some_change || !(c == start);
  }
  return some_change;
}

bool SolvedStepper::accept_velocities(const StepProblem& problem) {
  BlockSystem& system = state_.system;
  bool some = false;
  double dropped = 0.0;
  for (int b : system.free_blocks()) {
    const Unknowns d = solution_.of(system, b), v = problem.velocity(b), zero = Unknowns::Zero();
    Unknowns at_end = problem.statics ? zero : state_.scheme->velocity_at_end(b, problem.dt, d, v);
    Unknowns next = problem.statics ? zero : state_.scheme->next_velocity(b, problem.dt, d, v);
    if (!problem.statics && has_come_to_rest(problem, b, next)) {
      dropped += 0.5 * system.block(b).mass.dot(next.cwiseAbs2());
      at_end = next = zero;
    }
    state_.output_velocity[b] = at_end;
    system.set_velocity(b, next);
    if (!problem.statics) state_.scheme->record(b, problem.dt, d, v);
    some = some || !next.isZero(0.0);
  }
  state_.ledger.scheme += dropped;
  return some;
}

void SolvedStepper::end_of_blow(const Blow& blow) {
  if (state_.system.block(blow.block).equation < 0) return;
  Unknowns& velocity = state_.output_velocity[blow.block];
  velocity -= blow.part * (velocity - state_.system.velocity(blow.block));
}

double SolvedStepper::next_trial(double refused, const StepResult& result, bool adaptive, double dt) {
  if (result.too_wrong) {
    control_.refused(refused, result.error);
    return control_.step(dt);
  }
  const double trial = refused * (result.part > 0.0 ? result.part : state_.enforcement->step_cut(state_.scene.method));
  if (adaptive) control_.shorten(trial);
  return trial;
}

bool SolvedStepper::advance(double dt) {
  if (state_.begins != state_.is_beginning()) state_.restart_scheme();
  const bool statics = state_.scene.method.statics, adaptive = state_.scene.step.adaptive && !statics;
  double remaining = dt, trial = adaptive ? control_.step(dt) : dt;
  const double smallest = state_.scene.step.smallest_fraction * dt;
  const double furthest = state_.lengths.longest_displacement, limit = part_of_limit * furthest;
  bool ended_at_entry = false;  // the last attempt was cut there: what comes next has its contact and may be long
  while (remaining > 0.0) {
    trial = std::min(trial, remaining);
    // Blocks that move on as they did must not exceed the largest displacement; equal parts of what remains cost least and suit every scheme.
    if (last_speed_ * trial > furthest) trial = std::max(remaining / std::ceil(last_speed_ * remaining / limit), smallest);
    const double now = statics ? trial : state_.scheme->stage(trial);
    const StepResult result = step(now, statics);
    if (result.accepted) {
      last_speed_ = result.moved / now;
      // A rest below rounding is no step.
      remaining = remaining - now > tolerance::rounding_of_times * dt ? remaining - now : 0.0;
      if (state_.scheme->is_within_step()) continue;
      if (adaptive) control_.accepted(trial, result.error);
      trial = adaptive ? control_.step(dt) : ended_at_entry ? remaining : 2.0 * trial;
      ended_at_entry = false;
      continue;
    }
    state_.scheme->abandon_step();
    ended_at_entry = result.ends_at_entry;
    trial = next_trial(trial, result, adaptive, dt);
    if (trial < smallest) {
      state_.reason = result.reason;
      return false;
    }
  }
  state_.rest_after(dt);
  return true;
}

}  // namespace openclose
