// A run from its start state to its end time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "openclose/analysis/equilibrium.h"
#include "openclose/analysis/measured_points.h"
#include "openclose/analysis/simulation.h"
#include "openclose/analysis/watch.h"

namespace openclose {

/// When the first measured point had moved so far.
struct Milestone {
  double displacement = 0.0;    ///< [m]
  std::optional<double> time;   ///< [s] interpolated linearly within the step; none if it did not get there
  double cpu_of_motion = 0.0;   ///< [s] of the process since time 0, at the end of that step, without snapshots
  double cpu_of_program = 0.0;  ///< [s] of the process since it began
  std::string reason;           ///< why there is no time

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e] = *this;
    archive(a, b, c, d, e);
  }
};

/// Strength is reduced by Scene::run_strength_reduction_factor for the motion. What is settled first is so with full strength; the other starts are
/// made with the strength of the motion: `steady_sliding` is to go on as it starts, `normal_balanced` knows no strength.
struct RunResult {
  bool converged = false;
  bool stopped = false;   ///< it did not converge because the observer has stopped it
  bool refused = false;   ///< it did not converge because the watch has stopped it
  bool has_start = true;  ///< false: it was stopped on the way to time 0
  std::string reason;
  WatchReport watch;
  std::string ended_by;               ///< key that ended it: end.time_s or end.displacement_m; empty if it did not converge
  std::vector<std::string> warnings;  ///< what was asked for and did not come
  std::vector<Milestone> milestones;
  SettleResult settling;       ///< if the start was `settled`
  double cpu_of_start = 0.0;   ///< [s] of the process, until time 0
  double cpu_of_motion = 0.0;  ///< [s] since, rows of the history included, snapshots not
};

/// What a run tells while it goes on.
struct RunObserver {
  std::function<void(const Simulation&)> started;                             ///< the start state is reached, time is 0
  std::function<void(const Simulation&)> output;                              ///< at time 0 and at every output time
  std::function<void(const std::string& state, const Simulation&)> snapshot;  ///< at the snapshot times ("t=1.5") and milestones ("moved 10 m")
  std::function<void(double fraction)> progress;                              ///< after every step
  SettleProgress settling;                                                    ///< while it settles
  std::function<bool()> stops;                                                ///< after every step: true ends the run there, with a checkpoint
  /// A checkpoint is due (every Scene::checkpoint_every, at the end, and where a step does not converge; without that only where it is stopped):
  /// `state` holds the whole run, and whatever the observer adds to it.
  std::function<void(Archive& state, const Simulation&)> checkpoint;
};

/// The way of a simulation to the scene's start state.
class StartSearch {
 public:
  explicit StartSearch(Simulation& simulation);
  /// Throws what `progress` throws; goes on from there where it can.
  RunResult find(const SettleProgress& progress);
  /// Whether it has begun to settle in steps one of which it can go on from.
  bool can_go_on() const { return search_ && search_->course() && search_->course()->has_begun; }
  /// So far, where it can go on.
  const SettleResult& settling() const { return search_->course()->result; }
  /// With the simulation, which has another method while it settles.
  void exchange(Archive& archive);

 private:
  void begin_to_settle();
  SettleResult settle(const SettleProgress& progress);

  Simulation& simulation_;
  MethodInput own_method_;
  bool by_another_;                            ///< another method than that of the motion settles
  std::unique_ptr<EquilibriumSearch> search_;  ///< once it settles
};

/// Brings the simulation into the scene's start state.
RunResult prepare_start(Simulation& simulation, const SettleProgress& progress = {});

RunResult run(Simulation& simulation, const RunObserver& observer);

class MotionInTime;

/// A run that goes on, bit for bit, from what a checkpoint of the same scene holds, in a simulation that has not been used. The scene may have
/// another end.time_s (not before the state's), other threads, output.every_s, checkpoint_every_s and formats, and another solver.smallest_fraction
/// and solver.max_iterations, to get over a step that did not converge.
class ResumedRun {
 public:
  /// Reads the state, which is left where the observer's own part begins. Throws DamagedState if it does not fit the scene; no step is made yet.
  ResumedRun(Simulation& simulation, Archive& state);
  ~ResumedRun();
  /// False for a run that has been stopped while its start settled.
  bool has_start() const { return !start_; }
  RunResult go_on(const RunObserver& observer);

 private:
  Simulation& simulation_;
  RunObserver observer_;
  RunResult result_;
  std::unique_ptr<StartSearch> start_;    ///< until there is one
  std::unique_ptr<MotionInTime> motion_;  ///< from then on
};

}  // namespace openclose
