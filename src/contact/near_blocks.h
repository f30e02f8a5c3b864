// Broad phase: which blocks are so near each other that their contacts are worth looking for.
#pragma once

#include <utility>
#include <vector>

#include "openclose/contact/block_shapes.h"
#include "openclose/geometry/box.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// free_blocks: at least one of the two is free; fixed_blocks: both are fixed.
enum class PairsOf { free_blocks, fixed_blocks };

/// Pairs of blocks whose boxes overlap, but for those that are more than `room` [m] apart: in a slope with an inclined joint set four out of five. In
/// ascending order, the lower number first.
/// By sweeping along x within strips of y that are as high as the middling box: in a plane full of blocks each strip holds few at a time, so that the
/// work grows with the number of blocks, and a block that is larger than others is only in more strips.
/// \param boxes  of all blocks, with what is to count as near around them
std::vector<std::pair<int, int>> near_blocks(const BlockSystem& system, const std::vector<Box>& boxes, BlockShapes& shapes, double room,
                                             PairsOf which = PairsOf::free_blocks);

}  // namespace openclose
