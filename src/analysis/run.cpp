#include "openclose/analysis/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "openclose/analysis/bent_joints.h"
#include "openclose/analysis/loose_motion.h"
#include "openclose/analysis/start.h"
#include "openclose/core/error.h"
#include "openclose/core/process.h"
#include "openclose/core/tolerance.h"

namespace openclose {

namespace {

/// To what the joints have in the motion.
void reduce_strength(Simulation& simulation) {
  simulation.change_joints().reduce_strength(simulation.scene().run_strength_reduction_factor);
}

}  // namespace

StartSearch::StartSearch(Simulation& simulation)
    : simulation_(simulation), own_method_(simulation.scene().method), by_another_(is_settled_by_another(simulation.scene())) {}

void StartSearch::begin_to_settle() {
  if (search_) return;
  if (by_another_) simulation_.change_method(settling_method(simulation_.scene()));
  search_ = make_equilibrium_search(simulation_);
}

/// Settles by the method that the scene names for it, and leaves the simulation with the one of the motion.
SettleResult StartSearch::settle(const SettleProgress& progress) {
  simulation_.solved_stepper().book_steps(false);
  begin_to_settle();
  const SettleResult result = search_->settle_first(progress);
  // What the paper takes for equilibrium is left as the paper has it.
  const bool asks_for_balance = simulation_.scene().settle.criterion == SettleCriterion::unbalanced_force;
  if (result.settled && asks_for_balance) balance_what_is_left(simulation_, result);
  if (by_another_) simulation_.change_method(own_method_);
  return result;
}

void StartSearch::exchange(Archive& archive) {
  const bool settles = simulation_.scene().method.start == Start::settled;
  if (archive.reading() && settles) begin_to_settle();
  SettleCourse* const course = search_ ? search_->course() : nullptr;
  archive.require(course != nullptr, "the saved state is of a start that is settled in static steps");
  archive(simulation_, *course);
  const bool has_length = std::isfinite(course->dt) && course->dt > 0.0 && std::isfinite(course->growth) && course->growth > 0.0;
  archive.require(course->has_begun && has_length && course->start.size() == static_cast<std::size_t>(simulation_.system().block_count()),
                  "the saved state is of another settling");
}

RunResult StartSearch::find(const SettleProgress& progress) {
  const double begin = process_cpu_time();
  RunResult result;
  result.converged = true;
  const Start start = simulation_.scene().method.start;
  if (start != Start::settled) reduce_strength(simulation_);
  switch (start) {
    case Start::unloaded:
      break;
    case Start::settled:
      result.settling = settle(progress);
      result.converged = result.settling.settled;
      if (!result.converged) {
        const bool moves = result.settling.limit == "settle.failure_displacement_m";
        result.reason = "no static equilibrium to start from (" + result.settling.verdict() + ")" +
                        (moves ? ": " + motion_in_words(simulation_.scene(), moved_blocks(simulation_)) : "") +
                        "; method.start = \"unloaded\" starts in motion";
      }
      simulation_.restore_velocities();
      reduce_strength(simulation_);
      break;
    case Start::normal_balanced:
      balance_normal_forces(simulation_, false);
      break;
    case Start::steady_sliding:
      balance_normal_forces(simulation_, true);
      break;
  }
  result.cpu_of_start = process_cpu_time() - begin;
  // Contacts are found for the first step of the motion; the start has been found without them.
  simulation_.change_contacts();
  simulation_.restart_clock();
  simulation_.start_base_motion();
  simulation_.allow_resting();
  result.cpu_of_motion = process_cpu_time() - begin - result.cpu_of_start;
  return result;
}

RunResult prepare_start(Simulation& simulation, const SettleProgress& progress) {
  return StartSearch(simulation).find(progress);
}

namespace {

/// [-] Of the work of friction: as large as what the watch lets pass of the energy, and as friction angles are known.
constexpr double noticeable_friction_lag = 0.01;
/// [-] Of the energy moved, which bounds what the error does to ways and speeds: beyond a tenth not even their first digit is known.
constexpr double most_energy_of_lag = 0.1;
/// [-] Of what slip takes from a joint, in one step: the strength is on the average half a step late, and half of this too high.
constexpr double noticeable_weakening = 0.1;
/// [-] Of the median block's size, far beyond the closure of joints: seen in a drawing.
constexpr double noticeable_settlement = 0.1;

}  // namespace

/// The motion from time 0 to what ends it.
class MotionInTime {
 public:
  MotionInTime(Simulation& simulation, const RunObserver& observer, RunResult& result)
      : simulation_(simulation),
        observer_(observer),
        scene_(simulation.scene()),
        result_(result),
        cpu_at_start_(process_cpu_time() - result.cpu_of_motion) {
    if (scene_.end_displacement || !scene_.milestones.empty()) points_.emplace(simulation);
    // The last step is shorter where the end is no multiple of the step.
    steps_ = std::lround(std::ceil(scene_.end_time / scene_.step.dt * (1.0 - tolerance::rounding_of_times)));
  }

  /// False if the state at the start is none that could be gone on from.
  bool begin() {
    begun_ = row_is_there_ = true;
    take_snapshots(0);
    return accepted(watch_.begin(simulation_));
  }

  void follow() {
    const long every = steps_in(scene_.output_every), checkpoint_every = steps_in(scene_.checkpoint_every);
    for (long i = done_ + 1; i <= steps_; ++i) {
      if (!simulation_.advance(length(i))) {
        result_.converged = false;
        result_.reason = simulation_.reason();
        row_is_there_ = row_is_there_ && simulation_.time() == time_after(i - 1);
        conclude();
        return;
      }
      simulation_.set_time(time_after(i));
      if (whole(i)) done_ = i;
      take_milestones(i);
      take_snapshots(i);
      const bool there = moved_enough();
      const bool last = there || i == steps_;
      watch_.follow(simulation_);
      if (!accepted(last ? watch_.check_at_end(simulation_) : watch_.is_due(simulation_, i) ? watch_.check(simulation_) : std::string())) {
        row_is_there_ = false;
        conclude();
        return;
      }
      if (there) result_.ended_by = "end.displacement_m";
      const bool regular = i % every == 0;
      if (observer_.output && regular) observer_.output(simulation_);
      row_is_there_ = regular;
      if (last) {
        conclude();
      } else if (i % checkpoint_every == 0) {
        take_checkpoint();
      }
      if (observer_.progress) observer_.progress(share_done(i));
      if (there) return;
      if (!last && observer_.stops && observer_.stops()) {
        stop();
        return;
      }
    }
    result_.ended_by = "end.time_s";
  }

  /// The checkpoint comes before the row that is only there because the run ends: a run that goes on to a later end has no such row.
  void conclude() {
    take_checkpoint();
    add_last_row();
  }

  /// Whether a run that goes on has no step left to take.
  bool is_over() {
    if (moved_enough()) {
      result_.ended_by = "end.displacement_m";
    } else if (done_ == steps_ || simulation_.time() >= scene_.end_time) {
      result_.ended_by = "end.time_s";
    }
    return !result_.ended_by.empty();
  }

  void exchange(Archive& archive) {
    archive(begun_, done_, moved_before_, snapshots_taken_, row_is_there_, result_.settling, result_.milestones, watch_);
    archive.require(begun_ && done_ >= 0 && done_ <= steps_ && result_.milestones.size() <= scene_.milestones.size() && watch_.fits(simulation_),
                    "the saved state is of another run");
    const double behind = simulation_.time() - time_after(done_),
                 rounding = tolerance::rounding_of_times * std::max(scene_.step.dt, simulation_.time());
    archive.require(behind >= -rounding && behind <= scene_.step.dt + rounding, "the saved state has another time than its steps have led to");
    if (points_) archive(*points_);
  }

  /// Says what has been asked for and did not come.
  void finish() {
    result_.cpu_of_motion = process_cpu_time() - cpu_at_start_;
    result_.watch = watch_.report();
    judge_friction();
    for (std::string& words : watch_.warnings(simulation_)) result_.warnings.push_back(std::move(words));
    if (const double most = simulation_.state().fastest_weakening; most > noticeable_weakening) {
      result_.warnings.push_back(
          fmt::format("joints lost up to {:.0f} % of what slip takes from them in one step, which has the strength before it: shorter steps{} follow "
                      "slip_weakening_distance_m",
                      100.0 * most, simulation_.enforcement().takes_adaptive_steps() && !scene_.step.adaptive ? ", or step.adaptive," : ""));
    }
    if (const double size = simulation_.system().median_size(), way = result_.settling.displacement;
        begun_ && size > 0.0 && way > noticeable_settlement * size) {
      result_.warnings.push_back(fmt::format(
          "until the start had settled, blocks moved by up to {:.3g} m, {:.2g} of the median block's size: the motion starts from another "
          "geometry than the drawn one; fos says whether that stands",
          way, way / size));
    }
    if (const std::string words = bent_joints_in_words(simulation_); begun_ && !words.empty()) result_.warnings.push_back(words);
    const std::string ending = begun_ ? fmt::format("the run ended at t = {:.6g} s", simulation_.time()) : "the run had no state to start from";
    while (result_.milestones.size() < scene_.milestones.size()) {
      Milestone missing;
      missing.displacement = scene_.milestones[result_.milestones.size()];
      missing.reason = begun_ ? fmt::format("{} with the first measured point moved by {:.6g} m", ending, points_->first_displacement()) : ending;
      result_.warnings.push_back(fmt::format("milestone {} m not reached: {}", missing.displacement, missing.reason));
      result_.milestones.push_back(missing);
    }
    for (; snapshots_taken_ < scene_.snapshot_times.size(); ++snapshots_taken_)
      result_.warnings.push_back(fmt::format("no snapshot at t = {} s: {}", scene_.snapshot_times[snapshots_taken_], ending));
    if (scene_.end_displacement && result_.ended_by == "end.time_s") {
      result_.warnings.push_back(fmt::format("{}, before any measured point had moved {} m: farthest {:.6g} m", ending, *scene_.end_displacement,
                                             points_->largest_displacement()));
    }
  }

 private:
  /// What has been slid by a friction of other normal forces is no motion of these joints.
  void judge_friction() {
    const double lag = simulation_.friction_lag();
    if (lag <= noticeable_friction_lag) return;
    const double of_energy = simulation_.state().lagging_friction_work / simulation_.ledger().turnover;
    const std::string found = fmt::format("friction of sliding contacts was that of the iteration before, off by {:.2g} % of its work", 100.0 * lag);
    if (of_energy > most_energy_of_lag && result_.converged) {
      result_.ended_by.clear();
      accepted(fmt::format("{} and {:.2g} % of the energy moved, at most {:g} %; {}", found, 100.0 * of_energy, 100.0 * most_energy_of_lag,
                           soft_instead_of_shi));
    } else {
      result_.warnings.push_back(found + "; " + soft_instead_of_shi);
    }
  }

  /// Takes the watch's answer: the run ends where it has found something.
  bool accepted(const std::string& found) {
    simulation_.solved_stepper().allow_energy(watch_.creatable_energy());
    if (found.empty()) return true;
    result_.converged = false;
    result_.refused = true;
    result_.reason = found;
    return false;
  }

  bool moved_enough() const { return scene_.end_displacement && points_->largest_displacement() >= *scene_.end_displacement; }

  /// At least one; for what is longer than the run one more than it takes, which never comes.
  long steps_in(double interval) const { return std::max(1L, std::lround(std::min(interval / scene_.step.dt, static_cast<double>(steps_ + 1)))); }

  void add_last_row() {
    if (observer_.output && !row_is_there_) observer_.output(simulation_);
  }

  void stop() {
    result_.converged = false;
    result_.stopped = true;
    result_.reason = "stopped";
    write_checkpoint();
    add_last_row();
  }

  void take_checkpoint() {
    if (scene_.checkpoint_every != 0.0) write_checkpoint();
  }

  void write_checkpoint() {
    if (!observer_.checkpoint) return;
    Archive state;
    bool has_start = true;
    state(has_start, simulation_, *this);
    observer_.checkpoint(state, simulation_);
  }

  /// [s] of this step, less what a run that ended within it has behind it.
  double length(long step) const {
    const double begun = simulation_.time() - time_after(step - 1);
    return (whole(step) ? scene_.step.dt : scene_.end_time - static_cast<double>(step - 1) * scene_.step.dt) - begun;
  }

  bool whole(long step) const {
    return static_cast<double>(step - 1) * scene_.step.dt + scene_.step.dt <= scene_.end_time * (1.0 + tolerance::rounding_of_times);
  }
  /// A multiple of the step as a user would write it: 0.3, not 0.30000000000000004.
  static double without_rounding(double time) { return std::stod(fmt::format("{:.12g}", time)); }
  double time_after(long step) const { return step == 0 || whole(step) ? static_cast<double>(step) * scene_.step.dt : scene_.end_time; }

  double share_done(long step) const {
    const double by_time = static_cast<double>(step) / static_cast<double>(steps_);
    return scene_.end_displacement ? std::clamp(points_->largest_displacement() / *scene_.end_displacement, by_time, 1.0) : by_time;
  }

  void take_milestones(long step) {
    if (result_.milestones.size() == scene_.milestones.size()) return;
    const double moved = points_->first_displacement();
    while (result_.milestones.size() < scene_.milestones.size() && moved >= scene_.milestones[result_.milestones.size()]) {
      Milestone reached;
      reached.displacement = scene_.milestones[result_.milestones.size()];
      const double share = (reached.displacement - moved_before_) / (moved - moved_before_);
      reached.time = time_after(step - 1) + share * (time_after(step) - time_after(step - 1));
      reached.cpu_of_program = process_cpu_time();
      reached.cpu_of_motion = reached.cpu_of_program - cpu_at_start_;
      result_.milestones.push_back(reached);
      take_snapshot(fmt::format("moved {} m", reached.displacement));
    }
    moved_before_ = moved;
  }

  /// What becomes of a state is no part of the motion: the CPU time of its tables is left out.
  void take_snapshot(const std::string& state) {
    if (!observer_.snapshot) return;
    const double begin = process_cpu_time();
    observer_.snapshot(state, simulation_);
    cpu_at_start_ += process_cpu_time() - begin;
  }

  /// A snapshot is taken after the step that ends nearest to its time.
  void take_snapshots(long step) {
    std::string last;
    const auto take = [&](double time) {
      std::string state = fmt::format("t={}", time);
      if (state == last) return;
      take_snapshot(state);
      last = std::move(state);
    };
    const double latest = step == steps_ ? scene_.end_time * (1.0 + tolerance::rounding_of_times) : 0.5 * (time_after(step) + time_after(step + 1));
    for (; snapshots_taken_ < scene_.snapshot_times.size() && scene_.snapshot_times[snapshots_taken_] <= latest; ++snapshots_taken_) {
      take(scene_.snapshot_times[snapshots_taken_]);
    }
    if (scene_.snapshots_every > 0.0 && step > 0 && step % steps_in(scene_.snapshots_every) == 0) take(without_rounding(time_after(step)));
  }

  Simulation& simulation_;
  const RunObserver& observer_;
  const Scene& scene_;
  RunResult& result_;
  double cpu_at_start_;                   ///< [s] from which that of the motion counts
  std::optional<MeasuredPoints> points_;  ///< if anything depends on them
  Watch watch_;
  long steps_ = 0;
  long done_ = 0;              ///< whole steps
  double moved_before_ = 0.0;  ///< [m] by the first point, before the step
  std::size_t snapshots_taken_ = 0;
  bool begun_ = false;         ///< there is a start state
  bool row_is_there_ = false;  ///< observer_.output has been called for the present state
};

namespace {

/// What has been found of a start that is not there yet is left in a checkpoint, if it can be gone on from. True if so.
bool save(StartSearch& start, const Simulation& simulation, const RunObserver& observer) {
  if (!observer.checkpoint || !start.can_go_on()) return false;
  Archive state;
  bool has_start = false;
  state(has_start, start);
  observer.checkpoint(state, simulation);
  return true;
}

RunResult run_from(StartSearch& start, Simulation& simulation, const RunObserver& observer) {
  RunResult result;
  try {
    result = start.find(observer.settling);
  } catch (const Stopped&) {
    if (!save(start, simulation, observer)) throw;
    result.has_start = false;
    result.stopped = true;
    result.reason = "stopped while the start was settling";
    result.settling = start.settling();
    return result;
  }
  if (observer.started) observer.started(simulation);
  if (observer.output) observer.output(simulation);
  MotionInTime motion(simulation, observer, result);
  if (result.converged) {
    if (motion.begin()) motion.follow();
  }
  motion.finish();
  return result;
}

}  // namespace

RunResult run(Simulation& simulation, const RunObserver& observer) {
  StartSearch start(simulation);
  return run_from(start, simulation, observer);
}

ResumedRun::ResumedRun(Simulation& simulation, Archive& state) : simulation_(simulation) {
  bool has_start = true;
  state(has_start);
  if (has_start) {
    motion_ = std::make_unique<MotionInTime>(simulation, observer_, result_);
    result_.converged = true;
    state(simulation, *motion_);
  } else {
    start_ = std::make_unique<StartSearch>(simulation);
    state(*start_);
  }
}

ResumedRun::~ResumedRun() = default;

RunResult ResumedRun::go_on(const RunObserver& observer) {
  if (start_) return run_from(*start_, simulation_, observer);
  observer_ = observer;
  if (motion_->is_over()) {
    motion_->conclude();
  } else {
    motion_->follow();
  }
  motion_->finish();
  return std::move(result_);
}

}  // namespace openclose
