// What a simulation is at one moment: the blocks, their contacts, the clock, and all that the next step depends on whichever stepper takes it. The
// steppers (solved_stepper.h, explicit_stepper.h) carry it on; between two steps it is complete, and reading it changes nothing.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "openclose/analysis/energy_ledger.h"
#include "openclose/analysis/resting.h"
#include "openclose/analysis/step_counters.h"
#include "openclose/contact/detection.h"
#include "openclose/core/memory.h"
#include "openclose/core/tolerance.h"
#include "openclose/integrator/enforcement.h"

namespace openclose {

/// [m] Lengths that follow from the size of the free blocks, where the scene does not give them.
struct LengthsOfBlocks {
  explicit LengthsOfBlocks(const std::vector<BlockInput>& blocks);

  double contact_skin = tolerance::contact_skin_m;                  ///< see tolerance.h
  double search_skin = tolerance::search_skin_m;                    ///< see tolerance.h
  double longest_displacement = tolerance::longest_displacement_m;  ///< see tolerance.h
};

struct SimulationState {
  using Unknowns = Motion::Unknowns;

  /// \param own  an enforcement of the caller's; null: the one that the scene names
  SimulationState(Scene scene, std::unique_ptr<Enforcement> own);
  SimulationState(const SimulationState&) = delete;
  SimulationState& operator=(const SimulationState&) = delete;

  /// To be called by whoever changes blocks, joints or contacts otherwise than by a step: what steppers keep of them holds no more.
  void note_change() { ++changes; }
  /// The same, and no block is at rest any more, because the caller may change what the steps work on.
  void take_back();

  /// Contacts of the present positions, searched if blocks have moved since. Of the places to which their velocities carry the blocks within `lead`
  /// [s]: of what happens to a corner within a step, that it passes the end of an edge or comes to the next one, half is then seen too early where
  /// all would be seen too late.
  void find_contacts(double lead = 0.0);
  /// After a part of the contacts has been found anew: what their springs store.
  void store_changed_energies();
  /// The next step from here, with contacts as they are listed.
  StepProblem problem(double dt, bool statics) const;
  /// Gives the external forces what the base does in the next step; true if that moves blocks at rest, which are to be woken.
  bool move_base(double dt, bool statics);

  /// Follows how quiet the blocks are after a step of dt and puts some to rest.
  void rest_after(double dt);
  void wake(const std::vector<int>& blocks);
  void wake_all() { wake(std::vector<int>(system.resting_blocks())); }
  /// Of the blocks at rest those that the last step, which Resting has judged, wakes.
  std::vector<int> to_wake(Resting::Urgency urgency);

  /// Whether the next step is one of method.first_integrator.
  bool is_beginning() const;
  /// Begins the present integrator anew, from the velocities of whole steps.
  void restart_scheme();
  void make_scheme();

  double moving_contact_energy() const;  ///< [J] without contacts between blocks at rest
  double stored_contact_energy() const;  ///< [J] of all
  /// [N] weight of the heaviest free block, or the largest load or contact force if there is no gravity
  double force_scale() const;
  /// Writes down the kinetic energy of the blocks' velocities and what explicit steps add to it for the present moment.
  void book_kinetic_energy(double ahead);
  void count_moves();
  void note_memory(const Memory& of_stepper);

  void exchange(Archive& archive);

  Scene scene;
  const LengthsOfBlocks lengths;  ///< the scene's, or those of its blocks
  BlockSystem system;             ///< its velocities are those of the scheme, which may be half a step behind
  ExternalForces external;
  JointTable joints;
  std::unique_ptr<Enforcement> enforcement;
  bool begins;  ///< the scheme is method.first_integrator
  std::unique_ptr<TimeScheme> scheme;
  Detector detector;
  ContactSet contacts;                    ///< forces of those between blocks at rest are the ones these were put to rest with
  bool contacts_current = false;          ///< those of blocks that move are of the present positions
  std::vector<Unknowns> output_velocity;  ///< per block, at `time`
  Resting resting;
  bool may_rest = false;
  bool base_moves = false;
  Bonds bonds = Bonds::break_under_load;
  double time = 0.0;   ///< [s]
  std::string reason;  ///< why the last advance got nowhere
  EnergyLedger ledger;
  double start_kinetic_energy = 0.0;                        ///< [J]
  double kinetic_ahead = 0.0;                               ///< [J] in the ledger, see CentralDifference::kinetic_ahead()
  double max_penetration = 0.0;                             ///< [m]
  double friction_work = 0.0, lagging_friction_work = 0.0;  ///< [J] see Simulation::friction_lag()
  double fastest_weakening = 0.0;                           ///< [-] the largest LossesOfStep::along_slip of a step in motion
  StepCounters counters;
  StageTimes stage_times;
  Memory memory;     ///< of the arrays, each part as large as it has been after a step
  long changes = 0;  ///< see note_change(); steppers compare it with what it was

 private:
  /// Whether what was read is a state of these blocks.
  void judge(const Archive& archive) const;
  bool search(double lead);
  void store_energy(const StepProblem& problem, Contact& contact) const;
  /// Blocks have been put to rest or woken.
  void divide();

  std::size_t bytes_of_scene_;
};

}  // namespace openclose
