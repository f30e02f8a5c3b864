#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "commands.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/core/process.h"
#include "openclose/io/checkpoint.h"
#include "openclose/io/folder_lock.h"
#include "openclose/io/formats.h"
#include "openclose/io/progress.h"
#include "openclose/io/search_checkpoint.h"
#include "openclose/scene/check.h"
#include "openclose/scene/override.h"
#include "openclose/scene/writer.h"
#include "stop_signal.h"

namespace openclose {
namespace {

/// Deepest closed contact [m].
double deepest_of(const std::vector<Contact>& contacts) {
  double deepest = 0.0;
  for (const Contact& c : contacts) {
    if (c.status != ContactStatus::open) deepest = std::max(deepest, -c.gap);
  }
  return deepest;
}

/// The answer and what it is worth, in two or three lines.
void print_factor(const Scene& scene, const FactorOfSafety& safety, const OutputFolder& folder) {
  const std::string stable = fmt::format("{:.6g}", safety.stable()), name = name_of_answer(scene.strength_reduction.increase);
  if (safety.verdict == FactorVerdict::no_failure) {
    fmt::print("{} above {} ({}): {}; written to {}\n", name, stable, scene.method.contact, safety.reason, folder.path());
    return;
  }
  const std::string failed = safety.bracket.failed ? fmt::format("failed at {:.6g} by {}", safety.failed(), safety.bracket.failed_by)
                                                   : std::string("no failure proved above");
  fmt::print("{} {} ({}; {}: stable at {}, {}); written to {}\n", name, stable, scene.method.contact, factor_verdict_word(safety.verdict), stable,
             failed, folder.path());
  if (safety.limit_analysis && safety.limit_analysis->factor) {
    fmt::print("rigid-block limit analysis: at most {:.6g}\n", *safety.limit_analysis->factor);
  }
  if (!safety.mechanism.empty()) {
    double area = 0.0;
    for (const FailingBlock& block : safety.mechanism) area += block.area;
    const auto free = std::ranges::count_if(scene.blocks, [](const BlockInput& block) { return !block.fixed; });
    fmt::print("what fails: {} of {} free blocks, {:.4g} m2, see mechanism.csv{}\n", safety.mechanism.size(), free, area,
               safety.bracket.failed_by == by_limit_analysis ? ": the mechanism of the limit analysis" : "");
  }
}

/// "1.25  stable", "1.5625  failed (mechanism)"
std::string line_of(const StrengthTrial& trial) {
  const char* outcome = trial.outcome == TrialOutcome::stable ? "stable" : trial.outcome == TrialOutcome::failed ? "failed" : "undecided";
  const std::string reason = trial.outcome == TrialOutcome::stable ? "" : " (" + trial.criterion + ")";
  return fmt::format("{:<9.6g} {}{}", trial.srf, outcome, reason);
}

/// For who waits: the bar says nothing of the rest before the first trials have ended, and most of the time is that of many blocks.
std::string number_of_blocks(const Scene& scene) {
  return size_of(scene) + (scene.cutting ? "; a larger joint_set.spacing_m makes fewer" : "");
}

/// What a search leaves in its folder, from when there is anything new: what an earlier one has left there stays until then.
class SearchFolder {
 public:
  SearchFolder(const Options& options, const Simulation& simulation, const OutputFolder& folder)
      : options_(options), scene_(simulation.scene()), drawn_(simulation.system()), folder_(folder) {
    folder.require_ours(files_read(options, scene_));
  }

  /// Nothing the second time.
  void begin() {
    if (states_) return;
    folder_.claim(files_read(options_, scene_));
    make_room(folder_, options_);
    folder_.write_scene_copy(write_scene(scene_));
    write_block_properties(folder_, scene_, drawn_);
    states_.emplace(folder_, scene_);
    states_->add_drawing(scene_, drawn_);
  }

  void write(std::string state) {
    begin();
    write_checkpoint(folder_.claim_whole_file(checkpoint_name), scene_, {0.0, {}, std::move(state), "fos"});
  }

  const OutputFolder& folder() const { return folder_; }
  bool has_begun() const { return states_.has_value(); }
  StateTables& states() { return *states_; }

 private:
  const Options& options_;
  const Scene& scene_;
  const BlockSystem drawn_;
  const OutputFolder& folder_;
  std::optional<StateTables> states_;
};

/// With what has been found out in the checkpoint; all of it where the search is stopped.
FactorOfSafety search(Simulation& simulation, const Options& options, SearchFolder& folder, std::optional<Checkpoint> restart) {
  const bool grows = simulation.scene().strength_reduction.increase.has_value();
  Progress progress(grows ? "load" : "strength reduction", options.quiet);
  progress.note(number_of_blocks(simulation.scene()));
  SearchCheckpoint checkpoint([&](std::string state) { folder.write(std::move(state)); }, &process_cpu_time);
  SearchObserver observer;
  double done = 0.0;
  observer.progress = [&](double fraction) {
    progress.update(done = fraction);
    throw_if_stopped();
  };
  // Within a trial, too: the first one of many blocks takes long, and without the bar nothing would show that it is at work.
  observer.interruption = [&] {
    progress.update(done);
    throw_if_stopped();
  };
  observer.done = [&](std::string state) { checkpoint.keep(std::move(state)); };
  observer.trial = [&](const StrengthTrial& trial) {
    progress.note(line_of(trial));
    // What a checkpoint holds is read piece by piece while the search finds its way back: what is damaged is refused before anything is written.
    if (!restart) folder.begin();
  };
  const auto found = [&] {
    if (!restart) return factor_of_safety(simulation, observer);
    try {
      return resume_search(simulation, observer, std::move(restart->state));
    } catch (const DamagedState& damage) {
      throw InputError({options.restart_file, 0}, "", damage.what(), "a checkpoint as fos has written it");
    }
  };
  FactorOfSafety safety = found();
  if (safety.bracket.stopped && !restart && !folder.has_begun())
    throw Stopped(fmt::format("stopped in the first trial, of which there is no checkpoint: {} is as it was; to run again: {}",
                              folder.folder().path(), command_to_repeat("fos", options, folder.folder())));
  folder.begin();
  if (safety.bracket.stopped) checkpoint.flush();
  return safety;
}

int report_stop(const FactorOfSafety& safety, const Options& options, const OutputFolder& folder) {
  const bool can_go_on = is_there(folder.path_of(checkpoint_name));
  print_message(fmt::format("{}; state saved in {}{}", safety.reason, folder.path(),
                            can_go_on ? "; to go on: " + command_to_go_on("fos", options, folder) : ""));
  return exit_status_of_stop();
}

/// What fos does not use.
void warn_of_what_is_for_run(Loaded& loaded) {
  if (loaded.scene.run_strength_reduction_factor != 1.0) loaded.warn("run.strength_reduction_factor is for run; fos starts from the full strength");
  if (is_settled_by_another(loaded.scene)) loaded.warn("run.settled_by is for run; fos settles by method.contact");
  if (loaded.scene.method.first_integrator) {
    loaded.warn("method.first_integrator is for run; fos settles by method.integrator");
    loaded.scene.method.first_integrator.reset();
  }
  if (loaded.scene.base_motion) loaded.warn("base_motion is for run; fos asks for static equilibrium on a base at rest");
  if (!loaded.scene.measured_contacts.empty()) loaded.warn("measured_contact is for run; contacts.csv has what every contact carries");
}

/// What steps in time ask for: `fos` reads it where something moves in time, and nowhere else. In a scene it may stand for `run`; who gives it to
/// `fos` by hand expects another factor from it.
std::vector<std::string> unused_steps(const Scene& scene, const Options& options) {
  std::vector<std::string> warnings;
  if (scene.strength_reduction.curve_time || scene.settle.criterion == SettleCriterion::paper) return warnings;
  for (const std::string key : {"step.dt_s", "method.integrator", "method.theta", "method.rho_inf", "method.dissipation"}) {
    if (std::ranges::count(options.overrides, key, key_of_override) == 0) continue;
    warnings.push_back(
        fmt::format("{}: {} has no effect on fos: equilibrium is found without steps in time, unless strength_reduction.curve_time_s or "
                    "settle.criterion = \"paper\" asks for motion",
                    source_of_overrides(scene.where.file), key));
  }
  return warnings;
}

}  // namespace

int fos_command(const Options& options) {
  Loaded loaded = load(options);
  warn_of_what_is_for_run(loaded);
  require_strength_reduction(loaded.scene);
  if (std::ranges::all_of(loaded.scene.blocks, &BlockInput::fixed))
    throw InputError(loaded.scene.where, "block.fixed", "no block is free, so that nothing can fail", "a block that is not fixed");
  require_memory(loaded.scene, available_memory());
  if (loaded.scene.step.dt <= 0.0) loaded.scene.step.dt = loaded.scene.settle.first_dt;
  std::optional<Checkpoint> restart;
  if (!options.restart_file.empty()) restart = read_checkpoint(options.restart_file, loaded.scene, "fos");
  Simulation simulation(std::move(loaded.scene));
  if (!restart) loaded.judge_overlaps(simulation, FirstMotion::settling);
  const OutputFolder folder = output_folder(options);
  const FolderLock lock(folder.path());
  // As in `run`: before this nothing is lost.
  watch_for_stop_signals();
  SearchFolder in_folder(options, simulation, folder);
  // Once nothing is refused any more: a key that has no meaning for the method is an error, and no warning besides.
  const std::vector<std::string> unused = unused_steps(simulation.scene(), options);
  print_warnings(unused);
  loaded.warnings.insert(loaded.warnings.end(), unused.begin(), unused.end());
  const std::optional<std::string>& increase = simulation.scene().strength_reduction.increase;
  const double begin = process_cpu_time();
  const FactorOfSafety safety = search(simulation, options, in_folder, std::move(restart));

  Summary summary = summary_of("fos", options, loaded);
  summary.cpu_of_search = process_cpu_time() - begin;
  summary.warnings.insert(summary.warnings.end(), safety.warnings.begin(), safety.warnings.end());
  print_warnings(safety.warnings);
  for (const NamedState& state : safety.states) {
    in_folder.states().add(state, simulation.scene());
    if (state.contacts.empty()) continue;
    if (state.name != "failed") summary.max_penetration = deepest_of(state.contacts);
  }
  in_folder.states().close();
  write_trials(folder, safety.trials, column_of_answer(increase));
  if (!safety.mechanism.empty()) write_mechanism(folder, simulation.scene(), safety.mechanism);
  if (!safety.curve.empty()) write_curve(folder, safety.curve);
  summary.converged = safety.found();
  summary.reason = safety.reason;
  write_summary(folder, summary, simulation, &safety);
  write_formats(simulation.scene().formats, folder);

  if (!safety.bracket.stopped) folder.remove_checkpoint();
  folder.list_results();
  lock.require_same_folder();
  if (safety.bracket.stopped) return report_stop(safety, options, folder);
  if (!safety.found()) {
    print_message(fmt::format("no {}: {}; state saved in {}", name_of_answer(increase), safety.reason, folder.path()));
    return exit_not_converged;
  }
  if (!options.quiet) print_factor(simulation.scene(), safety, folder);
  return exit_success;
}

}  // namespace openclose
