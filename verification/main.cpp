// Runs the verification cases, prints a table, writes verify.csv, verify_series.csv (the points of the convergence rows) and verify_cases.csv (what
// the cases are). Exit status 0 if every check passed; with --null-solver, if every check failed.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "harness.h"
#include "last_values.h"

namespace openclose::verification {
namespace {

const char* name_of(Status status) {
  switch (status) {
    case Status::pass:
      return "pass";
    case Status::fail:
      return "FAIL";
    case Status::left_out:
      return "left out";
  }
  return "";
}

std::string quoted(const std::string& s) {
  std::string q = "\"";
  for (char c : s) {
    if (c == '"') q += '"';
    q += c;
  }
  return q + '"';
}

void write_checks(const std::string& path, const std::vector<Check>& checks) {
  std::ofstream file(path);
  file << "case,quantity,method,expected,measured,unit,error,tolerance,status,source,reference\n";
  for (const Check& c : checks) {
    fmt::print(file, "{},{},{},{:.17g},{:.17g},{},{:.6g},{:.6g},{},{},{}\n", c.case_name, quoted(c.quantity), quoted(c.method), c.expected, c.measured,
               quoted(c.unit), c.error, c.tolerance, c.status == Status::fail ? "fail" : name_of(c.status), quoted(c.source),
               reference_names[static_cast<std::size_t>(c.reference)]);
  }
  if (!file) throw std::runtime_error("cannot write " + path);
}

void write_series(const std::string& path, const std::vector<SeriesPoint>& series) {
  std::ofstream file(path);
  file << "case,quantity,method,size_name,size,error\n";
  for (const SeriesPoint& p : series) {
    fmt::print(file, "{},{},{},{},{:.17g},{:.17g}\n", p.case_name, quoted(p.quantity), quoted(p.method), p.size_name, p.size, p.error);
  }
  if (!file) throw std::runtime_error("cannot write " + path);
}

void write_cases(const std::string& path, const std::vector<Case>& cases) {
  std::ofstream file(path);
  file << "case,title\n";
  for (const Case& c : cases) fmt::print(file, "{},{}\n", c.name, quoted(c.title));
  if (!file) throw std::runtime_error("cannot write " + path);
}

void print(const Check& c) {
  if (c.status == Status::left_out) {
    fmt::print("  {:<62} {:<5} left out: {}\n", c.quantity, c.method, c.source);
  } else {
    fmt::print("  {:<62} {:<5} {:>14.8g} {:>14.8g} {:<6} {:>9.2e} {:>9.2e} {}\n", c.quantity, c.method, c.expected, c.measured, c.unit, c.error,
               c.tolerance, name_of(c.status));
  }
}

struct Totals {
  long passed = 0, failed = 0, left_out = 0;
};

Totals count(const std::vector<Check>& checks, std::size_t from) {
  Totals totals;
  for (std::size_t i = from; i < checks.size(); ++i) {
    ++(checks[i].status == Status::pass ? totals.passed : checks[i].status == Status::fail ? totals.failed : totals.left_out);
  }
  return totals;
}

/// The rows from `from` on under a title, and one line that counts them.
void print_group(const std::string& name, const std::string& title, const std::vector<Check>& checks, std::size_t from) {
  fmt::print("\n{} {}\n", name, title);
  for (std::size_t i = from; i < checks.size(); ++i) print(checks[i]);
  const Totals t = count(checks, from);
  fmt::print("{}: {} passed", name, t.passed);
  if (t.failed > 0) fmt::print(", {} FAILED", t.failed);
  if (t.left_out > 0) fmt::print(", {} left out", t.left_out);
  fmt::print("\n");
  std::fflush(stdout);
}

struct Options {
  std::string folder = "results";
  std::vector<std::string> wanted;
  bool null_solver = false;
  bool renew_last_values = false;
};

int run_all(const Options& options) {
  const std::vector<Case> cases = Registered<Case>::all();
  Report report(options.null_solver);
  const std::vector<Check>& checks = report.checks();
  fmt::print("  {:<62} {:<5} {:>14} {:>14} {:<6} {:>9} {:>9}\n", "quantity", "method", "expected", "measured", "unit", "error", "allowed");
  for (const Case& c : cases) {
    if (!options.wanted.empty() && std::find(options.wanted.begin(), options.wanted.end(), c.name) == options.wanted.end()) continue;
    const std::size_t from = checks.size();
    report.begin_case(c.name, c.reference);
    c.run(report);
    print_group(c.name, c.title, checks, from);
  }
  std::vector<LastValue> last_values = read_last_values(OPENCLOSE_LAST_VALUES);
  if (options.renew_last_values) {
    const int renewed = renew(last_values, checks);
    write_last_values(OPENCLOSE_LAST_VALUES, last_values);
    fmt::print("\n{} values renewed in {}\n", renewed, OPENCLOSE_LAST_VALUES);
  }
  const std::size_t from = checks.size();
  compare(report, last_values);
  if (checks.size() > from) print_group("last values", "what the program itself gave when they were last renewed", checks, from);

  const Totals totals = count(checks, 0);
  if (options.null_solver) {
    fmt::print("\nwith a solver that does nothing: {} checks red, {} still green, {} left out\n", totals.failed, totals.passed, totals.left_out);
    fmt::print("{} passed, {} failed\n", totals.failed, totals.passed);
    return totals.passed == 0 && totals.failed > 0 ? 0 : 1;
  }
  std::filesystem::create_directories(options.folder);
  write_checks(options.folder + "/verify.csv", checks);
  write_series(options.folder + "/verify_series.csv", report.series());
  write_cases(options.folder + "/verify_cases.csv", cases);
  fmt::print("\n{} left out, with their reasons; all rows in {}/verify.csv\npassed against: {}\n{} passed, {} failed\n", totals.left_out,
             options.folder, passed_by_reference(checks), totals.passed, totals.failed);
  return totals.failed == 0 && totals.passed > 0 ? 0 : 1;
}

}  // namespace
}  // namespace openclose::verification

int main(int argc, char** argv) {
  CLI::App app{"Verification of Openclose against closed forms and reference solutions"};
  openclose::verification::Options options;
  app.add_option("--results", options.folder, "folder of verify.csv, verify_series.csv and verify_cases.csv, which then hold the cases of this run")
      ->capture_default_str();
  app.add_option("cases", options.wanted, "names of cases, e.g. B1 E1 (default: all)");
  auto* null_solver =
      app.add_flag("--null-solver", options.null_solver, "replace the solver by one that does nothing and expect every check to fail");
  app.add_flag("--renew-last-values", options.renew_last_values, "write what comes out into " OPENCLOSE_LAST_VALUES)->excludes(null_solver);
  CLI11_PARSE(app, argc, argv);
  try {
    return openclose::verification::run_all(options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "openclose-verify: {}\n", e.what());
    return 2;
  }
}
