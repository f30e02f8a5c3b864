// Where the energy went in a solved step, in joules per metre of thickness, for the EnergyLedger of model/energies.h. Each entry comes from its own
// formula, per contact and step; none is the difference of the others, so that the imbalance can fail. What happens between steps is booked in pairs
// by simulation_state.cpp, what dem does by explicit_blocks and explicit_links.
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
#include "openclose/model/energies.h"

namespace openclose {

/// Adds an accepted step. `system` still holds the state at its start; `elastic` is Enforcement::has_elastic_contacts().
void add_step(EnergyLedger& ledger, const StepProblem& problem, const StepSolution& solution, const TimeScheme& scheme, bool elastic);

/// Energy stored in the springs of a contact carrying these forces [J].
double stored_energy(double normal_stiffness, double shear_stiffness, double normal, double shear);

}  // namespace openclose
