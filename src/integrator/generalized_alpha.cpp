// Generalised alpha (Chung and Hulbert 1993): M [(1 - am) a1 + am a0] = (1 - af) F1 + af F0 with Newmark's d = dt v0 + dt^2 [(1/2 - beta) a0 + beta
// a1], v1 = v0 + dt [(1 - gamma) a0 + gamma a1]; am = (2 rho - 1)/(rho + 1), af = rho/(rho + 1), gamma = 1/2 - am + af, beta = (1 - am + af)^2/4, rho
// being the spectral radius at infinite frequency. a is the scheme's own acceleration. Dashpots resist the mean velocity of the step: order 1 in what
// they do unless rho = 1.
#include "openclose/integrator/integrators.h"

namespace openclose {
namespace {

class GeneralizedAlpha : public TimeScheme {
 public:
  using Unknowns = TimeScheme::Unknowns;
  explicit GeneralizedAlpha(double rho)
      : am_((2.0 * rho - 1.0) / (rho + 1.0)), af_(rho / (rho + 1.0)), gamma_(0.5 - am_ + af_), beta_(0.25 * (1.0 - am_ + af_) * (1.0 - am_ + af_)) {}

  double inertia(double dt) const override { return (1.0 - am_) / (beta_ * dt * dt); }
  double end_weight() const override { return 1.0 - af_; }
  // The equation of motion holds at (1 - af) dt.
  TimeSpan span_of_velocities(double dt) const override { return {0.0, 2.0 * (1.0 - af_) * dt}; }
  Unknowns drift(int b, double dt, const Unknowns& v) const override {
    return dt * v + (dt * dt * (0.5 - beta_) - am_ / inertia(dt)) * acceleration_.of(b);
  }
  Unknowns next_velocity(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return v + dt * ((1.0 - gamma_) * acceleration_.of(b) + gamma_ * next_acceleration(b, dt, d, v));
  }
  Unknowns work_displacement(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return 0.5 * dt * (v + next_velocity(b, dt, d, v));
  }
  // v1 - v0 - dt times the forces per mass is dt (af - 1/2) (a1 - a0).
  double own_work(int b, double dt, const Unknowns& d, const Unknowns& v, const Unknowns& mass) const override {
    const Unknowns change = next_acceleration(b, dt, d, v) - acceleration_.of(b);
    return (af_ - 0.5) * mass.cwiseProduct(change).dot(work_displacement(b, dt, d, v));
  }
  Unknowns velocity_at_end(int b, double dt, const Unknowns& d, const Unknowns& v) const override { return next_velocity(b, dt, d, v); }

  bool wants_accelerations() const override { return !started_; }
  void start(int b, const Unknowns& a) override {
    acceleration_.set(b, a);
    started_ = true;
  }
  void forget(int b) override { acceleration_.set(b, Unknowns::Zero()); }
  void exchange(Archive& archive) override { archive(started_, acceleration_); }
  void record(int b, double dt, const Unknowns& d, const Unknowns& v) override { acceleration_.set(b, next_acceleration(b, dt, d, v)); }

 private:
  Unknowns next_acceleration(int b, double dt, const Unknowns& d, const Unknowns& v) const {
    return (d - dt * v) / (beta_ * dt * dt) - (0.5 - beta_) / beta_ * acceleration_.of(b);
  }

  double am_, af_, gamma_, beta_;
  bool started_ = false;
  BlockMemory acceleration_;
};

}  // namespace

std::unique_ptr<TimeScheme> make_generalized_alpha(double rho_inf) {
  return std::make_unique<GeneralizedAlpha>(rho_inf);
}

}  // namespace openclose
