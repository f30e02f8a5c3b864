// The command: reads what the user asked for, calls the command that does it, says how it ended. No physics here.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>

#include "commands.h"
#include "machine_output.h"
#include "messages.h"
#include "new_command.h"
#include "openclose/core/error.h"
#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"
#include "openclose/io/key_reference.h"
#include "openclose/io/progress.h"
#include "openclose/scene/toml_text.h"
#include "openclose/version.h"
#include "option_errors.h"
#include "report_command.h"
#include "shell_commands.h"
#include "stop_signal.h"
#include "study_command.h"
#include "sweep_command.h"

namespace openclose {

int explain_command(const Options& options) {
  if (options.page) {
    fmt::print("{}", keys_page());
  } else if (options.schema) {
    fmt::print("{}", scene_schema());
  } else if (!options.key.empty()) {
    fmt::print("{}", explanation_of(options.key));
  } else {
    fmt::print("{}", tables_in_words());
  }
  return exit_success;
}

namespace {

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
/// \param idle  those that change nothing of what the command does: they are accepted, as on any scene, and not told in its help
void add_options(CLI::App& app, Options& options, bool writes_folder, const std::vector<std::string>& idle) {
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
  for (const std::string& name : idle) app.get_option(name)->group("");
  if (!writes_folder) return;
  app.add_option("-o,--output", options.folder,
                 "output folder (default: results/<name of the scene>); files of an earlier run there are removed first");
  add_quiet(app, options);
}

CLI::App* add_draw(CLI::App& app, Options& options) {
  CLI::App* draw =
      app.add_subcommand("draw", "draw a scene, or a state of a run or fos, as SVG: blocks, what their joints do, what holds and pushes them");
  draw->add_option("results", options.results, "folder that run or fos has written, or a scene file (.toml)")->required();
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
      ->check(one_of(block_colour_names()));
  draw->add_flag("--forces", options.drawing.forces, "draw the resultants between blocks, as wide as they are large");
  draw->add_flag("--cracks", options.drawing.cracks, "draw the openings of joints, as wide as they are open");
  draw->add_option("-o,--output", options.drawing_file, "SVG file to write (default: drawing.svg in the folder; of a scene, beside it)");
  add_quiet(*draw, options);
  return draw;
}

CLI::App* add_explain(CLI::App& app, Options& options) {
  CLI::App* explain = app.add_subcommand("explain", "tell what a key of the scene file does, its unit, default and what is accepted");
  explain->add_option("key", options.key, "a key, alone or with its table, or a table: theta, step.dt_s, settle (default: lists the tables)");
  explain->add_flag("--page", options.page, "print the reference page of all keys instead (Markdown)");
  explain->add_flag("--schema", options.schema, "print the JSON Schema of scene files instead, for editors that know TOML");
  return explain;
}

int report_failure(int status, const std::string& message, bool json) {
  print_message(message);
  if (json) print_json_error(status, message);
  return status;
}

/// What `fos` has besides the options of every analysis.
void add_fos_options(CLI::App& fos, Options& options) {
  fos.add_option_function<std::string>(
      "--increase",
      [&options](const std::string& load) { options.overrides.push_back("strength_reduction.increase=" + toml(std::string_view(load))); },
      "the strength stays, and this load grows from 0 until the blocks fail: gravity_x, gravity_y or the name of loads; --increase=-gravity_x turns "
      "it around");
  fos.add_option("--restart", options.restart_file,
                 "go on from the checkpoint.bin that a search which was broken off has left: no trial is made again");
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
  const auto subcommand = [&](const char* name, const char* help, bool writes_folder, int (*f)(const Options&),
                              const std::vector<std::string>& idle = {}) {
    CLI::App* sub = app.add_subcommand(name, help);
    add_options(*sub, options, writes_folder, idle);
    sub->callback([&command, f] { command = f; });
    return sub;
  };
  CLI::App* run = subcommand("run", "follow the blocks in time", true, &run_command);
  run->add_option("--restart", options.restart_file,
                  "go on from this checkpoint.bin of an earlier run of the scene (see output.checkpoint_every_s), continuing the tables beside it");
  CLI::App* fos = subcommand("fos", "factor of safety by strength reduction, or the multiplier of a load", true, &fos_command);
  add_fos_options(*fos, options);
  CLI::App* check = subcommand(
      "check", "read and check a scene, write nothing but --spectrum; what run or fos would refuse is refused, whether it settles only they find out",
      false, &check_command, {"--threads"});
  check->add_option("--spectrum", options.spectrum_file,
                    "CSV file to write: frequencies of the contacts' springs, critical step 2/w_max, condition number of a step's matrix");
  CLI::App* cut = subcommand("cut", "cut the domain of a scene into blocks, write them as a scene and draw them", false, &cut_command,
                             {"--contact", "--start", "--integrator", "--threads", "--dt", "--end"});
  cut->add_option("-o,--output", options.blocks_file, "scene file to write (default: results/<name of the scene>/blocks.toml)");
  cut->add_option("--svg", options.drawing_file, "drawing to write (default: beside the scene file, .svg)");
  add_quiet(*cut, options);
  add_json_flag(*check, options.json, options.quiet);
  add_draw(app, options)->callback([&command] { command = &draw_command; });
  add_explain(app, options)->callback([&command] { command = &explain_command; });
  add_new(app, chosen);
  add_report(app, chosen);
  add_study(app, chosen);
  add_sweep(app, chosen);
  add_shell_commands(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    return report_failure(exit_bad_input, words_of(e, app, {argv + std::min(argc, 1), argv + argc}), wants_json(argc, argv));
  }
  try {
    const int status = chosen ? chosen() : command(options);
    if (options.json && (command == &run_command || command == &fos_command)) print_json_results(status, output_folder(options).path());
    return status;
  } catch (const std::bad_alloc&) {
    return report_failure(exit_broken_off, "out of memory" + (options.work.empty() ? "" : ": " + options.work), wants_json(argc, argv));
  }
}

int main_caught(int argc, char** argv) {
  try {
    return main_checked(argc, argv);
  } catch (const InputError& e) {
    return report_failure(exit_bad_input, e.what(), wants_json(argc, argv));
  } catch (const Stopped& stop) {
    return report_failure(exit_status_of_stop(), stop.what(), wants_json(argc, argv));
  } catch (const WriteError& e) {
    return report_failure(exit_broken_off, e.what(), wants_json(argc, argv));
  } catch (const std::exception& e) {
    if (has_lost_output()) return exit_success;  // which turns into the status of lost output
    return report_failure(exit_broken_off, fmt::format("internal error: {}", e.what()), wants_json(argc, argv));
  }
}

}  // namespace
}  // namespace openclose

namespace {

/// A file that is opened gets the lowest number that is free: where a standard stream has been closed, messages would go into the first table. What
/// is written to standard output is lost then, and is to be told so, as by a full device.
void keep_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) < 0) open(stream == STDOUT_FILENO ? "/dev/full" : "/dev/null", O_RDWR);
  }
}

}  // namespace

int main(int argc, char** argv) {
  keep_standard_streams();
  openclose::return_large_memory();
  openclose::fail_beyond_size_limit();
  return openclose::status_after_output(openclose::main_caught(argc, argv));
}
