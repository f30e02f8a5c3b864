#include "openclose/analysis/step_control.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

constexpr double order = 3.0;  ///< of the local error
constexpr double integral = 0.7 / order, proportional = 0.4 / order;
constexpr double aim = 0.5;  ///< [-] of the tolerance, so that few steps are refused
constexpr double fastest_growth = 5.0, strongest_cut = 0.2, weakest_cut = 0.9;
/// [-] of the tolerance: smaller errors tell no more than that the step may grow as fast as it can.
constexpr double smallest_error = 1e-4;

}  // namespace

double StepControl::step(double longest) const {
  return step_ > 0.0 ? std::min(step_, longest) : longest;
}

void StepControl::accepted(double taken, double error) {
  const double e = std::max(error, smallest_error * tolerance_);
  const double factor = std::pow(aim * tolerance_ / e, integral) * std::pow(last_error_ / (aim * tolerance_), proportional);
  last_error_ = e;
  const double next = taken * std::clamp(factor, strongest_cut, fastest_growth);
  // A step that ended early, at an output time, says nothing against the length that was meant.
  step_ = taken < step_ ? std::max(step_, next) : next;
}

void StepControl::refused(double tried, double error) {
  step_ = tried * std::clamp(std::pow(aim * tolerance_ / error, 1.0 / order), strongest_cut, weakest_cut);
}

}  // namespace openclose
