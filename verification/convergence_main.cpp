// Runs the convergence studies, prints the orders, writes convergence.csv. Exit status 0 if every order lies within its bounds; with --null-solver,
// if none does.
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "studies.h"

namespace openclose::verification {
namespace {

void write_csv(const std::string& folder, const std::vector<Series>& list) {
  std::filesystem::create_directories(folder);
  std::ofstream file(folder + "/convergence.csv");
  file << "case,method,dt_s,error,cpu_s,observed_order,order_band,order_low,order_high,abscissa,size,in_fit,status,source\n";
  for (const Series& s : list) {
    for (const Sized& p : s.points) {
      fmt::print(file, "{},\"{}\",{:.17g},{:.17g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{:.17g},{},{},\"{}\"\n", s.study, s.method, p.dt, p.error,
                 p.cpu, s.order, s.band, s.expected.low, s.expected.high, s.abscissa, p.size, s.in_fit(p) ? 1 : 0, s.ok ? "pass" : "fail",
                 s.expected.why);
    }
  }
  if (!file) throw std::runtime_error("cannot write " + folder + "/convergence.csv");
}

void print(const Series& s) {
  fmt::print("{:<10} {:<34} {:<12} {:>7.3f} +- {:<6.3f} [{:.2f}, {:.2f}] {}  ({})\n", s.study, s.method, s.abscissa, s.order, s.band, s.expected.low,
             s.expected.high, s.ok ? "pass" : "FAIL", s.expected.why);
  for (const Sized& p : s.points) fmt::print("{:>24.4g} {:>12.4e} {}\n", p.size, p.error, s.in_fit(p) ? "" : "not in the fit");
  std::fflush(stdout);
}

int run_all(const std::vector<std::string>& wanted, const std::string& folder, bool null_solver) {
  Studies studies_run(null_solver);
  std::size_t printed = 0;
  for (const Study& study : Registered<Study>::all()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), study.name) == wanted.end()) continue;
    studies_run.begin(study.name);
    study.run(studies_run);
    for (; printed < studies_run.series().size(); ++printed) print(studies_run.series()[printed]);
  }
  const auto& list = studies_run.series();
  const long passed = std::count_if(list.begin(), list.end(), [](const Series& s) { return s.ok; });
  const long failed = static_cast<long>(list.size()) - passed;
  if (null_solver) {
    fmt::print("\nwith a solver that does nothing: {} series red, {} still green\n", failed, passed);
    return passed == 0 && failed > 0 ? 0 : 1;
  }
  write_csv(folder, list);
  fmt::print("\n{} series within their bounds, {} not; {}/convergence.csv\n", passed, failed, folder);
  return failed == 0 && passed > 0 ? 0 : 1;
}

}  // namespace
}  // namespace openclose::verification

int main(int argc, char** argv) {
  CLI::App app{"Convergence of Openclose in time step, stiffness and number of blocks"};
  std::string folder = "results";
  std::vector<std::string> wanted;
  bool null_solver = false;
  app.add_option("--results", folder, "folder of convergence.csv");
  app.add_option("studies", wanted, "names of studies, e.g. spring bounce (default: all)");
  app.add_flag("--null-solver", null_solver, "replace the solver by one that does nothing and expect every series to fail");
  CLI11_PARSE(app, argc, argv);
  try {
    return openclose::verification::run_all(wanted, folder, null_solver);
  } catch (const std::exception& e) {
    fmt::print(stderr, "openclose-convergence: {}\n", e.what());
    return 2;
  }
}
