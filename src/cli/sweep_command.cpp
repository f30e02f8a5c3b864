#include "sweep_command.h"

#include <fmt/format.h>

#include <memory>

#include "case_options.h"
#include "machine_output.h"
#include "messages.h"
#include "openclose/core/error.h"
#include "openclose/io/progress.h"
#include "openclose/study/sweep.h"
#include "option_errors.h"
#include "stop_signal.h"

namespace openclose {
namespace {

struct SweepOptions {
  CaseOptions cases;
  std::string command = "fos";
  std::vector<std::string> variations;
  std::string quantity;
};

int sweep_command(const SweepOptions& options) {
  SweepOrder order;
  order.cases = case_order(options.cases, options.command, "sweep");
  order.overrides = options.cases.overrides;
  order.quantity = options.quantity;
  for (const std::string& text : options.variations) order.variations.push_back(variation_from(text));
  if (options.command == "fos" && !options.quantity.empty())
    throw InputError({"sweep", 0}, "--quantity", "is for --command run; fos has the factor of safety", "--command run, or none");
  watch_for_stop_signals();
  Sweep sweep;
  {
    Progress progress("sweep", options.cases.quiet);
    sweep = make_sweep(order, [&](double fraction) { progress.update(fraction); });
  }
  write_files(sweep.files);
  print_warnings(sweep.warnings);
  if (!options.cases.quiet) {
    fmt::print("{} of {} cases have an answer", sweep.found, sweep.cases);
    if (sweep.intervals > 0) fmt::print(", {} of them only an interval", sweep.intervals);
    if (sweep.were_there > 0) fmt::print(" ({} were there)", sweep.were_there);
    fmt::print("; written to {}{}\n", sweep.files.front().path, sweep.files.size() > 1 ? " and sweep.svg" : "");
  }
  const int status = sweep.found == sweep.cases ? exit_success : exit_not_converged;
  if (options.cases.json) {
    print_json(status, {{"folder", order.cases.folder},
                        {"cases", sweep.cases},
                        {"found", sweep.found},
                        {"intervals", sweep.intervals},
                        {"were_there", sweep.were_there},
                        {"rows", json_of_table(sweep.files.front().text)},
                        {"warnings", sweep.warnings}});
  }
  return status;
}

}  // namespace

void add_sweep(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* sweep = app.add_subcommand(
      "sweep", "run a scene for every combination of values of some keys: one table, one picture; goes on where it was broken off");
  add_case_options(*sweep, options->cases);
  sweep->add_option("--vary", options->variations, "KEY=FROM:TO:STEP or KEY=A,B,C, once for each key, e.g. joint[0].friction_angle_deg=25:40:1")
      ->required()
      ->allow_extra_args(false);
  sweep->add_option("--command", options->command, "what is run: fos (default) or run")->check(one_of({"fos", "run"}));
  sweep->add_option("--quantity", options->quantity, "of run, what is written of the end: as for study");
  sweep->callback([options, &chosen] { chosen = [options] { return sweep_command(*options); }; });
}

}  // namespace openclose
