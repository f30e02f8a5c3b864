// Where the energy went, in joules per metre of thickness since the start. Each entry comes from its own formula, per contact and step; none is the
// difference of the others, so that the imbalance can fail.
//
// With the work displacement of the time scheme the change of kinetic energy of a step is exactly the work of the forces in its equation of motion.
// For a contact with springs k that carry the elastic parts of N and T, compression p = N_el/k, gap g = g+ - p from where the spring rests (g+ the
// free opening), stretch u = -T_el/k of the shear spring and weights theta at the end, 1 - theta at the start of the step, minus its work is the sum
// of
//   springs   k (p1^2 - p0^2)/2 + k_s (u1^2 - u0^2)/2
//   damping   theta [(N1 - N1_el) (p1 - p0) - (T1 - T1_el) (u1 - u0)] + (1 - theta) [the same with the forces at the start]
//   scheme    (theta - 1/2) [k (p1 - p0)^2 + k_s (u1 - u0)^2] + theta N1 g0+ - (1 - theta) N0 g1+    (for Shi's theta = 1 half k times the square)
//             and what the finite rotation of a step leaves between the path of its forces and the change of gap and slip
//   friction  -(theta T1 + (1 - theta) T0) (slip - change of u)
// The kinetic energy is that of the present velocities, so that motion which comes from elsewhere shows as an imbalance. With mid-step velocities
// (`hard`) all entries stand at the middle of the last step. With forces at the start of the step (`dem`, theta = 0) gravity and scheme do
// so; springs, friction and damping stand at its end, and the kinetic energy goes with them (CentralDifference::kinetic_ahead()). Hard contacts store
// nothing: minus their normal work is the loss of impacts, minus their shear work is friction.
#pragma once

#include "openclose/integrator/enforcement.h"

namespace openclose {

struct EnergyLedger {
  double kinetic = 0.0;          ///< change
  double gravity = 0.0;          ///< change of potential energy
  double base_motion = 0.0;      ///< minus the work of the body forces -m a of a moving base, in the coordinates that move with it
  double contact_springs = 0.0;  ///< change of stored energy
  double support_springs = 0.0;  ///< change of stored energy: work at the fixed points
  double loads = 0.0;            ///< minus the work of point loads
  double friction = 0.0;         ///< dissipated
  double contact_damping = 0.0;  ///< dissipated by the joints' dashpots
  double mass_damping = 0.0;     ///< dissipated by damping of the blocks' motion (`dem`)
  double impact = 0.0;           ///< dissipated by hard contacts that close
  double scheme = 0.0;           ///< dissipated by the time integration
  double redefinition = 0.0;     ///< released where contacts change their length, their gap's linearisation, or end while loaded, see history.h
  double turnover = 0.0;         ///< sum of the absolute changes of kinetic, gravity, base motion and loads: what an imbalance is compared with

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = *this;
    archive(a, b, c, d, e, f, g, h, i, j, k, l, m);
  }

  /// What falls by losses alone: the work of loads and base counts as energy that is given back.
  double mechanical() const { return kinetic + gravity + contact_springs + support_springs + loads + base_motion; }
  EnergyLedger& operator+=(const EnergyLedger& other) {
    kinetic += other.kinetic, gravity += other.gravity, base_motion += other.base_motion, contact_springs += other.contact_springs;
    support_springs += other.support_springs, loads += other.loads, friction += other.friction, contact_damping += other.contact_damping;
    mass_damping += other.mass_damping, impact += other.impact, scheme += other.scheme, redefinition += other.redefinition;
    turnover += other.turnover;
    return *this;
  }

  double imbalance() const {
    return kinetic + gravity + base_motion + contact_springs + support_springs + loads + friction + contact_damping + mass_damping + impact + scheme +
           redefinition;
  }

  /// Whether every entry is a number.
  bool is_finite() const;

  /// [-] Share of the energy moved that the time integration took as if it were damping; below zero where it gave energy. Zero where nothing moved.
  double integrator_loss() const { return turnover > 0.0 ? scheme / turnover : 0.0; }
};

/// Adds an accepted step. `system` still holds the state at its start; `elastic` is Enforcement::has_elastic_contacts().
void add_step(EnergyLedger& ledger, const StepProblem& problem, const StepSolution& solution, const TimeScheme& scheme, bool elastic);

/// Energy stored in the springs of a contact carrying these forces [J].
double stored_energy(double normal_stiffness, double shear_stiffness, double normal, double shear);

}  // namespace openclose
