// The length of the next step from the local error of the last ones: a controller with proportional and integral part (Gustafsson 1991) for errors
// that go with the third power of the step.
#pragma once

#include "openclose/core/archive.h"

namespace openclose {

class StepControl {
 public:
  /// \param tolerance [m] of the local error of a step
  explicit StepControl(double tolerance) : tolerance_(tolerance), last_error_(0.5 * tolerance) {}

  double tolerance() const { return tolerance_; }
  /// [s] of the next step, at most `longest`; that one at first.
  double step(double longest) const;
  /// A step of this length was accepted with this error.
  void accepted(double taken, double error);
  /// A step of this length was refused because of this error, above the tolerance; the next one is to be as long as step() says.
  void refused(double tried, double error);
  /// A step was refused for other reasons, and this length is next.
  void shorten(double next) { step_ = next; }

  void exchange(Archive& archive) { archive(last_error_, step_); }

 private:
  double tolerance_;
  double last_error_;  ///< [m]
  double step_ = 0.0;  ///< [s] 0 before the first step
};

}  // namespace openclose
