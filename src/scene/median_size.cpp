#include "openclose/scene/median_size.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "openclose/geometry/polygon.h"

namespace openclose {

std::optional<double> size_of_median(std::vector<double> areas) {
  if (areas.empty()) return std::nullopt;
  const auto median = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
  std::nth_element(areas.begin(), median, areas.end());
  return std::sqrt(*median);
}

std::optional<double> median_size(const std::vector<BlockInput>& blocks) {
  std::vector<double> areas;
  for (const BlockInput& block : blocks) {
    if (!block.fixed) areas.push_back(std::abs(signed_area(block.vertices)));
  }
  return size_of_median(std::move(areas));
}

}  // namespace openclose
