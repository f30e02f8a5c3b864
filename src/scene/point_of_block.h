// To which block a point belongs. Blocks cut out of a domain have names that nobody wrote, so the point tells the block where none is named.
#pragma once

#include "openclose/scene/scene.h"
#include "openclose/scene/table.h"

namespace openclose {

/// The block with this number, or the only one that contains the point if the number is unnamed_block.
/// \param value  where the point stands; throws InputError if it is outside the block by more than tolerance::farthest_point_outside_block_m, and if
///               no block or several ones contain it
int block_of_point(const Value& value, int named, const Vec2& point, const std::vector<BlockInput>& blocks);

}  // namespace openclose
