#include "openclose/integrator/time_scheme.h"

#include <cmath>

namespace openclose {
namespace {

using Unknowns = Motion::Unknowns;

/// [m/s2] Of a base that accelerates so, as a block's unknowns; what the block feels is minus this.
Unknowns acceleration_of_base(const Vec2& a) {
  return Motion::gradient(Vec2::Zero(), a);
}

/// What a scheme remembers of every block; zero until it was set.
class BlockMemory {
 public:
  Unknowns of(int b) const { return b < static_cast<int>(values_.size()) ? values_[b] : Unknowns(Unknowns::Zero()); }
  void set(int b, const Unknowns& value) {
    if (b >= static_cast<int>(values_.size())) values_.resize(b + 1, Unknowns::Zero());
    values_[b] = value;
  }
  void exchange(Archive& archive) { archive(values_); }

 private:
  std::vector<Unknowns> values_;
};

class ThetaScheme : public TimeScheme {
 public:
  ThetaScheme(double theta, bool averages_path) : theta_(theta), averages_path_(averages_path) {}

  double inertia(double dt) const override { return 2.0 / (dt * dt); }
  double end_weight() const override { return theta_; }
  bool averages_path() const override { return averages_path_; }
  Unknowns next_velocity(int, double dt, const Unknowns& d, const Unknowns& v) const override { return (2.0 / dt) * d - v; }
  Unknowns work_displacement(int, double, const Unknowns& d, const Unknowns&) const override { return d; }

 private:
  double theta_;
  bool averages_path_;
};

class MidstepScheme : public TimeScheme {
 public:
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

/// Generalised alpha (Chung and Hulbert 1993): M [(1 - am) a1 + am a0] = (1 - af) F1 + af F0 with Newmark's d = dt v0 + dt^2 [(1/2 - beta) a0 + beta
/// a1], v1 = v0 + dt [(1 - gamma) a0 + gamma a1]; am = (2 rho - 1)/(rho + 1), af = rho/(rho + 1), gamma = 1/2 - am + af, beta = (1 - am + af)^2/4,
/// rho being the spectral radius at infinite frequency. a is the scheme's own acceleration. Dashpots resist the mean velocity of the step: order 1 in
/// what they do unless rho = 1.
///
/// The base's part of a is not what the equation of motion makes of the mean acceleration of the base over the step, which would reach the velocity
/// smeared over this step and the next ones. It is what gives the velocity exactly the change of the base's: (1 - gamma) a0 + gamma a1 = mean.
/// Contacts then carry (1 - am) a1 + am a0 of it, to second order the base's acceleration at (1 - af) dt, where the equation holds; a pulse comes
/// with its whole momentum. Displacements follow from the same a as for all other forces, so that a block that sticks to the base rests.
class GeneralizedAlpha : public TimeScheme {
 public:
  explicit GeneralizedAlpha(double rho)
      : am_((2.0 * rho - 1.0) / (rho + 1.0)), af_(rho / (rho + 1.0)), gamma_(0.5 - am_ + af_), beta_(0.25 * (1.0 - am_ + af_) * (1.0 - am_ + af_)) {}

  double inertia(double dt) const override { return (1.0 - am_) / (beta_ * dt * dt); }
  double end_weight() const override { return 1.0 - af_; }
  void move_base(const Vec2& acceleration) override { base_ = acceleration_of_base(acceleration); }
  Unknowns drift(int b, double dt, const Unknowns& v) const override {
    const Unknowns base_in_equation = (1.0 - am_) * next_base_part() + am_ * base_part_;
    return dt * v + (dt * dt * (0.5 - beta_) - am_ / inertia(dt)) * acceleration_.of(b) - (base_in_equation - base_) / inertia(dt);
  }
  Unknowns next_velocity(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return v + dt * ((1.0 - gamma_) * acceleration_.of(b) + gamma_ * next_acceleration(b, dt, d, v));
  }
  Unknowns work_displacement(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return 0.5 * dt * (v + next_velocity(b, dt, d, v));
  }
  // v1 - v0 - dt times the forces per mass is dt (af - 1/2) (a1 - a0), without the base's part, whose mean is exact.
  double own_work(int b, double dt, const Unknowns& d, const Unknowns& v, const Unknowns& mass) const override {
    const Unknowns change = next_acceleration(b, dt, d, v) - acceleration_.of(b) - (base_part_ - next_base_part());
    return (af_ - 0.5) * mass.cwiseProduct(change).dot(work_displacement(b, dt, d, v));
  }

  bool wants_accelerations() const override { return !started_; }
  void start(int b, const Unknowns& a) override {
    acceleration_.set(b, a);
    base_part_ = base_;
    started_ = true;
  }
  void forget(int b) override { acceleration_.set(b, Unknowns::Zero()); }
  void exchange(Archive& archive) override { archive(started_, acceleration_, base_part_); }
  void record(int b, double dt, const Unknowns& d, const Unknowns& v) override { acceleration_.set(b, next_acceleration(b, dt, d, v)); }
  void accept(double) override { base_part_ = next_base_part(); }

 private:
  Unknowns next_base_part() const { return (base_ - (1.0 - gamma_) * base_part_) / gamma_; }
  Unknowns next_acceleration(int b, double dt, const Unknowns& d, const Unknowns& v) const {
    return (d - dt * v) / (beta_ * dt * dt) - (0.5 - beta_) / beta_ * acceleration_.of(b);
  }

  double am_, af_, gamma_, beta_;
  bool started_ = false;
  BlockMemory acceleration_;
  Unknowns base_ = Unknowns::Zero();       ///< [m/s2] mean over the step
  Unknowns base_part_ = Unknowns::Zero();  ///< [m/s2] minus what the base has in the accelerations of all blocks
};

/// TR-BDF2 (Bank et al. 1985): with g = 2 - sqrt(2) the trapezoid over g dt to (u1, v1), then from there
///
///   u2 = c1 u1 - c2 u0 + c3 dt v2,   v2 = c1 v1 - c2 v0 + c3 dt a2,   c1 = 1/(g (2 - g)),  c2 = (1 - g)^2 c1 = c1 - 1,  c3 = (1 - g)/(2 - g) = g/2.
///
/// Each stage is a step of its own for contacts and history; one that fails leaves a state at time t + g dt from which a new step begins. Dashpots
/// resist the mean velocity of their stage: order 1 in what they do.
///
/// v2 has the impulses of the first stage c1 times and those of the second one c3/(1 - g) times: the same for forces that change smoothly, but not
/// for pulses of the base. The base's part of a2 is therefore what gives the velocity exactly the change of the base's: with the mean accelerations
/// m1 and m2 of the base over the stages, m2 + 2 c2 (m2 - m1), to second order its acceleration at the end of the step. Displacements follow as for
/// all other forces, so that a block that sticks to the base rests.
class TrBdf2 : public TimeScheme {
 public:
  double inertia(double dt) const override {
    if (!second_) return 2.0 / (dt * dt);
    const double reach = c3 * whole(dt);
    return 1.0 / (reach * reach);
  }
  double end_weight() const override { return second_ ? 1.0 : 0.5; }
  void move_base(const Vec2& acceleration) override { base_ = acceleration_of_base(acceleration); }
  Unknowns drift(int b, double dt, const Unknowns& v) const override {
    if (!second_) return dt * v;
    return c2 * first_d_.of(b) + c3 * whole(dt) * (c1 * v - c2 * first_v_.of(b) - c2 * beyond_base(dt));
  }
  Unknowns next_velocity(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return second_ ? Unknowns((d - c2 * first_d_.of(b)) / (c3 * whole(dt))) : Unknowns((2.0 / dt) * d - v);
  }
  Unknowns work_displacement(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return second_ ? Unknowns(0.5 * dt * (v + next_velocity(b, dt, d, v))) : d;
  }
  // v2 - v1 = c2 (v1 - v0) + c3 dt a2, of which (1 - g) dt a2 is what the forces give; of the base they give all of it.
  double own_work(int b, double dt, const Unknowns& d, const Unknowns& v, const Unknowns& mass) const override {
    if (!second_) return 0.0;
    const Unknowns acceleration = inertia(dt) * (d - drift(b, dt, v));
    const Unknowns rest = c2 * ((v - first_v_.of(b)) - beyond_base(dt) - g * whole(dt) * acceleration);
    return 0.5 * mass.cwiseProduct(rest).dot(v + next_velocity(b, dt, d, v));
  }

  double stage(double dt) const override { return second_ ? first_dt_ * (1.0 - g) / g : g * dt; }
  bool is_within_step() const override { return second_; }
  void abandon_step() override { second_ = false; }
  void forget(int b) override {
    first_d_.set(b, Unknowns::Zero());
    first_v_.set(b, Unknowns::Zero());
  }
  void exchange(Archive& archive) override { archive(second_, first_dt_, first_base_, first_d_, first_v_); }
  void record(int b, double, const Unknowns& d, const Unknowns& v) override {
    if (second_) return;
    first_d_.set(b, d);
    first_v_.set(b, v);
  }
  void accept(double dt) override {
    if (!second_) {
      first_dt_ = dt;
      first_base_ = base_;
    }
    second_ = !second_;
  }

 private:
  /// Of which the second stage takes dt.
  static double whole(double dt) { return dt / (1.0 - g); }
  /// [m/s] What the base has given blocks in the first stage beyond what it would with its acceleration in the second one.
  Unknowns beyond_base(double dt) const { return g * whole(dt) * (base_ - first_base_); }

  inline static const double g = 2.0 - std::sqrt(2.0);
  inline static const double c1 = 1.0 / (g * (2.0 - g));
  inline static const double c2 = c1 - 1.0;
  inline static const double c3 = 0.5 * g;

  bool second_ = false;
  double first_dt_ = 0.0;
  Unknowns base_ = Unknowns::Zero(), first_base_ = Unknowns::Zero();  ///< [m/s2] means over this stage and the first one
  BlockMemory first_d_, first_v_;
};

}  // namespace

std::unique_ptr<TimeScheme> make_theta_scheme(double theta) {
  return std::make_unique<ThetaScheme>(theta, false);
}

std::unique_ptr<TimeScheme> make_path_average() {
  return std::make_unique<ThetaScheme>(1.0, true);
}

std::unique_ptr<TimeScheme> make_midstep_scheme() {
  return std::make_unique<MidstepScheme>(1.0);
}

std::unique_ptr<TimeScheme> make_central_difference_scheme() {
  return std::make_unique<MidstepScheme>(0.0);
}

std::unique_ptr<TimeScheme> make_generalized_alpha(double rho_inf) {
  return std::make_unique<GeneralizedAlpha>(rho_inf);
}

std::unique_ptr<TimeScheme> make_tr_bdf2() {
  return std::make_unique<TrBdf2>();
}

}  // namespace openclose
