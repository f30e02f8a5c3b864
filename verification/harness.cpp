#include "harness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "openclose/integrator/registry.h"

namespace openclose::verification {
namespace {

/// A step in which nothing moves and no contact carries anything, always "converged".
class NullEnforcement : public Enforcement {
 public:
  explicit NullEnforcement(const MethodInput& method) : real_(make_enforcement(method)) {}
  ContactSprings springs(const StepProblem& problem, const Contact& contact) const override { return real_->springs(problem, contact); }
  void solve(const StepProblem& problem, StepSolution& solution) override {
    solution.converged = true;
    solution.d = Eigen::VectorXd::Zero(dofs * problem.system.free_count());
    solution.contacts.prepare(problem, real_->springs_of(problem));
    for (std::size_t c = 0; c < problem.contacts.size(); ++c) solution.contacts.set(c, CarriedForces{}, 0.0, 0.0);
    if (problem.end_weight < 1.0) solution.contacts.keep_start_forces();
  }
  bool takes_adaptive_steps() const override { return real_->takes_adaptive_steps(); }
  std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const override { return real_->make_time_scheme(method); }
  bool has_elastic_contacts() const override { return real_->has_elastic_contacts(); }
  LinearCounters linear_counters() const override { return real_->linear_counters(); }

 private:
  std::unique_ptr<Enforcement> real_;
};

}  // namespace

void Report::add(const std::string& quantity, const std::string& method, double expected, double measured, double error, double tolerance,
                 const std::string& unit, const std::string& source) {
  const Status status = error <= tolerance ? Status::pass : Status::fail;  // NaN fails
  checks_.push_back({case_, quantity, method, expected, measured, unit, error, tolerance, status, source, reference_});
  reference_ = reference_of_case_;
}

void Report::near(const std::string& quantity, const std::string& method, double expected, double measured, double tolerance, const std::string& unit,
                  const std::string& source) {
  add(quantity, method, expected, measured, std::abs(measured - expected), tolerance, unit, source);
}

void Report::relative(const std::string& quantity, const std::string& method, double expected, double measured, double tolerance,
                      const std::string& unit, const std::string& source) {
  add(quantity, method, expected, measured, std::abs(measured / expected - 1.0), tolerance, unit, source);
}

void Report::between(const std::string& quantity, const std::string& method, double low, double high, double measured, const std::string& unit,
                     const std::string& source) {
  const double middle = 0.5 * (low + high);
  add(quantity, method, middle, measured, std::abs(measured - middle), 0.5 * (high - low), unit, source);
}

void Report::order(const std::string& quantity, const std::string& method, const std::vector<double>& sizes, const std::vector<double>& errors,
                   double low, double high, const std::string& source, const std::string& size_name) {
  std::string row, ratios;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    series_.push_back({case_, quantity, method, size_name, sizes[i], errors[i]});
    row += fmt::format("{}{:.3g}: {:.2e}", i ? ", " : "", sizes[i], errors[i]);
    if (i > 0) ratios += fmt::format("{}{:.3g}", i > 1 ? ", " : "", errors[i - 1] / errors[i]);
  }
  between(quantity, method, low, high, log_slope(sizes, errors), "-", fmt::format("{} ({}; ratios {})", source, row, ratios));
}

void Report::leave_out(const std::string& quantity, const std::string& method, const std::string& reason) {
  const double none = not_measured();
  checks_.push_back({case_, quantity, method, none, none, "", none, none, Status::left_out, reason, reference_of_case_});
}

Simulation Report::simulate(const Scene& scene) const {
  if (null_solver_) return Simulation(scene, std::make_unique<NullEnforcement>(scene.method));
  return Simulation(scene);
}

double log_slope(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(y[i] > 0.0)) return not_measured();
    const double lx = std::log(x[i]), ly = std::log(y[i]);
    sx += lx;
    sy += ly;
    sxx += lx * lx;
    sxy += lx * ly;
  }
  const auto n = static_cast<double>(x.size());
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::vector<Sample> history(Simulation& simulation) {
  MeasuredPoints points(simulation);
  std::vector<Sample> samples;
  RunObserver observer;
  observer.started = [&](const Simulation&) { points.restart(); };
  observer.output = [&](const Simulation& s) { samples.push_back({s.time(), points.motions().front()}); };
  if (!run(simulation, observer).converged) samples.clear();
  return samples;
}

double not_measured() {
  return std::numeric_limits<double>::quiet_NaN();
}

double larger(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}

double smaller(double a, double b) {
  return -larger(-a, -b);
}

double largest(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0, larger);
}

std::string passed_by_reference(const std::vector<Check>& checks) {
  std::array<long, reference_names.size()> counts{};
  for (const Check& c : checks) counts[static_cast<std::size_t>(c.reference)] += c.status == Status::pass;
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[i], reference_names[i]);
  }
  return text;
}

double exceedance(double measured, double bound) {
  return measured <= bound ? 0.0 : measured - bound;
}

std::string text(const char* format, double value) {
  return fmt::format(fmt::runtime(format), value);
}

}  // namespace openclose::verification
