// Ordinary differential equations with events, by SUNDIALS CVODE (variable-order Adams): what the reference solutions with impacts and with sticking
// and slipping are made of. Between events the right side must be smooth; the caller decides what an event does and goes on.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace openclose::analytical {

struct EventOde {
  /// y' = f(t, y).
  std::function<void(double time, const double* y, double* rates)> rates;
  /// Functions whose passage through zero is an event; may be empty.
  std::function<void(double time, const double* y, double* values)> roots;
  int root_count = 0;
  double relative_tolerance = 1e-13;
  std::vector<double> absolute_tolerances;                        ///< one for each unknown, in its unit
  double longest_step = std::numeric_limits<double>::infinity();  ///< [s] two passages of one root within a step go unseen
};

/// One passage through zero.
struct Crossing {
  int root;
  int direction;  ///< +1: from below
};

class EventIntegration {
 public:
  EventIntegration(EventOde ode, double time, std::vector<double> y);
  ~EventIntegration();
  EventIntegration(const EventIntegration&) = delete;
  EventIntegration& operator=(const EventIntegration&) = delete;

  /// Moves on to `time` [s] or to the first event before it; empty if it got there. The right side is not evaluated beyond `time`.
  /// \throws std::runtime_error if CVODE gives up
  std::vector<Crossing> advance(double time);
  /// To be called when the right side, or the state by an impact, has changed.
  void restart(std::vector<double> y);
  void restart() { restart(y_); }

  double time() const { return time_; }
  const std::vector<double>& y() const { return y_; }

 private:
  struct Session;
  EventOde ode_;
  double time_;
  std::vector<double> y_;
  std::unique_ptr<Session> session_;
};

}  // namespace openclose::analytical
