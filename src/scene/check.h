// What can only be seen when the blocks are looked at together.
#pragma once

#include <string>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// Throws InputError if two blocks overlap deeper than tolerance::deepest_initial_overlap_m (see overlap_depth).
/// \return one line for everything that is allowed but hardly meant: nothing that holds the blocks against gravity; materials that meet without
///         a joint between them
std::vector<std::string> check_scene(const Scene& scene);

}  // namespace openclose
