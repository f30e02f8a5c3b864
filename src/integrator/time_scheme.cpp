#include "openclose/integrator/time_scheme.h"

namespace openclose {
namespace {

class ThetaScheme : public TimeScheme {
 public:
  using Unknowns = TimeScheme::Unknowns;
  explicit ThetaScheme(double theta) : theta_(theta) {}

  double inertia(double dt) const override { return 2.0 / (dt * dt); }
  double end_weight() const override { return theta_; }
  Unknowns next_velocity(int, double dt, const Unknowns& d, const Unknowns& v) const override { return (2.0 / dt) * d - v; }
  Unknowns work_displacement(int, double, const Unknowns& d, const Unknowns&) const override { return d; }
  Unknowns velocity_at_end(int b, double dt, const Unknowns& d, const Unknowns& v) const override { return next_velocity(b, dt, d, v); }

 private:
  double theta_;
};

class MidstepScheme : public TimeScheme {
 public:
  using Unknowns = TimeScheme::Unknowns;
  explicit MidstepScheme(double end_weight) : end_weight_(end_weight) {}

  double inertia(double dt) const override { return 1.0 / (dt * span(dt)); }
  double end_weight() const override { return end_weight_; }
  Unknowns next_velocity(int, double dt, const Unknowns& d, const Unknowns&) const override { return d / dt; }
  TimeSpan span_of_velocities(double dt) const override { return {-0.5 * previous_dt_, 0.5 * dt}; }
  Unknowns work_displacement(int, double dt, const Unknowns& d, const Unknowns& v) const override { return 0.5 * span(dt) * (d / dt + v); }
  Unknowns velocity_at_end(int, double dt, const Unknowns& d, const Unknowns& v) const override {
    const Unknowns acceleration = (d / dt - v) / span(dt);
    return d / dt + 0.5 * dt * acceleration;
  }
  void accept(double dt) override { previous_dt_ = dt; }
  void exchange(Archive& archive) override { archive(previous_dt_); }

 private:
  double span(double dt) const { return 0.5 * (dt + previous_dt_); }
  double end_weight_;
  double previous_dt_ = 0.0;
};

}  // namespace

std::unique_ptr<TimeScheme> make_theta_scheme(double theta) {
  return std::make_unique<ThetaScheme>(theta);
}

std::unique_ptr<TimeScheme> make_midstep_scheme() {
  return std::make_unique<MidstepScheme>(1.0);
}

std::unique_ptr<TimeScheme> make_central_difference_scheme() {
  return std::make_unique<MidstepScheme>(0.0);
}

}  // namespace openclose
