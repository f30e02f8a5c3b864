// TR-BDF2 (Bank et al. 1985): with g = 2 - sqrt(2) the trapezoid over g dt to (u1, v1), then from there
//
//   u2 = c1 u1 - c2 u0 + c3 dt v2,   v2 = c1 v1 - c2 v0 + c3 dt a2,   c1 = 1/(g (2 - g)),  c2 = (1 - g)^2 c1 = c1 - 1,  c3 = (1 - g)/(2 - g) = g/2.
//
// Each stage is a step of its own for contacts and history; one that fails leaves a state at time t + g dt from which a new step begins. Dashpots
// resist the mean velocity of their stage: order 1 in what they do.
#include <cmath>

#include "openclose/integrator/integrators.h"

namespace openclose {
namespace {

const double g = 2.0 - std::sqrt(2.0);
const double c1 = 1.0 / (g * (2.0 - g));
const double c2 = c1 - 1.0;
const double c3 = 0.5 * g;

class TrBdf2 : public TimeScheme {
 public:
  using Unknowns = TimeScheme::Unknowns;

  double inertia(double dt) const override {
    if (!second_) return 2.0 / (dt * dt);
    const double reach = c3 * whole(dt);
    return 1.0 / (reach * reach);
  }
  double end_weight() const override { return second_ ? 1.0 : 0.5; }
  // The second stage holds at its end.
  TimeSpan span_of_velocities(double dt) const override { return {0.0, second_ ? 2.0 * dt : dt}; }
  Unknowns drift(int b, double dt, const Unknowns& v) const override {
    return second_ ? Unknowns(c2 * first_d_.of(b) + c3 * whole(dt) * (c1 * v - c2 * first_v_.of(b))) : Unknowns(dt * v);
  }
  Unknowns next_velocity(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return second_ ? Unknowns((d - c2 * first_d_.of(b)) / (c3 * whole(dt))) : Unknowns((2.0 / dt) * d - v);
  }
  Unknowns work_displacement(int b, double dt, const Unknowns& d, const Unknowns& v) const override {
    return second_ ? Unknowns(0.5 * dt * (v + next_velocity(b, dt, d, v))) : d;
  }
  // v2 - v1 = c2 (v1 - v0) + c3 dt a2, of which (1 - g) dt a2 is what the forces give.
  double own_work(int b, double dt, const Unknowns& d, const Unknowns& v, const Unknowns& mass) const override {
    if (!second_) return 0.0;
    const Unknowns acceleration = inertia(dt) * (d - drift(b, dt, v));
    const Unknowns rest = c2 * ((v - first_v_.of(b)) - g * whole(dt) * acceleration);
    return 0.5 * mass.cwiseProduct(rest).dot(v + next_velocity(b, dt, d, v));
  }
  Unknowns velocity_at_end(int b, double dt, const Unknowns& d, const Unknowns& v) const override { return next_velocity(b, dt, d, v); }

  double stage(double dt) const override { return second_ ? first_dt_ * (1.0 - g) / g : g * dt; }
  bool is_within_step() const override { return second_; }
  void abandon_step() override { second_ = false; }
  void forget(int b) override {
    first_d_.set(b, Unknowns::Zero());
    first_v_.set(b, Unknowns::Zero());
  }
  void exchange(Archive& archive) override { archive(second_, first_dt_, first_d_, first_v_); }
  void record(int b, double, const Unknowns& d, const Unknowns& v) override {
    if (second_) return;
    first_d_.set(b, d);
    first_v_.set(b, v);
  }
  void accept(double dt) override {
    if (!second_) first_dt_ = dt;
    second_ = !second_;
  }

 private:
  /// Of which the second stage takes dt.
  static double whole(double dt) { return dt / (1.0 - g); }

  bool second_ = false;
  double first_dt_ = 0.0;
  BlockMemory first_d_, first_v_;
};

}  // namespace

std::unique_ptr<TimeScheme> make_tr_bdf2() {
  return std::make_unique<TrBdf2>();
}

}  // namespace openclose
