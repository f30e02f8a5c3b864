// Steps that an enforcement solves for: soft, hard and shi. A step that fails moves no block and takes no history on; contacts
// that it has found anew, blocks that it has woken and counters stay, and what enforcement, step control and linear solver keep, which shows in the
// answer as far as Newton's method tolerates.
#pragma once

#include "openclose/analysis/simulation_state.h"
#include "openclose/analysis/step_control.h"
#include "openclose/analysis/step_cuts.h"
#include "openclose/analysis/step_result.h"

namespace openclose {

struct Blow;
struct LossesOfStep;

class SolvedStepper {
 public:
  /// The state must outlive the stepper.
  explicit SolvedStepper(SimulationState& state) : state_(state), control_(state.scene.step.error_tolerance) {}

  /// One attempt at a step, or at the next stage of one where the integrator has several; advance() puts them together.
  StepResult step(double dt, bool statics);
  /// Advances by exactly dt, in smaller steps where one does not converge or moves too far; false, with the reason in the state, if that gets
  /// nowhere.
  bool advance(double dt);
  /// The next step as it stands.
  StepProblem problem(double dt, bool statics);

  /// [N] What static steps may leave unbalanced on a block until this is called again; 0: the residual is solved for to the last, which rigid
  /// contacts do in any case.
  void neglect(double force) { negligible_force_ = force; }
  /// Whether steps enter the ledger until restart_ledger(), from which on they always do: nobody asks for the energies of the way to an equilibrium.
  void book_steps(bool book) { books_steps_ = book; }
  /// [J] What may be created in all. Once half of it has been, steps that go on creating energy are cut.
  void allow_energy(double energy) { cuts_.allow_energy(energy); }
  /// The ledger is empty again.
  void restart_ledger();
  /// The state has become another one.
  void forget();

  void exchange(Archive& archive);

 private:
  using Unknowns = Motion::Unknowns;

  void solve(const StepProblem& problem);
  // Each gives the reason for which the solution is not taken, and counts it.
  bool is_too_wrong(const StepProblem& problem, const LossesOfStep& lost, StepResult& result);
  bool enters_unseen(const StepProblem& problem, StepResult& result);
  bool is_no_step(StepResult& result);
  bool creates_energy(const StepProblem& problem, StepResult& result);
  /// [s] A step that has failed is not cut to less.
  double shortest_step() const { return state_.scene.step.smallest_fraction * state_.scene.step.dt; }
  /// [s] What to try after a step that was refused.
  double next_trial(double refused, const StepResult& result, bool adaptive, double dt);

  void accept(const StepProblem& problem);
  /// False: nothing of any contact has changed.
  bool accept_contacts(const StepProblem& problem);
  /// Gives the blocks their velocities; false: none has one.
  bool accept_velocities(const StepProblem& problem);
  /// The velocity at the end of a step goes on from that of its middle with the forces of the step. A blow is over then, and what it has changed is
  /// in the velocity of the middle: that part of going on is taken back.
  void end_of_blow(const Blow& blow);
  /// Whether a step would repeat the last one, in which nothing happened, bit for bit.
  bool repeats_still_step(double dt) const;
  StepResult repeat_still_step();
  /// Judges what a step of dt does to the blocks at rest; true if some have been woken and it is to be done again.
  bool wake_in_haste(double dt);

  SimulationState& state_;
  StepSolution solution_;     ///< of the last step; a member for its memory
  EnergyLedger step_ledger_;  ///< of the last step that was solved
  StepCuts cuts_;
  StepControl control_;
  double negligible_force_ = 0.0;  ///< [N]
  bool books_steps_ = true;
  double still_step_ = 0.0;  ///< [s] the last step, if nothing happened in it
  long still_since_ = 0;     ///< SimulationState::changes then
  int failed_attempts_ = 0;  ///< since the last step that was accepted
  double last_speed_ = 0.0;  ///< [m/s] largest displacement of the last step over its duration
};

}  // namespace openclose
