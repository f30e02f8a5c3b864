// How displacement and velocity follow from the forces over a step. Every scheme solves
//
//   inertia M (dt v - d) + theta F(d) + (1 - theta) F(0) = 0
//
// for the displacement d of the step, M being the mass, v the velocity at its start.
#pragma once

#include <memory>

#include "openclose/model/block_system.h"

namespace openclose {

/// A piece of time, counted from the start of a step [s].
struct TimeSpan {
  double from, to;
};

template <int N>
class TimeScheme {
 public:
  using Unknowns = typename Motion<N>::Unknowns;
  virtual ~TimeScheme() = default;

  virtual double inertia(double dt) const = 0;  ///< [1/s2]
  virtual double end_weight() const = 0;        ///< theta [-]
  /// Velocity after a step that was really taken with dt and moved by d.
  virtual Unknowns next_velocity(double dt, const Unknowns& d, const Unknowns& v) const = 0;
  /// The time between the velocities at the start and after a step of dt: over it the forces of the step act.
  virtual TimeSpan span_of_velocities(double dt) const { return {0.0, dt}; }
  /// Displacement whose product with the forces of the step is exactly the change of kinetic energy.
  virtual Unknowns work_displacement(double dt, const Unknowns& d, const Unknowns& v) const = 0;
  /// Velocity at the end of the step, for output.
  virtual Unknowns velocity_at_end(double dt, const Unknowns& d, const Unknowns& v) const = 0;
  virtual void accept(double) {}  ///< the step with this dt counts
  virtual void exchange(Archive&) {}  ///< what it remembers of earlier steps
};

/// u1 = u0 + dt (v0 + v1)/2, M (v1 - v0) = dt [theta F1 + (1 - theta) F0]. theta = 1: Newmark (1/2, 1), Shi's, order 1; theta = 1/2: trapezoid,
/// Newmark (1/4, 1/2), order 2. Exact for constant forces.
template <int N>
std::unique_ptr<TimeScheme<N>> make_theta_scheme(double theta);

/// Velocities at mid-steps: v = d/dt, M (v_new - v_old) = h F with h = (dt + previous dt)/2, half a step at the start. Exact for constant forces, of
/// order 1 for forces that change with the position, which are taken at the end of the step; a gap that is held has no velocity, where 2 d/dt - v
/// would ring for ever. Used by `hard`.
template <int N>
std::unique_ptr<TimeScheme<N>> make_midstep_scheme();

/// Central difference: the same velocities at mid-steps, with the forces at the start of the step. Explicit, of order 2 (order 1 in what dashpots do,
/// whose velocity is half a step old). Used by `dem`.
template <int N>
std::unique_ptr<TimeScheme<N>> make_central_difference_scheme();

}  // namespace openclose
