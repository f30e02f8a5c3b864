#include "studies.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>

#include <cmath>
#include <ctime>

namespace openclose::verification {

void use(const Scheme& scheme, Scene& scene) {
  set_scheme(scene, scheme);
  use_joint_springs_as_penalty(scene);
}

Fit fit_order(const std::vector<Sized>& points) {
  std::vector<double> x, y;
  for (const Sized& p : points) {
    x.push_back(std::log(p.size));
    y.push_back(std::log(p.error));
  }
  const std::size_t n = points.size();
  if (n < 3) return {not_measured(), not_measured()};
  double offset = 0.0, slope = 0.0, c00 = 0.0, c01 = 0.0, c11 = 0.0, squares = 0.0;
  gsl_fit_linear(x.data(), 1, y.data(), 1, n, &offset, &slope, &c00, &c01, &c11, &squares);
  return {slope, gsl_cdf_tdist_Pinv(0.975, static_cast<double>(n) - 2.0) * std::sqrt(c11)};
}

void Studies::measure(const std::string& method, const std::string& abscissa, const std::vector<double>& sizes, const Expectation& expected,
                      const std::function<double(double)>& error, const std::function<double(double)>& dt) {
  Series s{study_, method, abscissa, {}, expected};
  std::vector<Sized> fitted;
  for (const double size : sizes) {
    const std::clock_t begin = std::clock();
    const double e = error(size);
    s.points.push_back({size, dt(size), e, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC});
    // An error that could not be measured belongs to the fit and spoils it.
    if (s.in_fit(s.points.back()) || std::isnan(e)) fitted.push_back(s.points.back());
  }
  const Fit fit = fit_order(fitted);
  s.order = fit.order;
  s.band = fit.band;
  s.ok = s.order >= expected.low && s.order <= expected.high;  // NaN fails
  series_.push_back(s);
}

void Studies::in_time(const std::string& method, const std::vector<double>& steps, const Expectation& expected,
                      const std::function<double(double)>& error) {
  measure(method, "dt_s", steps, expected, error, [](double dt) { return dt; });
}

bool follow(Simulation& simulation, double dt, double end) {
  constexpr double rounding = 1e-9;  // [-] of a step
  const auto whole = static_cast<long>(std::floor(end / dt * (1.0 + 1e-14) + rounding));
  for (long i = 0; i < whole; ++i) {
    if (!simulation.advance(dt)) return false;
  }
  const double rest = end - static_cast<double>(whole) * dt;
  return rest <= rounding * dt || simulation.advance(rest);
}

Eigen::Vector3d push_and_follow(const Studies& studies, Scene scene, int b, const Eigen::Vector3d& velocity, double dt, double end) {
  const Eigen::Vector3d none = Eigen::Vector3d::Constant(not_measured());
  scene.step.dt = dt;
  scene.settle.unbalanced_fraction = 1e-12;
  Simulation simulation = studies.simulate(scene);
  if (!settle(simulation).settled) return none;
  const Eigen::Vector3d rest = simulation.system().displacement(b);
  simulation.set_velocity(b, velocity);
  simulation.restart_clock();
  if (!follow(simulation, dt, end)) return none;
  return simulation.system().displacement(b) - rest;
}

std::vector<double> halved(double first, int count, double ratio) {
  std::vector<double> list;
  for (double size = first; static_cast<int>(list.size()) < count; size /= ratio) list.push_back(size);
  return list;
}

}  // namespace openclose::verification
