// One number for a whole state, to see at a glance whether two runs have ended with the same bits: repeats, restarts, compilers, machines.
#pragma once

#include <string>

#include "openclose/analysis/simulation.h"
#include "openclose/analysis/strength_reduction.h"

namespace openclose {

/// 16 hexadecimal digits: the sum, modulo 2^64, of the FNV-1a sums of every block (name, displacement, rotation, velocity, places of its vertices)
/// and of every contact (names of its blocks, vertex and edge counted within them, status, bond, gap, forces), all numbers with all their bits; -0
/// counts as 0. A sum, so that it does not depend on the order of blocks in the scene or of contacts in a list.
std::string state_hash(const Simulation& simulation);

/// Of the states that a search for the factor of safety hands over, and the trials that led there.
std::string state_hash(const FactorOfSafety& safety, const Scene& scene);

}  // namespace openclose
