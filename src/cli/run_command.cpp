#include <fmt/format.h>

#include <optional>
#include <utility>

#include "commands.h"
#include "openclose/analysis/run.h"
#include "openclose/analysis/watch.h"
#include "openclose/core/error.h"
#include "openclose/core/process.h"
#include "openclose/io/checkpoint.h"
#include "openclose/io/folder_lock.h"
#include "openclose/io/formats.h"
#include "openclose/io/progress.h"
#include "openclose/scene/check.h"
#include "openclose/scene/writer.h"
#include "stop_signal.h"

namespace openclose {
namespace {

/// Numerical damping is an entry of the ledger of its own, so that the imbalance does not show it. It is named where more is lost than the watch lets
/// pass of what is created.
std::string loss_by_integrator(const EnergyLedger& ledger) {
  const double share = ledger.integrator_loss();
  return share > watch_bound::created_energy ? fmt::format(", {:.2g} % of them taken by the integrator", 100.0 * share) : std::string();
}

/// The tables that grow while a run goes on.
struct GrowingTables {
  GrowingTables(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart)
      : history(folder, restart), energy(folder, restart), states(folder, scene, restart) {
    if (!scene.measured_contacts.empty()) contacts.emplace(folder, restart);
  }

  std::vector<TableMark> written() {
    std::vector<TableMark> marks = states.written();
    marks.push_back(history.written());
    marks.push_back(energy.written());
    if (contacts) marks.push_back(contacts->written());
    return marks;
  }

  void close() {
    history.close();
    energy.close();
    states.close();
    if (contacts) contacts->close();
  }

  HistoryFile history;
  EnergyFile energy;
  StateTables states;
  std::optional<ContactHistoryFile> contacts;
};

/// What a run leaves in its folder while it goes on, and the checkpoint that knows how far its tables are. What an earlier run has left there stays
/// until this one has a state to go on from.
class RunInFolder {
 public:
  RunInFolder(const Options& options, Simulation& simulation)
      : options_(options), simulation_(simulation), points_(simulation), measured_contacts_(simulation.scene()), drawn_(simulation.system()) {}

  /// From the beginning, or from where its start was settling. Throws Stopped if it is stopped before it has any state to go on from.
  RunResult run_in(const OutputFolder& folder) {
    folder_ = &folder;
    folder.require_ours(files_read(options_, simulation_.scene()));
    progress_.emplace("settle", options_.quiet);
    RunObserver observer = observer_of_motion();
    observer.settling = [this](double fraction) {
      progress_->update(fraction);
      throw_if_stopped();
    };
    observer.started = [&](const Simulation& s) {
      points_.restart();
      begin(folder, nullptr);
      tables_->states.add_drawing(s.scene(), drawn_);
      tables_->states.add("start", s);
    };
    try {
      return resumed_ ? resumed_->go_on(observer) : run(simulation_, observer);
    } catch (const Stopped&) {
      progress_.reset();
      throw Stopped(fmt::format("stopped while the start was settling, of which there is no checkpoint: {} is as it was; to run again: {}",
                                folder.path(), command_to_repeat("run", options_, folder)));
    }
  }

  /// Reads what the checkpoint holds; nothing is written yet.
  void read(const RestartPoint& restart) {
    Archive state(restart.checkpoint.state);
    try {
      resumed_.emplace(simulation_, state);
      state(points_);
    } catch (const DamagedState& damage) {
      throw InputError({restart.checkpoint_file, 0}, "", damage.what(), "a checkpoint as a run has written it");
    }
  }

  /// Whether it goes on from the motion in a checkpoint.
  bool is_in_motion() const { return resumed_ && resumed_->has_start(); }

  RunResult go_on_in(const OutputFolder& folder, const RestartPoint& restart) {
    begin(folder, &restart);
    return resumed_->go_on(observer_of_motion());
  }

  void close() {
    progress_.reset();
    if (!tables_) return;
    // Asking for the contacts finds those of the last positions.
    simulation_.change_contacts();
    tables_->states.add("final", simulation_);
    tables_->close();
  }

 private:
  void begin(const OutputFolder& folder, const RestartPoint* restart) {
    const Scene& scene = simulation_.scene();
    folder_ = &folder;
    claim();
    folder.write_scene_copy(write_scene(scene));
    write_block_properties(folder, scene, simulation_.system());
    tables_.emplace(folder, scene, restart);
    progress_.emplace("run", options_.quiet);
  }

  RunObserver observer_of_motion() {
    RunObserver observer;
    observer.stops = [] { return stop_signal() != 0; };
    observer.snapshot = [this](const std::string& state, const Simulation& s) { tables_->states.add(state, s); };
    observer.output = [this](const Simulation& s) { add_rows(s); };
    observer.progress = [this](double fraction) { progress_->update(fraction); };
    observer.checkpoint = [this](Archive& state, const Simulation& s) { write(state, s); };
    return observer;
  }

  void add_rows(const Simulation& s) {
    tables_->history.add(s.time(), points_.motions());
    tables_->energy.add(s.time(), s.ledger());
    if (tables_->contacts) tables_->contacts->add(s.time(), measured_contacts_.motions(s));
  }

  void claim() const {
    folder_->claim(files_read(options_, simulation_.scene()));
    make_room(*folder_, options_);
  }

  void write(Archive& state, const Simulation& s) {
    state(points_);
    if (!tables_) claim();
    std::vector<TableMark> tables = tables_ ? tables_->written() : std::vector<TableMark>();
    write_checkpoint(folder_->claim_whole_file(checkpoint_name), s.scene(), {tables_ ? s.time() : 0.0, std::move(tables), state.take()});
  }

  const Options& options_;
  Simulation& simulation_;
  MeasuredPoints points_;
  MeasuredContacts measured_contacts_;
  BlockSystem drawn_;  ///< as it was before the start
  const OutputFolder* folder_ = nullptr;
  std::optional<ResumedRun> resumed_;
  std::optional<GrowingTables> tables_;
  std::optional<Progress> progress_;
};

Summary summary_of_run(const Options& options, const Loaded& loaded, const RunResult& result, const Simulation& simulation) {
  Summary summary = summary_of("run", options, loaded);
  summary.warnings.insert(summary.warnings.end(), result.warnings.begin(), result.warnings.end());
  summary.converged = result.converged;
  summary.reason = result.reason;
  summary.settling = result.settling;
  summary.ended_by = result.ended_by;
  summary.watch = result.watch;
  summary.milestones = result.milestones;
  summary.cpu_of_start = result.cpu_of_start;
  summary.cpu_of_motion = result.cpu_of_motion;
  summary.ledger = simulation.ledger();
  summary.max_penetration = simulation.max_penetration();
  return summary;
}

/// Says how the run has ended; returns the exit status.
int report_end(const Options& options, const RunResult& result, const Simulation& simulation, const OutputFolder& folder) {
  if (!result.has_start) {
    print_message(fmt::format("stopped while the start was settling, {:.2g} of the weight unbalanced; state saved in {}; to go on: {}",
                              result.settling.unbalanced_fraction, folder.path(), command_to_go_on("run", options, folder)));
    return exit_status_of_stop();
  }
  if (result.stopped) {
    print_message(fmt::format("stopped at t = {:.6g} s; state saved in {}; to go on: {}", simulation.time(), folder.path(),
                              command_to_go_on("run", options, folder)));
    return exit_status_of_stop();
  }
  if (!result.converged) {
    print_message(fmt::format("{} at t = {:.6g} s: {}; state saved in {}", result.refused ? "refused" : "not converged", simulation.time(),
                              result.reason, folder.path()));
    return exit_not_converged;
  }
  if (!options.quiet) {
    const EnergyLedger& ledger = simulation.ledger();
    fmt::print(
        "{}: {} blocks, {} steps to t = {:.6g} s{}, deepest penetration {:.3g} m, energy imbalance {:.2g} of {:.3g} J moved{}; written to {}\n",
        simulation.scene().method.contact, simulation.system().block_count(), simulation.state().counters.steps, simulation.time(),
        result.ended_by == "end.displacement_m" ? " (end.displacement_m)" : "", simulation.max_penetration(), ledger.imbalance(), ledger.turnover,
        loss_by_integrator(ledger), folder.path());
  }
  return exit_success;
}

}  // namespace

int run_command(const Options& options) {
  Loaded loaded = load(options);
  require_run(loaded.scene);
  require_memory(loaded.scene, available_memory());
  if (is_settled_by_another(loaded.scene) && loaded.scene.method.start != Start::settled)
    loaded.warn("run.settled_by is for method.start = \"settled\"; the other starts are not settled");
  std::optional<RestartPoint> restart;
  if (!options.restart_file.empty()) restart = {options.restart_file, read_checkpoint(options.restart_file, loaded.scene)};
  Simulation simulation(std::move(loaded.scene));
  const Scene& scene = simulation.scene();
  if (!restart) {
    require_start(scene);
    loaded.judge_overlaps(simulation, first_motion_of_run(scene));
  }
  RunInFolder in_folder(options, simulation);
  if (restart) in_folder.read(*restart);
  const OutputFolder folder = output_folder(options);
  const FolderLock lock(folder.path());
  // Who stops the command before this loses nothing; from here on what is stopped ends with a word on how to go on.
  watch_for_stop_signals();
  const RunResult result = in_folder.is_in_motion() ? in_folder.go_on_in(folder, *restart) : in_folder.run_in(folder);
  in_folder.close();
  print_warnings(result.warnings);
  if (!result.milestones.empty()) write_milestones(folder, result.milestones);
  write_summary(folder, summary_of_run(options, loaded, result, simulation), simulation);
  if (result.has_start) write_formats(scene.formats, folder);
  folder.list_results();
  lock.require_same_folder();
  return report_end(options, result, simulation, folder);
}
}  // namespace openclose
