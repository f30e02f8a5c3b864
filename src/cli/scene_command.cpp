#include "scene_command.h"

#include <fmt/format.h>

#include <filesystem>

#include "openclose/analysis/run.h"
#include "openclose/io/formats.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"

namespace openclose {
namespace {

/// Refuses what would take longer than anyone waits.
void require_countable_steps(const Scene& scene, const std::string& key, double time) {
  constexpr double most_steps = 1e9;
  if (time / most_steps <= scene.step.dt) return;
  throw InputError(scene.where, key, fmt::format("{:g} s in steps of {:g} s", time, scene.step.dt),
                   fmt::format("at most {:g} steps of step.dt_s", most_steps));
}

}  // namespace

void Loaded::warn(const std::string& text) {
  warnings.push_back(scene.where.file + ": " + text);
  print_warnings({warnings.back()});
}

void Loaded::judge_overlaps(Simulation& simulation, FirstMotion first_motion) {
  const std::vector<std::string> found = judge_drawn_overlaps(simulation, first_motion);
  print_warnings(found);
  warnings.insert(warnings.end(), found.begin(), found.end());
}

FirstMotion first_motion_of_run(const Scene& scene) {
  return scene.method.start == Start::unloaded ? FirstMotion::at_once : FirstMotion::settling;
}

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

namespace {

/// One word for a shell, whatever stands in it.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string without_quotes(std::string word) {
  std::erase_if(word, [](char c) { return c == '"' || c == '\'' || c == '/'; });
  return word;
}

}  // namespace

OutputFolder output_folder(const Options& options) {
  if (!options.folder.empty()) return OutputFolder(options.folder);
  std::string name = std::filesystem::path(options.scene_file).stem().string();
  // The multiplier of a load does not take the place of the factor of safety.
  constexpr std::string_view increase = "strength_reduction.increase=";
  for (const std::string& assignment : options.overrides) {
    if (!assignment.starts_with(increase)) continue;
    name += '-';
    name += without_quotes(assignment.substr(increase.size()));
  }
  return OutputFolder("results/" + name);
}

std::string command_to_repeat(const std::string& command, const Options& options, const OutputFolder& folder) {
  std::string line = fmt::format("openclose {} {}", command, quoted(options.scene_file));
  for (const std::string& key_and_value : options.overrides) line += " --set " + quoted(key_and_value);
  return line + " -o " + quoted(folder.path());
}

std::string command_to_go_on(const std::string& command, const Options& options, const OutputFolder& folder) {
  return command_to_repeat(command, options, folder) + " --restart " + quoted(folder.path_of(checkpoint_name));
}

void make_room(const OutputFolder& folder, const Options& options) {
  if (!options.restart_file.empty() && folder.has(options.restart_file)) {
    folder.remove_last_results();
  } else {
    folder.remove_results();
  }
  // What is gone is not ours any more, however this analysis ends.
  folder.forget_removed();
}

std::vector<std::string> files_read(const Options& options, const Scene& scene) {
  std::vector<std::string> files{options.scene_file};
  if (scene.base_motion) files.insert(files.end(), scene.base_motion->files.begin(), scene.base_motion->files.end());
  return files;
}

void require_run(const Scene& scene) {
  if (scene.step.dt <= 0.0) throw InputError(scene.where, "step.dt_s", "missing", "a step in seconds, here or with --dt");
  if (scene.end_time <= 0.0) throw InputError(scene.where, "end.time_s", "missing, or 0", "an end time > 0 in seconds, here or with --end");
  require_countable_steps(scene, "end.time_s", scene.end_time);
}

void require_start(const Scene& scene) {
  const bool can_be_refused = scene.method.start == Start::normal_balanced || scene.method.start == Start::steady_sliding;
  if (!can_be_refused) return;
  Simulation trial(scene);
  prepare_start(trial);
}

void require_strength_reduction(const Scene& scene) {
  const std::optional<double>& curve_time = scene.strength_reduction.curve_time;
  const bool paper = scene.settle.criterion == SettleCriterion::paper;
  if (scene.step.dt <= 0.0 && (curve_time || paper)) {
    throw InputError(scene.where, "step.dt_s", "missing",
                     fmt::format("a step in seconds: {} asks for motion", paper ? "settle.criterion" : "strength_reduction.curve_time_s"));
  }
  if (curve_time) require_countable_steps(scene, "strength_reduction.curve_time_s", *curve_time);
  const StrengthReductionInput& input = scene.strength_reduction;
  if (input.increase && input.definition != FactorDefinition::small_displacements)
    throw InputError(input.increase_where, "strength_reduction.increase", "a load grows on the drawn geometry only",
                     "strength_reduction.definition = \"small_displacements\"");
  if (scene.strength_reduction.definition == FactorDefinition::large_displacements) return;
  const std::string large = "strength_reduction.definition = \"large_displacements\", in which blocks move";
  if (paper) throw InputError(scene.where, "settle.criterion", "\"paper\" is a rule for motion", large);
  if (curve_time) {
    throw InputError(scene.strength_reduction.curve_time_where, "strength_reduction.curve_time_s", "asks for motion, which this definition has not",
                     large);
  }
}

Summary summary_of(const std::string& command, const Options& options, const Loaded& loaded) {
  Summary summary;
  summary.command = command;
  summary.scene_file = options.scene_file;
  summary.overrides = options.overrides;
  summary.warnings = loaded.warnings;
  return summary;
}

}  // namespace openclose
