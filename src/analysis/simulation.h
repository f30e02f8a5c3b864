// One scene in time: holds the block system and its contacts and takes steps. A step either succeeds as a whole or leaves no trace (but for what the
// linear solver keeps, which shows in the answer as far as Newton's method tolerates).
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "openclose/analysis/energy_ledger.h"
#include "openclose/analysis/resting.h"
#include "openclose/analysis/solved_step.h"
#include "openclose/analysis/step_cuts.h"
#include "openclose/analysis/step_control.h"
#include "openclose/contact/detection.h"
#include "openclose/core/memory.h"
#include "openclose/integrator/approach_bound.h"
#include "openclose/integrator/central_difference.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

/// [m] By which blocks of this size may move against each other before their contacts are found anew.
double default_contact_skin(const std::vector<BlockInput>& blocks);

/// Whether the start "settled" is found by another method than that of the motion.
bool is_settled_by_another(const Scene& scene);
/// The method that finds it: where it is another one, with what is chosen for every method, and the defaults of what is only for that of the motion.
MethodInput settling_method(const Scene& scene);

struct StepCounters {
  long steps = 0;
  long cuts = 0;                        ///< attempts thrown away
  long error_cuts = 0;                  ///< of these: because of step.error_tolerance_m
  long entry_cuts = 0;                  ///< of these: `hard`, because a corner entered a block that it was not in contact with
  long iterations = 0;                  ///< linear solves of the whole system, thrown-away attempts included
  long parts = 0;                       ///< of the system, solved for themselves between these
  long part_iterations = 0;             ///< linear solves of parts
  long part_rows = 0;                   ///< block rows in these
  long part_batches = 0;                ///< of four contacts, evaluated because parts have moved
  long part_batches_skipped = 0;        ///< not evaluated then, since nothing in them has moved
  long relaxation_steps = 0;            ///< evaluations of all forces in static steps that are relaxed, thrown-away attempts included
  long relaxation_estimates = 0;        ///< of the stiffness of the whole system, made for these
  long eased = 0;                       ///< steps of `hard` that were balanced with a longer ramp of the cohesion only
  long still = 0;                       ///< steps in which nothing happened, counted without being solved again
  long dissipative = 0;                 ///< steps of path_average that found a solution only with dissipation
  long loads = 0;                       ///< times the explicit loop took over the state anew
  long loads_skipped = 0;               ///< times it took over only contacts that were found anew
  long block_steps = 0;                 ///< moves of a block in all steps
  long block_steps_skipped = 0;         ///< not made because the block was at rest
  long put_to_rest = 0;                 ///< blocks that were put to rest
  long woken = 0;                       ///< blocks that were woken
  long repeated_to_wake = 0;            ///< steps that were done again because they woke blocks
  double smallest_critical_step = 0.0;  ///< [s] of explicit steps, 0 if there were none
  double longest_step = 0.0;            ///< [s] of explicit steps

  void add(const StepEffort& effort) {
    iterations += effort.iterations;
    parts += effort.parts;
    part_iterations += effort.part_iterations;
    part_rows += effort.part_rows;
    part_batches += effort.part_batches;
    part_batches_skipped += effort.part_batches_skipped;
    relaxation_steps += effort.relaxation_steps;
    relaxation_estimates += effort.estimates;
  }

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x] = *this;
    archive(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x);
  }
};

/// Wall time [s] of the stages; one thread.
struct StageTimes {
  double detection = 0.0;
  double solution = 0.0;
  double bookkeeping = 0.0;
};

struct StepResult {
  bool accepted = false;
  std::string reason;
  double unbalanced_force = 0.0;  ///< [N] largest sum of forces without inertia on a block; static and explicit steps only
  double moved = 0.0;             ///< [m] farthest way of a vertex, of refused steps too; 0 if nothing was solved
  double error = 0.0;             ///< [m] local error, see local_error(); only if the scene asks for adaptive steps
  bool too_wrong = false;         ///< refused because of it
  double part = 0.0;              ///< [-] refused: of the step, a length that is likely to be accepted; 0 if that is not known
  bool ends_at_entry = false;     ///< refused: `part` ends where a corner enters a block that it is not in contact with
  bool relisted = false;       ///< explicit: not taken, since it needed more contacts than were listed; now they are, and the critical step is known
  bool stops = false;          ///< explicit: taken, but nothing that follows can be right, for this reason
  bool lost_strength = false;  ///< a contact has lost its cohesion or tensile strength at the end of the step
};

class Simulation {
 public:
  using Unknowns = Motion::Unknowns;

  /// Throws InputError for an unknown enforcement or a missing joint. Explicit methods run in the loop of CentralDifference.
  explicit Simulation(Scene scene);
  /// With an enforcement of the caller's own, which solves every step itself, also if it is explicit; null: the one that the scene names.
  Simulation(Scene scene, std::unique_ptr<Enforcement> enforcement);

  /// One attempt at a step, or at the next stage of one where the integrator has several; advance() puts them together. Explicit methods do not look
  /// whether dt is below the critical step; they have no static steps.
  StepResult step(double dt, bool statics);
  /// Advances by exactly dt, in smaller steps where one does not converge or moves too far; false, with reason(), if that gets nowhere.
  bool advance(double dt);
  bool is_explicit() const { return loop_ != nullptr; }
  /// [s] Of the present contacts; explicit methods only.
  double critical_step();
  /// [s] step_fraction of it, with this damping of the motion: the longest step that advance() takes.
  double longest_stable_step(MassDamping damping);
  /// One step of the loop with this damping of the motion, for settling. The state stays in the loop: references to it that were taken before do not
  /// follow, asking again does. A step that is not taken because it was `relisted` is to be chosen again, from the critical step of more contacts.
  StepResult explicit_step(double h, MassDamping damping) { return explicit_step(h, damping, false); }
  /// From now on contacts lose neither cohesion nor tensile strength; explicit methods only.
  void keep_bonds(bool keep);
  /// Takes from every contact what its present status does not leave it.
  void judge_bonds();
  /// [N] Largest sum of forces on a block now; explicit methods only.
  double unbalanced_force();
  /// Names the present time, so that a long run's clock does not collect rounding.
  void set_time(double time) { time_ = time; }

  double time() const { return time_; }
  const std::string& reason() const { return reason_; }
  const Scene& scene() const { return scene_; }
  BlockSystem& system();
  const BlockSystem& system() const;
  JointTable& joints();
  const ExternalForces& external() const { return external_; }
  /// Contacts of the present positions. Reference valid until the next step.
  std::vector<Contact>& contacts();
  /// As the last step left them.
  const std::vector<Contact>& contacts() const;
  /// The same with those between blocks at rest, whose forces are the ones they were put to rest with.
  std::vector<Contact> every_contact() const;
  /// Pairs of blocks that may touch, see Detector::candidate_pairs().
  const std::vector<std::pair<int, int>>& candidate_pairs() const { return detector_.candidate_pairs(); }
  const Enforcement& enforcement() const { return *enforcement_; }
  /// The next step as it stands; for starts, and for those who want the tangent.
  StepProblem problem(double dt, bool statics);

  /// Velocity of block b at time() (the system's own may be half a step behind, see time_scheme.h).
  Unknowns velocity(int b) const;
  double stored_contact_energy() const;
  /// [N] What static steps may leave unbalanced on a block until this is called again; 0: the residual is solved for to the last, which rigid
  /// contacts do in any case.
  void neglect(double force) { negligible_force_ = force; }
  double force_scale() const;  ///< [N] weight of the heaviest free block, or the largest load or contact force if there is no gravity

  const EnergyLedger& ledger() const;
  double max_penetration() const;
  /// [-] `shi`: by how much of its work the friction of sliding contacts was not that of their normal force, but that of the pass before.
  double friction_lag() const { return friction_work_ > 0.0 ? lagging_friction_work_ / friction_work_ : 0.0; }
  const StepCounters& step_counters() const { return step_counters_; }
  const DetectionCounters& detection_counters() const { return detector_.counters(); }
  const StageTimes& stage_times() const { return stage_times_; }
  /// Of the arrays, each part as large as it has been after a step.
  const Memory& memory() const { return memory_; }

  /// Goes on with this method, from where blocks and contacts are. Both must have springs of the joints (Enforcement::has_joint_springs()). What was
  /// counted of linear equations is lost.
  void change_method(const MethodInput& method);
  /// Takes the blocks' velocities away; the kinetic energy goes to the ledger's scheme, as in static steps.
  void come_to_rest();
  /// From now on the base moves as the scene says, counted from time 0. Static steps know nothing of it.
  void start_base_motion() { base_moves_ = true; }
  /// From now on blocks may be put to rest, if the scene wants it, until somebody else changes something: who asks for a reference to blocks, joints
  /// or contacts that is no constant, or changes velocities, wakes all blocks.
  void allow_resting() { may_rest_ = scene_.method.skip_resting && !scene_.method.statics; }
  /// Declares the present moment the start: time 0, ledger empty. Positions, contacts and velocities stay.
  void restart_clock();
  /// Whether implicit steps enter the ledger until restart_clock(), from which on they always do: nobody asks for the energies of the way to an
  /// equilibrium.
  void book_steps(bool book) { books_steps_ = book; }
  /// [m] The scene's, or the default for its blocks.
  double contact_skin() const { return contact_skin_; }
  /// [J] What may be created in all. Once half of it has been, steps that go on creating energy are cut.
  void allow_energy(double energy) { cuts_.allow_energy(energy); }
  /// Gives block b this velocity at time(); to be followed by restart_clock().
  void set_velocity(int b, const Unknowns& velocity);
  /// Gives the blocks the velocities of the scene (settling has stopped them); to be followed by restart_clock().
  void restore_velocities();
  /// The blocks have been moved by other means: contacts are searched anew, keeping their history.
  void positions_changed();

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
  void restore(const Snapshot& snapshot);
  /// Whether a snapshot that was read is of these blocks.
  bool fits(const Snapshot& snapshot) const;

  /// Everything that the next steps depend on and all that has been counted, so that another simulation of the same scene goes on bit for bit; unlike
  /// save() it leaves everything as it is. The wall times of the stages are not in it.
  void exchange(Archive& archive);

 private:
  /// Those of the places to which their velocities carry the blocks within `lead` [s]: of what happens to a corner within a step, that it passes the
  /// end of an edge or comes to the next one, half is then seen too early where all would be seen too late. False if the list stays as it is.
  bool find_contacts(double lead);
  void detect(double lead);
  /// Whether the next step is one of method.first_integrator.
  bool is_beginning() const;
  std::unique_ptr<TimeScheme> make_scheme() const;
  void restart_scheme();
  /// Gives the external forces what the base does in the next step.
  /// True if blocks at rest were woken by it.
  bool move_base(double dt, bool statics);
  /// [s] A step that has failed is not cut to less.
  double shortest_step() const { return scene_.step.smallest_fraction * scene_.step.dt; }
  void accept(const StepProblem& problem, const StepSolution& solution);
  /// False: nothing of any contact has changed.
  bool accept_contacts(const StepSolution& solution);
  /// Gives the blocks their velocities; false: none has one.
  bool accept_velocities(const StepProblem& problem, const StepSolution& solution);
  /// Whether a step would repeat the last one, in which nothing happened, bit for bit.
  bool repeats_still_step(double dt) const { return scene_.method.skip_still_steps && dt == still_step_ && !scene_.base_motion; }
  StepResult repeat_still_step();
  /// What crossing_energy.h says of a contact, for steps taken one by one.
  void book_crossing(Contact& contact, const ContactOutcome& outcome, const Contact& start);
  bool advance_explicitly(double dt);
  void load_loop();
  bool renew_loop();
  /// [s] Longest fast step with the present list, see approach_bound.h.
  double approach_step();
  /// \param any_length  false: a step that is too long for what it comes near is relisted
  StepResult explicit_step(double h, MassDamping damping, bool any_length);
  /// What the loop finds too deep, with the remedy; empty if nothing is.
  std::string too_deep();
  StepProblem present_problem(double dt, bool statics) const;
  void store_energy(const StepProblem& problem, Contact& contact) const;
  /// Takes back what the loop has done since; it goes on from its own arrays.
  void collect() const;
  /// The same, and the loop takes over anew before its next step.
  void unload_loop();
  /// The same, and no block is at rest any more, because the caller may change what the steps work on.
  void take_back();
  /// Throws InputError if run.settled_by cannot find the equilibrium that the motion starts from.
  void check_settling() const;
  /// Of the blocks that move.
  /// \param lead  see find_contacts()
  std::vector<Contact>& moving_contacts(double lead = 0.0);
  double moving_contact_energy() const;
  /// Follows how quiet the blocks are and puts some to rest.
  void rest_after(double dt);
  void wake(const std::vector<int>& blocks);
  /// Judges what a step of dt does to the blocks at rest; true if some have been woken and it is to be done again.
  bool wake_in_haste(const StepSolution& solution, double dt);
  bool wake_by_forces(Resting::Urgency urgency);
  void divide();
  void count_moves();
  /// Writes down the kinetic energy of the blocks' velocities and what explicit steps add to it for the present moment.
  void book_kinetic_energy(double ahead) const;
  /// Velocities at the end of an explicit step taken by itself, half a step after those of the system, see CentralDifference::velocity_at_end().
  void take_end_of_explicit_step(const StepProblem& problem, const StepSolution& solution);
  /// The velocity at the end of a step goes on from that of its middle with the forces of the step. A blow is over then, and what it has changed is
  /// in the velocity of the middle: that part of going on is taken back.
  void end_of_blow(const Blow& blow);
  void note_memory();

  Scene scene_;
  const double contact_skin_;  ///< [m]
  // While the explicit loop runs it holds the state; what stands here is brought up to date by whoever asks for it.
  mutable BlockSystem system_;
  ExternalForces external_;
  JointTable joints_;
  std::unique_ptr<Enforcement> enforcement_;
  bool begins_;  ///< the scheme is method.first_integrator
  std::unique_ptr<TimeScheme> scheme_;
  StepSolution solution_;  ///< of the last step; a member for its memory
  Detector detector_;
  mutable std::vector<Contact> contacts_;
  bool contacts_current_ = false;
  mutable std::vector<Unknowns> output_velocity_;
  std::unique_ptr<CentralDifference> loop_;  ///< null for implicit methods
  mutable bool loop_is_ahead_ = false;       ///< of system_ and contacts_
  bool loop_is_loaded_ = false;
  StepCuts cuts_;
  EnergyLedger step_ledger_;                                           ///< of the last step that was solved
  ApproachBound approach_bound_;
  double held_step_ = 0.0;               ///< [s] last one that longest_stable_step() returned
  std::optional<double> approach_step_;  ///< [s] bound of the steps with the present list, if one of them was fast enough to need it
  Resting resting_;
  bool may_rest_ = false;
  bool base_moves_ = false;
  bool keep_bonds_ = false;
  double time_ = 0.0;
  std::string reason_;
  mutable EnergyLedger ledger_;
  double start_kinetic_energy_ = 0.0;              ///< [J]
  mutable double kinetic_ahead_ = 0.0;             ///< [J] in the ledger, see CentralDifference::kinetic_ahead()
  mutable double collected_contact_energy_ = 0.0;  ///< [J] stored when the loop was last collected from or loaded
  mutable double max_penetration_ = 0.0;
  double friction_work_ = 0.0, lagging_friction_work_ = 0.0;  ///< [J] see friction_lag()
  StepCounters step_counters_;
  double negligible_force_ = 0.0;  ///< [N]
  bool books_steps_ = true;
  double still_step_ = 0.0;        ///< [s] the last step, if nothing happened in it and nobody has changed anything since
  int failed_attempts_ = 0;  ///< since the last step that was accepted
  double last_speed_ = 0.0;  ///< [m/s] largest displacement of the last step over its duration
  StepControl control_;
  StageTimes stage_times_;
  std::size_t bytes_of_scene_;
  Memory memory_;
};

}  // namespace openclose
