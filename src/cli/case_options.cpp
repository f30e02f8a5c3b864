#include "case_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "machine_output.h"
#include "openclose/io/output_folder.h"
#include "stop_signal.h"

namespace openclose {

void add_case_options(CLI::App& app, CaseOptions& options) {
  app.add_option("scene", options.scene_file, "scene file (TOML)")->required();
  app.add_option_function<std::string>(
      "--end", [&options](const std::string& value) { options.overrides.push_back("end.time_s=" + value); }, "end time [s]");
  app.add_option_function<std::vector<std::string>>(
         "--set", [&options](const std::vector<std::string>& v) { options.overrides.insert(options.overrides.end(), v.begin(), v.end()); },
         "KEY=VALUE: overrides any key of the scene in all cases, e.g. joint[0].friction_angle_deg=20")
      ->allow_extra_args(false);
  app.add_option(
         "-j,--jobs", options.jobs,
         "cases that run at a time, each a process (default: of a study, whose cases are timed, one; of a sweep as many as there are processors)")
      ->check(CLI::Range(1, 1024));
  app.add_option("-o,--output", options.folder, "folder with the table, the picture and a folder for each case; what is there is not run again");
  app.add_flag("-q,--quiet", options.quiet, "print nothing but warnings and errors");
  add_json_flag(app, options.json, options.quiet);
}

CaseOrder case_order(const CaseOptions& options, const std::string& command, const std::string& kind) {
  CaseOrder order;
  order.program = this_program();
  order.command = command;
  order.scene_file = options.scene_file;
  order.folder = options.folder.empty() ? "results/" + std::filesystem::path(options.scene_file).stem().string() + "-" + kind : options.folder;
  require_no_root(order.folder);
  order.jobs = options.jobs > 0 ? options.jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  order.interruption = throw_if_stopped;
  return order;
}

}  // namespace openclose
