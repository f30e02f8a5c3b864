#include "report_command.h"

#include <fmt/format.h>

#include <memory>

#include "machine_output.h"
#include "messages.h"
#include "openclose/core/error.h"
#include "openclose/io/text_files.h"
#include "openclose/report/report.h"
#include "option_errors.h"

namespace openclose {
namespace {

constexpr double bytes_per_mb = 1e6;

struct ReportOptions {
  std::string results;
  std::string file;
  double most_mb = 100.0;
  bool quiet = false, json = false;
};

int report_command(const ReportOptions& options) {
  const std::string file = options.file.empty() ? options.results + "/report.html" : options.file;
  require_ending(file, ".html", "page");
  const Report report = report_of_results(options.results, {static_cast<std::size_t>(options.most_mb * bytes_per_mb)});
  write_files({{file, report.html, false, Seal::xml}});
  if (options.json)
    print_json(exit_success, {{"results", options.results},
                              {"answer", report.answer},
                              {"states", report.states},
                              {"states_left_out", report.left_out},
                              {"states_without_contacts", report.without_contacts},
                              {"written", {file}}});
  if (options.quiet) return exit_success;
  fmt::print("{}: page of {} states{}{}; written to {}\n", options.results, report.states, report.answer.empty() ? "" : "; ", report.answer, file);
  if (report.left_out + report.without_contacts > 0)
    fmt::print("{} states are left out and {} are without contacts, so that the page has {:.3g} MB; --most-mb allows more\n", report.left_out,
               report.without_contacts, static_cast<double>(report.html.size()) / bytes_per_mb);
  return exit_success;
}

}  // namespace

void add_report(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* report = app.add_subcommand(
      "report", "write a run or fos as one HTML page: the answer and how far to trust it, a film of the states, curves; needs no network");
  report->add_option("results", options->results, "folder that run or fos has written")->required();
  report->add_option("-o,--output", options->file, "HTML file to write (default: report.html in the folder)");
  report->add_option("--most-mb", options->most_mb, "size of all states above which contacts and states are left out, evenly [MB] (default: 100)")
      ->check(finite_number())
      ->check(CLI::Range(1.0, 2000.0));
  report->add_flag("-q,--quiet", options->quiet, "print nothing but warnings and errors");
  add_json_flag(*report, options->json, options->quiet);
  report->callback([options, &chosen] { chosen = [options] { return report_command(*options); }; });
}

}  // namespace openclose
