// Joints that a motion holds and that would crack where they are bent, see edge_stress.h: in a motion each of their points parts by itself.
#pragma once

#include <string>

#include "openclose/analysis/simulation.h"

namespace openclose {

/// How many contacts between blocks where they are now, and how much too strong they are; empty if there are none.
std::string bent_joints_in_words(const Simulation& simulation);

}  // namespace openclose
