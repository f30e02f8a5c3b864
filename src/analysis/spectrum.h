// Frequencies of small vibration about the present state, on the springs that the method gives its contacts, and what they make of the matrix of a
// step.
#pragma once

#include "openclose/analysis/simulation.h"

namespace openclose {

/// Of M^-1 K: every contact that touches sticks, supports count, friction and gravity's part do not.
struct Spectrum {
  double lowest = 0.0;     ///< [rad/s] 0 where something moves freely
  double highest = 0.0;    ///< [rad/s] central difference without damping is stable up to 2/highest
  double condition = 0.0;  ///< [-] of M^-1/2 (c M + K) M^-1/2, which is (c + highest^2)/(c + lowest^2), c the inertia of a step of this dt
};

/// Dense eigenvalues: a second for 400 free blocks, growing with the third power. Throws InputError if the contacts have no springs or no block is
/// free.
Spectrum spectrum(Simulation& simulation, double dt);

}  // namespace openclose
