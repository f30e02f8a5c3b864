// What can only be seen when the blocks are looked at together.
#pragma once

#include <string>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// Throws InputError if the scene gives no joint for two materials whose blocks can touch.
void require_joints(const Scene& scene);

/// Throws InputError for a missing joint (require_joints) and for two blocks that overlap deeper than tolerance::deepest_initial_overlap_m (see
/// overlap_depth).
/// \return one line for everything that is allowed but hardly meant: keys under former names, nothing that holds the blocks against gravity, and what
/// the
///         cutting of a domain warns of
std::vector<std::string> check_scene(const Scene& scene);

}  // namespace openclose
