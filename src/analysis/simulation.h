// One scene in time: holds the block system and its contacts and takes steps. A step either succeeds as a whole or leaves no trace.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "openclose/analysis/energy_ledger.h"
#include "openclose/contact/detection.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

struct StepCounters {
  long steps = 0;
  long cuts = 0;        ///< attempts thrown away
  long iterations = 0;  ///< linear solves, thrown-away attempts included
  long compliant = 0;   ///< steps of `hard` whose multipliers did not converge: taken with springs
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
  double unbalanced_force = 0.0;  ///< [N] largest sum of forces without inertia on a block; static steps only
  double moved = 0.0;             ///< [m] farthest way of a vertex, of refused steps too; 0 if nothing was solved
  bool lost_strength = false;     ///< a contact has lost its cohesion or tensile strength at the end of the step
};

template <int N>
class Simulation {
 public:
  using Unknowns = typename Motion<N>::Unknowns;

  /// Throws InputError for an unknown enforcement or a missing joint.
  explicit Simulation(const Scene& scene);
  /// With an enforcement of the caller's own.
  Simulation(const Scene& scene, std::unique_ptr<Enforcement<N>> enforcement);

  /// One attempt at a step.
  StepResult step(double dt, bool statics);
  /// Advances by exactly dt, in smaller steps where one does not converge or moves too far; false, with reason(), if that gets nowhere.
  bool advance(double dt);
  /// Names the present time, so that a long run's clock does not collect rounding.
  void set_time(double time) { time_ = time; }

  double time() const { return time_; }
  const std::string& reason() const { return reason_; }
  const Scene& scene() const { return scene_; }
  BlockSystem<N>& system() { return system_; }
  const BlockSystem<N>& system() const { return system_; }
  JointTable& joints() { return joints_; }
  const ExternalForces<N>& external() const { return external_; }
  /// Contacts of the present positions. Reference valid until the next step.
  std::vector<Contact>& contacts();
  const Enforcement<N>& enforcement() const { return *enforcement_; }
  /// The next step as it stands; for starts, and for those who want the tangent.
  StepProblem<N> problem(double dt, bool statics);

  /// Velocity of block b at time() (the system's own may be half a step behind, see time_scheme.h).
  Unknowns velocity(int b) const { return output_velocity_[b]; }
  double stored_contact_energy() const;
  double force_scale() const;  ///< [N] weight of the heaviest free block, or the largest load or contact force if there is no gravity

  const EnergyLedger& ledger() const { return ledger_; }
  double max_penetration() const { return max_penetration_; }
  const StepCounters& step_counters() const { return step_counters_; }
  const DetectionCounters& detection_counters() const { return detector_.counters(); }
  const StageTimes& stage_times() const { return stage_times_; }

  /// Declares the present moment the start: time 0, ledger empty. Positions, contacts and velocities stay.
  void restart_clock();
  /// Gives block b this velocity at time(); to be followed by restart_clock().
  void set_velocity(int b, const Unknowns& velocity) { output_velocity_[b] = velocity; }
  /// Gives the blocks the velocities of the scene (settling has stopped them); to be followed by restart_clock().
  void restore_velocities();
  /// The blocks have been moved by other means: contacts are searched anew, keeping their history.
  void positions_changed() { contacts_current_ = false; }

  /// Positions, contacts and the velocities at time().
  struct Snapshot {
    typename BlockSystem<N>::State blocks;
    std::vector<Contact> contacts;
  };
  Snapshot save();
  void restore(const Snapshot& snapshot);

 private:
  void detect();
  void restart_scheme();
  double largest_move(const StepSolution<N>& solution) const;
  double unbalanced_force(const StepProblem<N>& problem, const StepSolution<N>& solution) const;
  void accept(const StepProblem<N>& problem, const StepSolution<N>& solution);
  void accept_contacts(const StepSolution<N>& solution);
  bool loses_strength(const StepSolution<N>& solution) const;

  Scene scene_;
  BlockSystem<N> system_;
  ExternalForces<N> external_;
  JointTable joints_;
  std::unique_ptr<Enforcement<N>> enforcement_;
  std::unique_ptr<TimeScheme<N>> scheme_;
  Detector<N> detector_;
  std::vector<Contact> contacts_;
  bool contacts_current_ = false;
  std::vector<Unknowns> output_velocity_;
  double time_ = 0.0;
  std::string reason_;
  EnergyLedger ledger_;
  double start_kinetic_energy_ = 0.0;  ///< [J]
  double max_penetration_ = 0.0;
  StepCounters step_counters_;
  int failed_attempts_ = 0;   ///< since the last step that was accepted
  double last_speed_ = 0.0;   ///< [m/s] largest displacement of the last step over its duration
  StageTimes stage_times_;
};

extern template class Simulation<3>;

}  // namespace openclose
