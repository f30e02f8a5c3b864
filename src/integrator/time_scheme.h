// How displacement and velocity follow from the forces over a step, or over one stage of a step. Every scheme solves
//
//   inertia M (drift - d) + theta F(d) + (1 - theta) F(0) = 0
//
// for the displacement d of the step, M being the mass; drift is where the block would go without forces. Schemes that average over the path of the
// step put the mean force of the path in place of F(d), with theta = 1. integrators.h lists those to choose from.
#pragma once

#include <memory>
#include <vector>

#include "openclose/model/block_system.h"

namespace openclose {

/// A piece of time, counted from the start of a step [s].
struct TimeSpan {
  double from, to;
};

class TimeScheme {
 public:
  using Unknowns = Motion::Unknowns;
  virtual ~TimeScheme() = default;

  virtual double inertia(double dt) const = 0;  ///< [1/s2]
  virtual double end_weight() const = 0;        ///< theta [-]
  virtual bool averages_path() const { return false; }
  /// Displacement of block b without forces; v is the velocity at the start.
  virtual Unknowns drift(int, double dt, const Unknowns& v) const { return dt * v; }
  /// Velocity of block b after a step that was really taken with dt and moved by d.
  virtual Unknowns next_velocity(int b, double dt, const Unknowns& d, const Unknowns& v) const = 0;
  /// The time over which the forces of a step of dt act: from the velocities at its start to those after it.
  virtual TimeSpan span_of_velocities(double dt) const { return {0.0, dt}; }
  /// [m/s2] Mean acceleration of the base over that time in the step that is to follow. Its forces are in F; a scheme that would make other
  /// velocities of them than the base has, because it weighs what was before, puts that right in drift().
  virtual void move_base(const Vec2&) {}
  /// Displacement whose product with the forces of the step is the change of kinetic energy, up to own_work().
  virtual Unknowns work_displacement(int b, double dt, const Unknowns& d, const Unknowns& v) const = 0;
  /// [J] Change of kinetic energy beyond the work of the forces, for masses M: what accelerations remembered from before add.
  virtual double own_work(int, double, const Unknowns&, const Unknowns&, const Unknowns& /*mass*/) const { return 0.0; }
  /// Velocity at the end of the step, for output.
  virtual Unknowns velocity_at_end(int b, double dt, const Unknowns& d, const Unknowns& v) const { return next_velocity(b, dt, d, v); }

  /// Accelerations at the start are wanted, by start(b, a), before the first step.
  virtual bool wants_accelerations() const { return false; }
  virtual void start(int, const Unknowns&) {}

  /// Duration of the next stage of a step that should take dt; the last stage of a step that has begun has no choice.
  virtual double stage(double dt) const { return dt; }
  virtual bool is_within_step() const { return false; }  ///< a stage is to follow
  virtual void abandon_step() {}                         ///< the next stage begins a step

  /// The step with this dt counts: record(b, dt, d, v) for every free block, then accept(dt).
  virtual void record(int, double, const Unknowns&, const Unknowns&) {}
  virtual void accept(double) {}
  /// Block b has been put to rest.
  virtual void forget(int) {}
  virtual void exchange(Archive&) {}  ///< what it remembers of earlier steps
};

/// u1 = u0 + dt (v0 + v1)/2, M (v1 - v0) = dt [theta F1 + (1 - theta) F0]. theta = 1: Newmark (1/2, 1), Shi's, order 1; theta = 1/2: trapezoid,
/// Newmark (1/4, 1/2), order 2. Exact for constant forces.
std::unique_ptr<TimeScheme> make_theta_scheme(double theta);

/// Path-averaged contact forces: u1 = u0 + dt (v0 + v1)/2, M (v1 - v0) = dt F with the mean F of the forces along the straight path of the step, in
/// the mean geometry (law/path_average.h, contact/mean_pose.h). The work of F is then what springs store and friction takes, and the angular
/// momentum stays. Order 2, also over impacts and where contacts begin to slide.
std::unique_ptr<TimeScheme> make_path_average();

/// Velocities at mid-steps: v = d/dt, M (v_new - v_old) = h F with h = (dt + previous dt)/2, half a step at the start. Exact for constant forces, of
/// order 1 for forces that change with the position, which are taken at the end of the step; a gap that is held has no velocity, where 2 d/dt - v
/// would ring for ever. Used by `hard`.
std::unique_ptr<TimeScheme> make_midstep_scheme();

/// Central difference: the same velocities at mid-steps, with the forces at the start of the step. Explicit, of order 2 (order 1 in what dashpots do,
/// whose velocity is half a step old). Used by `dem`.
std::unique_ptr<TimeScheme> make_central_difference_scheme();

/// \param rho_inf  [-] spectral radius at infinite frequency
std::unique_ptr<TimeScheme> make_generalized_alpha(double rho_inf);
std::unique_ptr<TimeScheme> make_tr_bdf2();

}  // namespace openclose
