// How far blocks have moved.
#pragma once

#include <algorithm>
#include <vector>

#include "openclose/model/block_system.h"

namespace openclose {

/// [m] Displacement since a start of the farthest point of any free block.
/// \param start  displacements of all blocks
inline double farthest_displacement(const BlockSystem& system, const std::vector<Motion::Unknowns>& start) {
  double largest = 0.0;
  for (const int b : system.free_blocks())
    largest = std::max(largest, Motion::displacement_bound(system.displacement(b) - start[b], system.block(b).radius));
  return largest;
}

}  // namespace openclose
