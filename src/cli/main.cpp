// The command: reads what the user asked for, runs it, says how it ended. No physics here.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>

#include "machine_output.h"
#include "openclose/analysis/spectrum.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"
#include "openclose/io/checkpoint.h"
#include "openclose/io/drawing.h"
#include "openclose/io/formats.h"
#include "openclose/io/key_reference.h"
#include "openclose/io/progress.h"
#include "openclose/io/result_picture.h"
#include "openclose/io/results.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"
#include "openclose/scene/writer.h"
#include "openclose/version.h"
#include "report_command.h"
#include "shell_commands.h"
#include "stop_signal.h"
#include "study_command.h"
#include "sweep_command.h"

namespace openclose {
namespace {

struct Options {
  std::string scene_file;
  std::string folder;
  std::string blocks_file;
  std::string drawing_file;
  std::string spectrum_file;
  std::string restart_file;
  std::string results;
  std::string key;
  bool page = false, schema = false;
  DrawingRequest drawing;
  std::vector<std::string> overrides;
  bool quiet = false;
  mutable std::string work;  ///< what the memory is needed for, should there be too little
  bool json = false;
};

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) fmt::print(stderr, "openclose: warning: {}\n", warning);
}

struct Loaded {
  Scene scene;
  std::vector<std::string> warnings;

  /// Of what the command leaves unused.
  void warn(const std::string& text) {
    warnings.push_back(scene.where.file + ": " + text);
    print_warnings({warnings.back()});
  }
};

Loaded load(const Options& options) {
  options.work = "reading " + options.scene_file + " ([[block]], or domain.max_blocks and joint_set.spacing_m, limit what it makes)";
  Loaded loaded{read_scene(options.scene_file, options.overrides), {}};
  options.work = fmt::format("{} of {} ([[block]], or domain.max_blocks and joint_set.spacing_m, limit their number)", size_of(loaded.scene),
                             options.scene_file);
  require_formats(loaded.scene.formats, loaded.scene.formats_where);
  loaded.warnings = check_scene(loaded.scene);
  print_warnings(loaded.warnings);
  return loaded;
}

OutputFolder output_folder(const Options& options) {
  if (!options.folder.empty()) return OutputFolder(options.folder);
  return OutputFolder("results/" + std::filesystem::path(options.scene_file).stem().string());
}

/// What no result may replace. The checkpoint that a run goes on from is one of its own results.
std::vector<std::string> files_read(const Options& options, const Scene& scene) {
  std::vector<std::string> files{options.scene_file};
  if (scene.base_motion) files.insert(files.end(), scene.base_motion->files.begin(), scene.base_motion->files.end());
  return files;
}

/// Refuses what would take longer than anyone waits.
void require_countable_steps(const Scene& scene, const std::string& key, double time) {
  constexpr double most_steps = 1e9;
  if (time / scene.step.dt <= most_steps) return;
  throw InputError(scene.where, key, fmt::format("{:g} s in steps of {:g} s", time, scene.step.dt),
                   fmt::format("at most {:g} steps of step.dt_s", most_steps));
}

/// Throws InputError where a scene does not say what `run` has to know.
void require_run(const Scene& scene) {
  if (scene.step.dt <= 0.0) throw InputError(scene.where, "step.dt_s", "missing", "a step in seconds, here or with --dt");
  if (scene.end_time <= 0.0) throw InputError(scene.where, "end.time_s", "missing, or 0", "an end time > 0 in seconds, here or with --end");
  require_countable_steps(scene, "end.time_s", scene.end_time);
}

/// Throws InputError for blocks that do not have the start that the scene asks for; found out on a copy, before any file is written.
void require_start(const Scene& scene) {
  const bool can_be_refused = scene.method.start == Start::normal_balanced || scene.method.start == Start::steady_sliding;
  if (!can_be_refused) return;
  Simulation trial(scene);
  prepare_start(trial);
}

/// Throws InputError where a scene does not say what `fos` has to know.
void require_strength_reduction(const Scene& scene) {
  const std::optional<double>& curve_time = scene.strength_reduction.curve_time;
  const bool paper = scene.settle.criterion == SettleCriterion::paper;
  if (scene.step.dt <= 0.0 && (curve_time || paper)) {
    throw InputError(scene.where, "step.dt_s", "missing",
                     fmt::format("a step in seconds: {} asks for motion", paper ? "settle.criterion" : "strength_reduction.curve_time_s"));
  }
  if (curve_time) require_countable_steps(scene, "strength_reduction.curve_time_s", *curve_time);
  if (scene.strength_reduction.definition == FactorDefinition::large_displacements) return;
  const std::string large = "strength_reduction.definition = \"large_displacements\", in which blocks move";
  if (paper) throw InputError(scene.where, "settle.criterion", "\"paper\" is a rule for motion", large);
  if (curve_time) {
    throw InputError(scene.strength_reduction.curve_time_where, "strength_reduction.curve_time_s", "asks for motion, which this definition has not",
                     large);
  }
}

/// Throws InputError for what `run` or `fos` would refuse. A scene without step or end is one for `fos`, or gets them from the command line.
void require_use(const Scene& scene) {
  require_strength_reduction(scene);
  if (scene.step.dt <= 0.0 || scene.end_time <= 0.0) return;
  require_run(scene);
  require_start(scene);
}

/// Deepest closed contact [m].
double deepest_of(const std::vector<Contact>& contacts) {
  double deepest = 0.0;
  for (const Contact& c : contacts) {
    if (c.status != ContactStatus::open) deepest = std::max(deepest, -c.gap);
  }
  return deepest;
}

Summary summary_of(const std::string& command, const Options& options, const Loaded& loaded) {
  Summary summary;
  summary.command = command;
  summary.scene_file = options.scene_file;
  summary.overrides = options.overrides;
  summary.warnings = loaded.warnings;
  return summary;
}

/// For the shell of who has stopped a run.
std::string command_to_go_on(const Options& options, const OutputFolder& folder) {
  std::string command = fmt::format("openclose run '{}'", options.scene_file);
  for (const std::string& key_and_value : options.overrides) command += fmt::format(" --set '{}'", key_and_value);
  return command + fmt::format(" -o '{}' --restart '{}'", folder.path(), folder.path_of(checkpoint_name));
}

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
  MeasuredPoints points(simulation);
  if (!restart) require_start(scene);

  const OutputFolder folder = output_folder(options);
  folder.claim(files_read(options, scene));
  const RestartPoint* goes_on_from = restart ? &*restart : nullptr;
  if (restart && folder.has(restart->checkpoint_file)) {
    folder.remove_last_results();
  } else {
    folder.remove_results();
  }
  folder.write_scene_copy(write_scene(scene));
  write_block_properties(folder, scene, std::as_const(simulation).system());
  HistoryFile history(folder, goes_on_from);
  EnergyFile energy(folder, goes_on_from);
  StateTables states(folder, scene, goes_on_from);
  const MeasuredContacts measured_contacts(scene);
  std::optional<ContactHistoryFile> contact_history;
  if (!scene.measured_contacts.empty()) contact_history.emplace(folder, goes_on_from);
  if (!restart) states.add_drawing(simulation);
  std::optional<Progress> progress;
  progress.emplace(restart ? "run" : "settle", options.quiet);

  RunObserver observer;
  observer.started = [&](const Simulation& s) {
    points.restart();
    states.add("start", s);
    progress.emplace("run", options.quiet);
  };
  observer.settling = [&](double fraction) {
    progress->update(fraction);
    throw_if_stopped();
  };
  observer.stops = [] { return stop_signal() != 0; };
  observer.snapshot = [&](const std::string& state, const Simulation& s) { states.add(state, s); };
  observer.output = [&](const Simulation& s) {
    history.add(s.time(), points.motions());
    energy.add(s.time(), s.ledger());
    if (contact_history) contact_history->add(s.time(), measured_contacts.motions(s));
  };
  observer.progress = [&](double fraction) { progress->update(fraction); };
  observer.checkpoint = [&](Archive& state, const Simulation& s) {
    state(points);
    auto tables = states.written();
    tables.push_back(history.written());
    tables.push_back(energy.written());
    if (contact_history) tables.push_back(contact_history->written());
    write_checkpoint(folder.path_of(checkpoint_name), s.scene(), {s.time(), std::move(tables), state.take()});
  };
  RunResult result;
  watch_for_stop_signals();
  if (restart) {
    Archive state(restart->checkpoint.state);
    try {
      result = resume(simulation, observer, state, [&] { state(points); });
    } catch (const DamagedState& damage) {
      throw InputError({restart->checkpoint_file, 0}, "", damage.what(), "a checkpoint as a run has written it");
    }
  } else {
    result = run(simulation, observer);
  }
  progress.reset();
  print_warnings(result.warnings);

  // Asking for the contacts finds those of the last positions.
  states.add("final", simulation, simulation.contacts());
  history.close();
  energy.close();
  states.close();
  if (contact_history) contact_history->close();
  if (!result.milestones.empty()) write_milestones(folder, result.milestones);
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
  write_summary(folder, summary, simulation);
  write_formats(scene.formats, folder);

  if (result.stopped) {
    fmt::print(stderr, "openclose: stopped at t = {:.6g} s; state saved in {}; to go on: {}\n", simulation.time(), folder.path(),
               command_to_go_on(options, folder));
    return exit_status_of_stop();
  }
  if (!result.converged) {
    fmt::print(stderr, "openclose: {} at t = {:.6g} s: {}; state saved in {}\n", result.refused ? "refused" : "not converged", simulation.time(),
               result.reason, folder.path());
    return exit_not_converged;
  }
  if (!options.quiet) {
    fmt::print("{}: {} blocks, {} steps to t = {:.6g} s{}, deepest penetration {:.3g} m, energy imbalance {:.2g} of {:.3g} J; written to {}\n",
               scene.method.contact, simulation.system().block_count(), simulation.step_counters().steps, simulation.time(),
               result.ended_by == "end.displacement_m" ? " (end.displacement_m)" : "", simulation.max_penetration(), simulation.ledger().imbalance(),
               simulation.ledger().turnover, folder.path());
  }
  return exit_success;
}

/// The answer and what it is worth, in two or three lines.
void print_factor(const Scene& scene, const FactorOfSafety& safety, const OutputFolder& folder) {
  const std::string stable = fmt::format("{:.6g}", safety.stable());
  if (safety.verdict == FactorVerdict::no_failure) {
    fmt::print("factor of safety above {} ({}): {}; written to {}\n", stable, scene.method.contact, safety.reason, folder.path());
    return;
  }
  const std::string failed = safety.bracket.failed ? fmt::format("failed at {:.6g} by {}", safety.failed(), safety.bracket.failed_by)
                                                   : std::string("no failure proved above");
  fmt::print("factor of safety {} ({}; {}: stable at {}, {}); written to {}\n", stable, scene.method.contact, factor_verdict_word(safety.verdict),
             stable, failed, folder.path());
  if (safety.limit_analysis && safety.limit_analysis->factor) {
    fmt::print("rigid-block limit analysis: at most {:.6g}\n", *safety.limit_analysis->factor);
  }
  if (!safety.mechanism.empty()) {
    double area = 0.0;
    for (const FailingBlock& block : safety.mechanism) area += block.area;
    const auto free = std::ranges::count_if(scene.blocks, [](const BlockInput& block) { return !block.fixed; });
    fmt::print("what fails: {} of {} free blocks, {:.4g} m2, see mechanism.csv\n", safety.mechanism.size(), free, area);
  }
}

int fos_command(const Options& options) {
  Loaded loaded = load(options);
  if (loaded.scene.run_strength_reduction_factor != 1.0) loaded.warn("run.strength_reduction_factor is for run; fos starts from the full strength");
  if (is_settled_by_another(loaded.scene)) loaded.warn("run.settled_by is for run; fos settles by method.contact");
  if (loaded.scene.method.first_integrator) {
    loaded.warn("method.first_integrator is for run; fos settles by method.integrator");
    loaded.scene.method.first_integrator.reset();
  }
  if (loaded.scene.base_motion) loaded.warn("base_motion is for run; fos asks for static equilibrium on a base at rest");
  if (!loaded.scene.measured_contacts.empty()) loaded.warn("measured_contact is for run; contacts.csv has what every contact carries");
  require_strength_reduction(loaded.scene);
  require_memory(loaded.scene, available_memory());
  if (loaded.scene.step.dt <= 0.0) loaded.scene.step.dt = loaded.scene.settle.first_dt;
  Simulation simulation(std::move(loaded.scene));
  const OutputFolder folder = output_folder(options);
  folder.claim(files_read(options, simulation.scene()));
  folder.remove_results();
  folder.write_scene_copy(write_scene(simulation.scene()));
  write_block_properties(folder, simulation.scene(), std::as_const(simulation).system());
  StateTables states(folder, simulation.scene());
  states.add_drawing(simulation);
  FactorOfSafety safety;
  double cpu_of_search = 0.0;
  {
    Progress progress("strength reduction", options.quiet);
    const double begin = process_cpu_time();
    watch_for_stop_signals();
    safety = factor_of_safety(simulation, [&](double fraction) {
      progress.update(fraction);
      throw_if_stopped();
    });
    cpu_of_search = process_cpu_time() - begin;
  }

  Summary summary = summary_of("fos", options, loaded);
  summary.cpu_of_search = cpu_of_search;
  summary.warnings.insert(summary.warnings.end(), safety.warnings.begin(), safety.warnings.end());
  print_warnings(safety.warnings);
  for (const NamedState& state : safety.states) {
    states.add(state, simulation.scene());
    if (state.contacts.empty()) continue;
    if (state.name != "failed") summary.max_penetration = deepest_of(state.contacts);
  }
  states.close();
  write_trials(folder, safety.trials);
  if (!safety.mechanism.empty()) write_mechanism(folder, simulation.scene(), safety.mechanism);
  if (!safety.curve.empty()) write_curve(folder, safety.curve);
  summary.converged = safety.found();
  summary.reason = safety.reason;
  write_summary(folder, summary, simulation, &safety);
  write_formats(simulation.scene().formats, folder);

  if (safety.bracket.stopped) {
    fmt::print(stderr, "openclose: {}; state saved in {}\n", safety.reason, folder.path());
    return exit_status_of_stop();
  }
  if (!safety.found()) {
    fmt::print(stderr, "openclose: no factor of safety: {}; state saved in {}\n", safety.reason, folder.path());
    return exit_not_converged;
  }
  if (!options.quiet) print_factor(simulation.scene(), safety, folder);
  return exit_success;
}

void write_spectrum(Simulation& simulation, const std::string& file) {
  const Scene& scene = simulation.scene();
  std::error_code unknown;
  if (std::filesystem::equivalent(file, scene.where.file, unknown))
    throw InputError({file, 0}, "", "this is the scene that is being checked", "another file to write to");
  if (scene.step.dt <= 0.0)
    throw InputError(scene.where, "step.dt_s", "missing", "a step in seconds, here or with --dt: --spectrum asks for its matrix");
  const Spectrum s = spectrum(simulation, scene.step.dt);
  write_files({{file, fmt::format("lowest_rad_per_s,highest_rad_per_s,critical_step_s,condition_number\n{:.17g},{:.17g},{:.17g},{:.17g}\n", s.lowest,
                                  s.highest, 2.0 / s.highest, s.condition)}});
}

int check_command(const Options& options) {
  Loaded loaded = load(options);
  require_memory(loaded.scene, available_memory());
  Simulation simulation(std::move(loaded.scene));
  require_use(simulation.scene());
  const auto& system = std::as_const(simulation).system();
  double area = 0.0, free_area = 0.0;
  for (const auto& block : system.blocks()) area += block.area;
  for (const int b : system.free_blocks()) free_area += system.block(b).area;
  if (options.json) {
    nlohmann::ordered_json found = {
        {"scene", options.scene_file}, {"blocks", system.block_count()},           {"free_blocks", system.free_count()},         {"area_m2", area},
        {"free_area_m2", free_area},   {"contacts", simulation.contacts().size()}, {"method", simulation.scene().method.contact}};
    if (simulation.is_explicit() && std::isfinite(simulation.critical_step())) found["critical_step_s"] = simulation.critical_step();
    if (!options.spectrum_file.empty()) write_spectrum(simulation, options.spectrum_file);
    print_json(exit_success, found);
    return exit_success;
  }
  fmt::print("{}: {} blocks, {} of them free, {:.6g} m2 ({:.6g} m2 free); {} contacts within reach at the start; method {}\n", options.scene_file,
             system.block_count(), system.free_count(), area, free_area, simulation.contacts().size(), simulation.scene().method.contact);
  if (simulation.is_explicit()) {
    const double critical = simulation.critical_step();
    if (std::isfinite(critical)) {
      fmt::print("critical step {:.6g} s; the longest step taken is {:.6g} s\n", critical,
                 simulation.longest_stable_step(simulation.scene().method.damping));
    } else {
      fmt::print("no critical step, since no contact or support is there; the longest step taken is step.dt_s\n");
    }
  }
  if (!options.spectrum_file.empty()) write_spectrum(simulation, options.spectrum_file);
  return exit_success;
}

int cut_command(const Options& options) {
  const Loaded loaded = load(options);
  if (!loaded.scene.cutting) throw InputError(loaded.scene.where, "domain", "the scene has none", "a scene with a [domain] to cut");
  const CuttingSummary& cutting = *loaded.scene.cutting;
  const std::filesystem::path stem = std::filesystem::path(options.scene_file).stem();
  const std::string file = options.blocks_file.empty() ? "results/" + stem.string() + "/blocks.toml" : options.blocks_file;
  const std::string drawing = options.drawing_file.empty() ? std::filesystem::path(file).replace_extension(".svg").string() : options.drawing_file;
  for (const std::string& written : {file, drawing}) {
    std::error_code unknown;
    if (std::filesystem::equivalent(written, options.scene_file, unknown)) {
      throw InputError({written, 0}, "", "this is the scene that is being cut", "another file to write to");
    }
  }
  const auto place_of = [](const std::string& path) { return std::filesystem::weakly_canonical(std::filesystem::absolute(path)); };
  if (place_of(file) == place_of(drawing)) {
    throw InputError({file, 0}, "", "the scene and its drawing cannot be the same file", "another name with --svg");
  }
  write_files({{file, "# Blocks that openclose has cut.\n" + write_scene(loaded.scene)}, {drawing, svg_drawing(picture_of(loaded.scene))}});
  if (options.json) {
    print_json(exit_success, {{"scene", options.scene_file},
                              {"blocks", cutting.blocks},
                              {"traces", cutting.traces},
                              {"area_m2", cutting.area},
                              {"domain_area_m2", cutting.domain_area},
                              {"smallest_block_m2", cutting.smallest_block},
                              {"slivers_merged", cutting.slivers_merged},
                              {"dangling_ends", cutting.dangling_ends},
                              {"written", {file, drawing}}});
  }
  if (options.quiet) return exit_success;
  const auto fixed = std::count_if(loaded.scene.blocks.begin(), loaded.scene.blocks.end(), [](const BlockInput& block) { return block.fixed; });
  fmt::print("{}: {} blocks cut by {} traces, {:.9g} m2 (domain {:.9g} m2), smallest {:.3g} m2; {} of {} blocks fixed\n", options.scene_file,
             cutting.blocks, cutting.traces, cutting.area, cutting.domain_area, cutting.smallest_block, fixed, loaded.scene.blocks.size());
  fmt::print("{} slivers merged ({:.3g} m2), {} dangling ends dropped; written to {} and {}\n", cutting.slivers_merged, cutting.slivers_area,
             cutting.dangling_ends, file, drawing);
  return exit_success;
}

int draw_command(const Options& options) {
  const std::string file = options.drawing_file.empty() ? options.results + "/drawing.svg" : options.drawing_file;
  // A name that is left out, or mistaken for another option's, would write over a scene or a table.
  if (std::filesystem::path(file).extension() != ".svg")
    throw InputError({file, 0}, "-o", "a drawing would be written over what is no drawing", "a name that ends in .svg");
  const Picture picture = picture_of_results(options.results, options.drawing);
  write_files({{file, svg_drawing(picture)}});
  if (options.json)
    print_json(exit_success, {{"results", options.results}, {"blocks", picture.blocks.size()}, {"notes", picture.notes}, {"written", {file}}});
  if (!options.quiet) fmt::print("{}: {} blocks drawn; {}; written to {}\n", options.results, picture.blocks.size(), picture.notes.front(), file);
  return exit_success;
}

int explain_command(const Options& options) {
  if (options.page) {
    fmt::print("{}", keys_page());
  } else if (options.schema) {
    fmt::print("{}", scene_schema());
  } else if (!options.key.empty()) {
    fmt::print("{}", explanation_of(options.key));
  } else {
    throw InputError({"explain", 0}, "", "nothing is asked for", "a key or a table, e.g. theta, step.dt_s or settle; --page; --schema");
  }
  return exit_success;
}

void add_quiet(CLI::App& app, Options& options) {
  app.add_flag("-q,--quiet", options.quiet, "print nothing but warnings and errors");
  add_json_flag(app, options.json, options.quiet);
}

/// "soft (springs ...), hard (...)" from the entries of a registry.
template <typename Entries>
std::string listed(const Entries& entries) {
  std::string list;
  for (const auto& entry : entries) list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", entry.name, entry.summary);
  return list;
}

/// The options that scene commands share; the named ones are short for --set.
void add_options(CLI::App& app, Options& options, bool writes_folder) {
  app.add_option("scene", options.scene_file, "scene file (TOML)")->required();
  const auto shorthand = [&app, &options](const std::string& flag, const std::string& key, const std::string& help) {
    app.add_option_function<std::string>(
        flag, [&options, key](const std::string& value) { options.overrides.push_back(key + "=" + value); }, help);
  };
  shorthand("--contact", "method.contact", "contact enforcement: " + listed(enforcements()));
  shorthand("--start", "method.start", "start state: unloaded, settled, normal_balanced or steady_sliding");
  shorthand("--integrator", "method.integrator", "time integrator of soft: " + listed(integrators()));
  shorthand("--threads", "method.threads",
            fmt::format("threads that share the work of large systems, 1 to {}; the results are the same to the last bit", most_threads));
  shorthand("--dt", "step.dt_s", "time step [s]");
  shorthand("--end", "end.time_s", "end time [s]");
  app.add_option_function<std::vector<std::string>>(
         "--set", [&options](const std::vector<std::string>& v) { options.overrides.insert(options.overrides.end(), v.begin(), v.end()); },
         "KEY=VALUE: overrides any key of the scene, e.g. joint[0].friction_angle_deg=20")
      ->allow_extra_args(false);
  if (!writes_folder) return;
  app.add_option("-o,--output", options.folder,
                 "output folder (default: results/<name of the scene>); files of an earlier run there are removed first");
  add_quiet(app, options);
}

CLI::App* add_draw(CLI::App& app, Options& options) {
  CLI::App* draw = app.add_subcommand("draw", "draw a state of a run or fos as SVG: blocks, what their joints do, what holds and pushes them");
  draw->add_option("results", options.results, "folder that run or fos has written")->required();
  draw->add_option(
      "--state", options.drawing.state,
      "state in blocks.csv, such as initial, start, t=1.5, final, stable, failed (default: failed, the mechanism, of fos; else the last)");
  draw->add_option_function<std::string>(
          "--colour,--color",
          [&options](const std::string& name) {
            const auto& names = block_colour_names();
            options.drawing.colour = static_cast<BlockColour>(std::ranges::find(names, name) - names.begin());
          },
          "what the colours of the blocks tell: material, displacement, velocity (with arrows) or state (default: velocity for a mechanism, else "
          "material)")
      ->check(CLI::IsMember(block_colour_names()));
  draw->add_flag("--forces", options.drawing.forces, "draw the resultants between blocks, as wide as they are large");
  draw->add_flag("--cracks", options.drawing.cracks, "draw the openings of joints, as wide as they are open");
  draw->add_option("-o,--output", options.drawing_file, "SVG file to write (default: drawing.svg in the folder)");
  add_quiet(*draw, options);
  return draw;
}

CLI::App* add_explain(CLI::App& app, Options& options) {
  CLI::App* explain = app.add_subcommand("explain", "tell what a key of the scene file does, its unit, default and what is accepted");
  explain->add_option("key", options.key, "a key, alone or with its table, or a table: theta, step.dt_s, settle");
  explain->add_flag("--page", options.page, "print the reference page of all keys instead (Markdown)");
  explain->add_flag("--schema", options.schema, "print the JSON Schema of scene files instead, for editors that know TOML");
  return explain;
}

int report_failure(int status, const std::string& message, bool json) {
  fmt::print(stderr, "openclose: {}\n", message);
  if (json) print_json_error(status, message);
  return status;
}

int main_checked(int argc, char** argv) {
  CLI::App app{
      "Openclose: 2-D block systems of jointed rock and masonry. Exit status: 0 success, 1 not converged (state saved), 2 bad input (nothing "
      "written), 3 broken off (a result cannot be written, or an internal error), 130 and 143 stopped by SIGINT (Ctrl-C) and SIGTERM."};
  app.set_version_flag("--version", version);
  app.require_subcommand(1);
  Options options;
  int (*command)(const Options&) = nullptr;
  std::function<int()> chosen;
  const auto subcommand = [&](const char* name, const char* help, bool writes_folder, int (*f)(const Options&)) {
    CLI::App* sub = app.add_subcommand(name, help);
    add_options(*sub, options, writes_folder);
    sub->callback([&command, f] { command = f; });
    return sub;
  };
  CLI::App* run = subcommand("run", "follow the blocks in time", true, &run_command);
  run->add_option("--restart", options.restart_file,
                  "go on from this checkpoint.bin of an earlier run of the scene (see output.checkpoint_every_s), continuing the tables beside it");
  subcommand("fos", "factor of safety by strength reduction", true, &fos_command);
  CLI::App* check = subcommand(
      "check", "read and check a scene, write nothing but --spectrum; what run or fos would refuse is refused, whether it settles only they find out",
      false, &check_command);
  check->add_option("--spectrum", options.spectrum_file,
                    "CSV file to write: frequencies of the contacts' springs, critical step 2/w_max, condition number of a step's matrix");
  CLI::App* cut = subcommand("cut", "cut the domain of a scene into blocks, write them as a scene and draw them", false, &cut_command);
  cut->add_option("-o,--output", options.blocks_file, "scene file to write (default: results/<name of the scene>/blocks.toml)");
  cut->add_option("--svg", options.drawing_file, "drawing to write (default: beside the scene file, .svg)");
  add_quiet(*cut, options);
  add_json_flag(*check, options.json, options.quiet);
  add_draw(app, options)->callback([&command] { command = &draw_command; });
  add_explain(app, options)->callback([&command] { command = &explain_command; });
  add_report(app, chosen);
  add_study(app, chosen);
  add_sweep(app, chosen);
  add_shell_commands(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    std::string names;
    if (app.get_subcommands().empty()) {
      for (const CLI::App* sub : app.get_subcommands({})) names += (names.empty() ? "; accepted: " : ", ") + sub->get_name();
    }
    return report_failure(exit_bad_input, fmt::format("{}{}; see openclose --help", e.what(), names), wants_json(argc, argv));
  }
  try {
    const int status = chosen ? chosen() : command(options);
    if (options.json && (command == &run_command || command == &fos_command)) print_json_results(status, output_folder(options).path());
    return status;
  } catch (const std::bad_alloc&) {
    return report_failure(exit_broken_off, "out of memory" + (options.work.empty() ? "" : ": " + options.work), wants_json(argc, argv));
  }
}

}  // namespace
}  // namespace openclose

int main(int argc, char** argv) {
  openclose::return_large_memory();
  openclose::fail_beyond_size_limit();
  try {
    return openclose::main_checked(argc, argv);
  } catch (const openclose::InputError& e) {
    return openclose::report_failure(openclose::exit_bad_input, e.what(), openclose::wants_json(argc, argv));
  } catch (const openclose::Stopped&) {
    return openclose::report_failure(openclose::exit_status_of_stop(), "stopped before there was a state to go on from",
                                     openclose::wants_json(argc, argv));
  } catch (const openclose::WriteError& e) {
    return openclose::report_failure(openclose::exit_broken_off, e.what(), openclose::wants_json(argc, argv));
  } catch (const std::exception& e) {
    return openclose::report_failure(openclose::exit_broken_off, fmt::format("internal error: {}", e.what()), openclose::wants_json(argc, argv));
  }
}
