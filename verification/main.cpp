// Runs the verification cases, prints a table, writes verify.csv. Exit status 0 if every check passed; with --null-solver, if every check failed.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "harness.h"

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

void write_csv(const std::string& folder, const std::vector<Check>& checks) {
  std::filesystem::create_directories(folder);
  std::ofstream file(folder + "/verify.csv");
  file << "case,quantity,method,expected,measured,unit,error,tolerance,status,source\n";
  for (const Check& c : checks) {
    fmt::print(file, "{},{},{},{:.17g},{:.17g},{},{:.6g},{:.6g},{},{}\n", c.case_name, quoted(c.quantity), c.method, c.expected, c.measured, c.unit,
               c.error, c.tolerance, c.status == Status::fail ? "fail" : name_of(c.status), quoted(c.source));
  }
  if (!file) throw std::runtime_error("cannot write " + folder + "/verify.csv");
}

void print(const Check& c) {
  if (c.status == Status::left_out) {
    fmt::print("{:<4} {:<58} {:<6} left out: {}\n", c.case_name, c.quantity, c.method, c.source);
  } else {
    fmt::print("{:<4} {:<58} {:<6} {:>14.8g} {:>14.8g} {:<6} {:>9.2e} {:>9.2e} {}\n", c.case_name, c.quantity, c.method, c.expected, c.measured,
               c.unit, c.error, c.tolerance, name_of(c.status));
  }
  std::fflush(stdout);
}

int run_all(const std::vector<std::string>& wanted, const std::string& folder, bool null_solver) {
  Report report(null_solver);
  fmt::print("{:<4} {:<58} {:<6} {:>14} {:>14} {:<6} {:>9} {:>9} {}\n", "case", "quantity", "method", "expected", "measured", "unit", "error",
             "allowed", "");
  std::size_t printed = 0;
  for (const Case& c : cases()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), c.name) == wanted.end()) continue;
    report.begin_case(c.name);
    c.run(report);
    for (; printed < report.checks().size(); ++printed) print(report.checks()[printed]);
  }
  const auto count = [&](Status s) {
    return std::count_if(report.checks().begin(), report.checks().end(), [&](const Check& c) { return c.status == s; });
  };
  const long passed = count(Status::pass), failed = count(Status::fail), left_out = count(Status::left_out);
  if (null_solver) {
    fmt::print("\nwith a solver that does nothing: {} checks red, {} still green, {} left out\n", failed, passed, left_out);
    fmt::print("{} passed, {} failed\n", failed, passed);
    return passed == 0 && failed > 0 ? 0 : 1;
  }
  write_csv(folder, report.checks());
  fmt::print("\n{} left out, with their reasons; all rows in {}/verify.csv\n{} passed, {} failed\n", left_out, folder, passed, failed);
  return failed == 0 && passed > 0 ? 0 : 1;
}

}  // namespace
}  // namespace openclose::verification

int main(int argc, char** argv) {
  CLI::App app{"Verification of Openclose against closed forms and reference solutions"};
  std::string folder = "results";
  std::vector<std::string> wanted;
  bool null_solver = false;
  app.add_option("--results", folder, "folder of verify.csv");
  app.add_option("cases", wanted, "names of cases, e.g. B1 E1 (default: all)");
  app.add_flag("--null-solver", null_solver, "replace the solver by one that does nothing and expect every check to fail");
  CLI11_PARSE(app, argc, argv);
  try {
    return openclose::verification::run_all(wanted, folder, null_solver);
  } catch (const std::exception& e) {
    fmt::print(stderr, "openclose-verify: {}\n", e.what());
    return 2;
  }
}
