#include "study_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "case_options.h"
#include "machine_output.h"
#include "messages.h"
#include "openclose/core/error.h"
#include "openclose/integrator/registry.h"
#include "openclose/io/progress.h"
#include "openclose/study/study.h"
#include "openclose/study/variation.h"
#include "option_errors.h"
#include "stop_signal.h"

namespace openclose {
namespace {

struct StudyOptions {
  CaseOptions cases;
  std::vector<double> steps;
  std::vector<std::string> contacts;
  std::string quantity;
  std::optional<double> reference;
};

CLI::Validator time_step() {
  return {[](const std::string& text) {
            const std::optional<double> value = number_from(text);
            return value && *value > 0.0 ? std::string() : fmt::format("{} is no time step; accepted: numbers > 0 in seconds", text);
          },
          "SECONDS"};
}

int study_command(const StudyOptions& options) {
  StudyOrder order;
  order.cases = case_order(options.cases, "run", "study");
  // What is timed must not share a processor.
  if (options.cases.jobs == 0) order.cases.jobs = 1;
  order.overrides = options.cases.overrides;
  order.steps = options.steps;
  order.contacts = options.contacts;
  order.quantity = options.quantity;
  order.reference = options.reference;
  watch_for_stop_signals();
  Study study;
  {
    Progress progress("study", options.cases.quiet);
    study = make_study(order, [&](double fraction) { progress.update(fraction); });
  }
  const std::vector<TextFile> files = study_files(study, order.cases.folder);
  write_files(files);
  print_warnings(study.warnings);
  const bool has_picture = files.size() > 1;
  // One of an earlier study would be taken for the picture of this one.
  std::error_code was_none;
  if (!has_picture) std::filesystem::remove(order.cases.folder + "/study.svg", was_none);
  if (!options.cases.quiet)
    fmt::print("{}written to {}/study.csv{}\n", study_table(study), order.cases.folder,
               has_picture ? " and study.svg" : "; no picture, since there is no error to draw");
  const bool all_ended = std::ranges::all_of(study.rows, [](const StudyRow& row) { return row.status == exit_success; });
  const int status = all_ended ? exit_success : exit_not_converged;
  if (options.cases.json) {
    nlohmann::ordered_json limits = nlohmann::ordered_json::array();
    for (const StudyLimit& limit : study.limits) {
      limits.push_back({{"contact", limit.contact}, {"value", nullptr}, {"how", limit.how}});
      if (limit.value) limits.back()["value"] = *limit.value;
    }
    print_json(status, {{"folder", order.cases.folder},
                        {"quantity", study.quantity},
                        {"limits", limits},
                        {"rows", json_of_table(files.front().text)},
                        {"warnings", study.warnings}});
  }
  return status;
}

}  // namespace

void add_study(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<StudyOptions>();
  CLI::App* study =
      app.add_subcommand("study", "run a scene with several time steps and contacts: error, observed order and run time of one of its quantities");
  add_case_options(*study, options->cases);
  study->add_option("--dt", options->steps, "time steps [s], e.g. 1e-2,5e-3,2.5e-3")->required()->delimiter(',')->check(time_step());
  std::vector<std::string> names;
  for (const auto& entry : enforcements()) names.emplace_back(entry.name);
  study->add_option("--contact", options->contacts, "contact enforcements, e.g. soft,hard,dem (default: the scene's)")
      ->delimiter(',')
      ->check(one_of(names));
  study->add_option("--quantity", options->quantity,
                    "what is compared at the end: POINT.displacement_m or another column of history.csv, energy.kinetic_j, largest_displacement_m "
                    "(default: displacement of the first measured point, else the largest of a block)");
  study->add_option("--reference", options->reference, "exact value, if it is known (default: Richardson's limit, or the smallest step)")
      ->check(finite_number());
  study->callback([options, &chosen] { chosen = [options] { return study_command(*options); }; });
}

}  // namespace openclose
