// The size of the blocks of a scene, by which lengths are judged.
#pragma once

#include <optional>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// [m] The root of the median area of the free blocks; none if there are none.
std::optional<double> median_size(const std::vector<BlockInput>& blocks);

}  // namespace openclose
