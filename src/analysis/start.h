// States a run can start from other than "unloaded".
#pragma once

#include "openclose/analysis/simulation.h"

namespace openclose {

/// Puts every free block where normal forces and moments are in balance on the fixed blocks it rests on, with zero velocity, and with shear forces
/// either zero (relaxed springs) or at the strength of the joint against the driving force (fully mobilised: the block goes on sliding steadily). For
/// phi < alpha there is no static equilibrium to settle into; these are the two starts that stand in for it.
///
/// Throws InputError if a free block rests on free blocks, on edges of different directions, or on nothing.
void balance_normal_forces(Simulation& simulation, bool mobilised_friction);

}  // namespace openclose
