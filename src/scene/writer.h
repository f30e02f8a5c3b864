// Writes a scene as a file.
#pragma once

#include <string>

#include "openclose/scene/scene.h"

namespace openclose {

/// TOML text that read_scene turns into the same scene, bit by bit: numbers are the shortest decimals (at most 17 digits) that read back exactly.
/// The one exception are friction angles that did not come from a file: one in ten is off by the last bit (see degrees()). The analysis options are
/// written in full, so that a file keeps its meaning when defaults change; flags and velocities of blocks only if they are not zero. Unit weights
/// come out as densities.
std::string write_scene(const Scene& scene);

/// The same without the title and the keys that may change between a checkpoint and the run that goes on from it.
std::string write_fixed_part(const Scene& scene);

}  // namespace openclose
