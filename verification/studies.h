// Convergence studies: errors against a size (time step, 1/kn, 1/number of blocks), the order fitted over the asymptotic range with its confidence
// band, and bounds of that order from theory. A study is a file in studies/; a way to integrate is a line in schemes() of scenes.cpp.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness.h"
#include "scenes.h"

namespace openclose::verification {

/// Gives the scene the scheme; `shi` gets the joint's springs for penalties.
void use(const Scheme& scheme, Scene& scene);

struct Sized {
  double size = 0.0;  ///< of the abscissa
  double dt = 0.0;    ///< [s]
  double error = 0.0;
  double cpu = 0.0;  ///< [s] of the process
};

/// What theory says of a series.
struct Expectation {
  double low = 0.0, high = 0.0;  ///< of the order
  double largest_size = 0.0;     ///< the asymptotic range begins here ...
  double floor = 0.0;            ///< ... and ends where errors come down to this (rounding, or what the reference leaves out)
  std::string why;
};

struct Series {
  std::string study;
  std::string method;
  std::string abscissa;  ///< "dt_s", "1/kn [m3/N]", "1/n"
  std::vector<Sized> points;
  Expectation expected;
  double order = 0.0;  ///< NaN if fewer than three points lie in the asymptotic range
  double band = 0.0;   ///< half width of its 95 % confidence interval
  bool ok = false;

  bool in_fit(const Sized& p) const { return p.size <= expected.largest_size && p.error > expected.floor; }
};

class Studies {
 public:
  explicit Studies(bool null_solver) : report_(null_solver) {}

  void begin(const std::string& study) { study_ = study; }
  Simulation simulate(const Scene& scene) const { return report_.simulate(scene); }
  const Report& report() const { return report_; }

  /// Measures the error at every size; dt(size) tells the step that belongs to it.
  void measure(const std::string& method, const std::string& abscissa, const std::vector<double>& sizes, const Expectation& expected,
               const std::function<double(double size)>& error, const std::function<double(double size)>& dt);
  /// The same in the time step.
  void in_time(const std::string& method, const std::vector<double>& steps, const Expectation& expected,
               const std::function<double(double dt)>& error);

  const std::vector<Series>& series() const { return series_; }

 private:
  Report report_;
  std::string study_;
  std::vector<Series> series_;
};

/// Least-squares slope of log(error) over log(size), and half the width of its 95 % confidence interval (Student, n - 2 degrees of freedom); NaN for
/// fewer than three points or an error that is not positive.
struct Fit {
  double order, band;
};
Fit fit_order(const std::vector<Sized>& points);

/// Steps of dt, the last one shorter where `end` [s] is no multiple; false if a step does not succeed.
bool follow(Simulation& simulation, double dt, double end);
/// Displacement of block b from where it settles, `end` [s] after it was given a velocity there; NaN if that does not succeed.
Eigen::Vector3d push_and_follow(const Studies& studies, Scene scene, int b, const Eigen::Vector3d& velocity, double dt, double end);

/// first, first/ratio, first/ratio^2, ...
std::vector<double> halved(double first, int count, double ratio = 2.0);

/// Registers itself from its source in studies/.
struct Study {
  const char* name;  ///< "spring", its identifier
  const char* title;
  void (*run)(Studies&);
};

}  // namespace openclose::verification
