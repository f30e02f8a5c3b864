// One scene in time: the state of its blocks and contacts, and the stepper that carries it on, solving every step or in the explicit loop. Whoever
// reads changes nothing; what may be changed is handed out by functions with `change` in their names, after which nothing is taken for granted.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/explicit_stepper.h"
#include "openclose/analysis/settling_method.h"
#include "openclose/analysis/simulation_state.h"
#include "openclose/analysis/solved_stepper.h"

namespace openclose {

class Simulation {
 public:
  using Unknowns = Motion::Unknowns;

  /// Throws InputError for an unknown enforcement or a missing joint. Explicit methods run in the loop of CentralDifference.
  explicit Simulation(Scene scene);
  /// With an enforcement of the caller's own, which solves every step; null: the one that the scene names.
  Simulation(Scene scene, std::unique_ptr<Enforcement> enforcement);

  /// One attempt at a step, or at the next stage of one where the integrator has several; advance() puts them together. Explicit methods do not look
  /// whether dt is below the critical step; they have no static steps.
  StepResult step(double dt, bool statics);
  /// Advances by exactly dt, in smaller steps where one does not converge or moves too far; false, with reason(), if that gets nowhere.
  bool advance(double dt);
  /// Null for methods that solve every step.
  ExplicitStepper* explicit_stepper() { return explicit_.get(); }
  bool is_explicit() const { return explicit_ != nullptr; }
  SolvedStepper& solved_stepper() { return solved_; }
  /// The next step as it stands; for starts, and for those who want the tangent.
  StepProblem problem(double dt, bool statics);

  /// All of it. The explicit stepper must not have left it behind: std::logic_error if it has.
  const SimulationState& state() const;
  double time() const { return state_.time; }
  const std::string& reason() const { return state_.reason; }
  const Scene& scene() const { return state_.scene; }
  const BlockSystem& system() const { return state().system; }
  const JointTable& joints() const { return state_.joints; }
  const ExternalForces& external() const { return state_.external; }
  /// Of blocks that move, as the last step left them.
  const std::vector<Contact>& contacts() const { return state().contacts.moving; }
  const Enforcement& enforcement() const { return *state_.enforcement; }
  /// Velocity of block b at time() (the system's own may be half a step behind, see time_scheme.h).
  Unknowns velocity(int b) const { return state().output_velocity[static_cast<std::size_t>(b)]; }
  const EnergyLedger& ledger() const { return state().ledger; }
  double max_penetration() const { return state().max_penetration; }
  /// [-] `shi`: by how much of its work the friction of sliding contacts was not that of their normal force, but that of the pass before.
  double friction_lag() const { return state_.friction_work > 0.0 ? state_.lagging_friction_work / state_.friction_work : 0.0; }

  // Blocks, joints and contacts to be changed by the caller. No block is at rest any more.
  BlockSystem& change_system();
  JointTable& change_joints();
  /// Those of the present positions; the reference is valid until the next step.
  std::vector<Contact>& change_contacts();
  /// The blocks have been moved by other means: contacts are searched anew, keeping their history.
  void positions_changed();
  /// Gives block b this velocity at time(); to be followed by restart_clock().
  void set_velocity(int b, const Unknowns& velocity);
  /// Gives the blocks the velocities of the scene (settling has stopped them); to be followed by restart_clock().
  void restore_velocities();
  /// Takes the blocks' velocities away; the kinetic energy goes to the ledger's scheme, as in static steps.
  void come_to_rest();
  /// From now on; explicit methods only.
  void set_bonds(Bonds bonds) { taken_back().bonds = bonds; }
  /// Goes on with this method, from where blocks and contacts are. Both must have springs of the joints (Enforcement::has_joint_springs()). What was
  /// counted of linear equations is lost.
  void change_method(const MethodInput& method);
  /// Names the present time, so that a long run's clock does not collect rounding.
  void set_time(double time) { state_.time = time; }
  /// Declares the present moment the start: time 0, ledger empty. Positions, contacts and velocities stay.
  void restart_clock();
  /// From now on the base moves as the scene says, counted from time 0. Static steps know nothing of it.
  void start_base_motion() { state_.base_moves = true; }
  /// From now on blocks may be put to rest, if the scene wants it, until somebody else changes something.
  void allow_resting() { state_.may_rest = state_.scene.method.skip_resting && !state_.scene.method.statics; }

  /// Positions, contacts and the velocities at time().
  struct Snapshot {
    BlockSystem::State blocks;
    std::vector<Contact> contacts;

    void exchange(Archive& archive) {
      auto& [a, b] = *this;
      archive(a, b);
    }
  };
  Snapshot save();
  /// Takes from every contact what its present status does not leave it. One that sticks, but has gone farther since it carried what it did in `from`
  /// than its spring could carry, has slid; null: nothing is known of that.
  void judge_bonds(const Snapshot* from);
  void restore(const Snapshot& snapshot);
  /// Whether a snapshot that was read is of these blocks.
  bool fits(const Snapshot& snapshot) const;

  /// Everything that the next steps depend on and all that has been counted, so that another simulation of the same scene goes on bit for bit; unlike
  /// save() it leaves everything as it is. The wall times of the stages are not in it.
  void exchange(Archive& archive);

 private:
  /// For somebody who is going to change it.
  SimulationState& taken_back();

  SimulationState state_;
  SolvedStepper solved_;
  std::unique_ptr<ExplicitStepper> explicit_;
};

}  // namespace openclose
