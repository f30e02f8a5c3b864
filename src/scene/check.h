// What can only be seen when the blocks are looked at together.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// Throws InputError if the scene gives no joint for two materials whose blocks can touch.
void require_joints(const Scene& scene);

/// Throws InputError for a missing joint (require_joints) and for two blocks that overlap deeper than tolerance::deepest_initial_overlap_m (see
/// overlap_depth).
/// \return one line for everything that is allowed but hardly meant: keys under former names, numbers that no material has (see plausibility.h),
/// nothing
///         that holds the blocks against gravity, and what the cutting of a domain warns of
std::vector<std::string> check_scene(const Scene& scene);

/// Pairs, the lower number first, whose outlines are to be compared: others are not deeper in each other than
/// tolerance::deepest_initial_overlap_m.
std::vector<std::pair<int, int>> blocks_that_may_overlap(const std::vector<BlockInput>& blocks);

/// For messages: how many blocks and vertices there are.
std::string size_of(const Scene& scene);

/// Throws InputError, with the size of the scene and what limits it, if a simulation of it needs more memory than there is.
/// \param available  [bytes]
void require_memory(const Scene& scene, std::size_t available);

}  // namespace openclose
