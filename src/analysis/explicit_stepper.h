// Steps of the explicit method in the loop of CentralDifference. While the loop runs it holds the blocks, and the state lags behind; collect() brings
// the state up to date, and nothing of it may be read or changed before.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "openclose/analysis/simulation_state.h"
#include "openclose/analysis/step_result.h"
#include "openclose/integrator/approach_bound.h"
#include "openclose/integrator/central_difference.h"

namespace openclose {

class ExplicitStepper {
 public:
  /// The state must outlive the stepper.
  explicit ExplicitStepper(SimulationState& state) : state_(state), loop_(std::make_unique<CentralDifference>(state.lengths.contact_skin)) {}

  /// One step of the loop with this damping of the motion, which stays in the loop. It does not look whether h is below the critical step. A step
  /// that is not taken because it was `relisted` is to be chosen again, from the critical step of more contacts.
  StepResult step(double h, MassDamping damping) { return step(h, damping, false); }
  /// The same with any length: where it needs more contacts than are listed they are, and it is taken then. The state is up to date afterwards.
  StepResult step_of_any_length(double h);
  /// Advances by exactly dt, in steps below the critical one; false, with the reason in the state, if a step moves a block too far or nothing that
  /// follows can be right. The state is up to date afterwards.
  bool advance(double dt);
  /// [s] step_fraction of the critical step with this damping of the motion: the longest step that advance() takes.
  double longest_stable_step(MassDamping damping);
  double critical_step();                    ///< [s] of the present contacts; the state is up to date afterwards
  double unbalanced_force(double heaviest);  ///< [N] largest sum of forces on a block now, see ExplicitBlocks

  /// Brings the state up to date; the loop goes on from its own arrays.
  void collect();
  bool is_ahead() const { return is_ahead_; }  ///< of the state
  /// The state has become another one.
  void forget();

  void exchange(Archive& archive);

 private:
  static constexpr long never = -1;

  void load();
  /// Renews the list of contacts under the running loop; false if the loop is to take over everything anew.
  bool renew();
  bool is_loaded() const { return loaded_since_ == state_.changes; }
  /// [s] Longest fast step with the present list, see approach_bound.h.
  double approach_step();
  /// \param any_length  false: a step that is too long for what it comes near is relisted
  StepResult step(double h, MassDamping damping, bool any_length);
  Move move(double h, MassDamping damping, bool any_length);
  StepResult take(double h);
  void wake_by_forces(double h);
  /// What the loop finds too deep, with the remedy; empty if nothing is.
  std::string too_deep();

  SimulationState& state_;
  std::unique_ptr<CentralDifference> loop_;
  bool is_ahead_ = false;
  long loaded_since_ = never;  ///< SimulationState::changes then
  ApproachBound approach_bound_;
  double held_step_ = 0.0;                 ///< [s] last one that longest_stable_step() returned
  std::optional<double> approach_step_;    ///< [s] bound of the steps with the present list, if one of them was fast enough to need it
  double collected_contact_energy_ = 0.0;  ///< [J] stored when the loop was last collected from or loaded
};

}  // namespace openclose
