// The size of the blocks of a scene, by which lengths are judged.
#pragma once

#include <optional>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// [m] The root of the median of some areas [m2]; none if there are none.
std::optional<double> size_of_median(std::vector<double> areas);

/// [m] The same of the areas of the free blocks.
std::optional<double> median_size(const std::vector<BlockInput>& blocks);

}  // namespace openclose
