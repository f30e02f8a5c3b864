#include <fmt/format.h>

#include <optional>
#include <utility>

#include "commands.h"
#include "openclose/analysis/run.h"
#include "openclose/core/error.h"
#include "openclose/core/process.h"
#include "openclose/io/checkpoint.h"
#include "openclose/io/formats.h"
#include "openclose/io/progress.h"
#include "openclose/scene/check.h"
#include "openclose/scene/writer.h"
#include "stop_signal.h"

namespace openclose {
namespace {

/// [-] Of the energy moved, as much as the watch lets pass of what is created: from here on the loss is named.
constexpr double noticeable_loss = 0.01;

/// Numerical damping is an entry of the ledger of its own, so that the imbalance does not show it.
std::string loss_by_integrator(const EnergyLedger& ledger) {
  const double share = ledger.integrator_loss();
  return share > noticeable_loss ? fmt::format(", {:.2g} % of them taken by the integrator", 100.0 * share) : std::string();
}

/// The tables that grow while a run goes on, and the checkpoint that knows how far they are.
class GrowingFiles {
 public:
  GrowingFiles(const OutputFolder& folder, Simulation& simulation, const RestartPoint* restart, bool quiet)
      : folder_(folder),
        quiet_(quiet),
        points_(simulation),
        history_(folder, restart),
        energy_(folder, restart),
        states_(folder, simulation.scene(), restart),
        measured_contacts_(simulation.scene()) {
    if (!simulation.scene().measured_contacts.empty()) contact_history_.emplace(folder, restart);
    if (!restart) states_.add_drawing(simulation);
    progress_.emplace(restart ? "run" : "settle", quiet);
  }

  MeasuredPoints& points() { return points_; }

  RunObserver observer() {
    RunObserver observer;
    observer.started = [this](const Simulation& s) {
      points_.restart();
      states_.add("start", s);
      progress_.emplace("run", quiet_);
    };
    observer.settling = [this](double fraction) {
      progress_->update(fraction);
      throw_if_stopped();
    };
    observer.stops = [] { return stop_signal() != 0; };
    observer.snapshot = [this](const std::string& state, const Simulation& s) { states_.add(state, s); };
    observer.output = [this](const Simulation& s) { add_rows(s); };
    observer.progress = [this](double fraction) { progress_->update(fraction); };
    observer.checkpoint = [this](Archive& state, const Simulation& s) { write(state, s); };
    return observer;
  }

  void close(Simulation& simulation) {
    progress_.reset();
    // Asking for the contacts finds those of the last positions.
    simulation.change_contacts();
    states_.add("final", simulation);
    history_.close();
    energy_.close();
    states_.close();
    if (contact_history_) contact_history_->close();
  }

 private:
  void add_rows(const Simulation& s) {
    history_.add(s.time(), points_.motions());
    energy_.add(s.time(), s.ledger());
    if (contact_history_) contact_history_->add(s.time(), measured_contacts_.motions(s));
  }

  void write(Archive& state, const Simulation& s) {
    state(points_);
    std::vector<TableMark> tables = states_.written();
    tables.push_back(history_.written());
    tables.push_back(energy_.written());
    if (contact_history_) tables.push_back(contact_history_->written());
    write_checkpoint(folder_.path_of(checkpoint_name), s.scene(), {s.time(), std::move(tables), state.take()});
  }

  const OutputFolder& folder_;
  bool quiet_;
  MeasuredPoints points_;
  HistoryFile history_;
  EnergyFile energy_;
  StateTables states_;
  MeasuredContacts measured_contacts_;
  std::optional<ContactHistoryFile> contact_history_;
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

  const OutputFolder folder = output_folder(options);
  // Who stops the command before this loses nothing; from here on results of another run go, and what is stopped ends with its own.
  watch_for_stop_signals();
  folder.claim(files_read(options, scene));
  make_room(folder, options);
  folder.write_scene_copy(write_scene(scene));
  write_block_properties(folder, scene, simulation.system());
  GrowingFiles files(folder, simulation, restart ? &*restart : nullptr, options.quiet);
  RunResult result;
  if (restart) {
    Archive state(restart->checkpoint.state);
    try {
      result = resume(simulation, files.observer(), state, [&] { state(files.points()); });
    } catch (const DamagedState& damage) {
      throw InputError({restart->checkpoint_file, 0}, "", damage.what(), "a checkpoint as a run has written it");
    }
  } else {
    result = run(simulation, files.observer());
  }
  files.close(simulation);
  print_warnings(result.warnings);
  if (!result.milestones.empty()) write_milestones(folder, result.milestones);
  write_summary(folder, summary_of_run(options, loaded, result, simulation), simulation);
  write_formats(scene.formats, folder);
  folder.list_results();
  return report_end(options, result, simulation, folder);
}
}  // namespace openclose
