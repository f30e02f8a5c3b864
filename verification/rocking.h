// Housner's block as a scene, for the cases in which it rocks and is turned over.
#pragma once

#include <string>

#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/rocking_block.h"
#include "scenes.h"

namespace openclose::verification {

inline const analytical::RockingBlock rocking;

/// On the level, with friction of 60 degrees.
analytical::BlockOnPlane tall_block();

/// Leaning by an angle [rad] to the left, its lower left corner on the base, or pressed into it by what its weight closes there [m].
Scene leaning(const std::string& method, double angle, double dt, double closure = 0.0);

/// Whether a motion of the base to the right, which is over at a time [s], turns the block over to the left, `hard`: 1 or 0; NaN if a step does not
/// succeed, or the block is still on its way at the end.
double overturned(const Report& report, const BaseMotionInput& base, double over, double dt);

}  // namespace openclose::verification
