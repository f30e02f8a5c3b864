#include "openclose/scene/point_of_block.h"

#include <fmt/format.h>

#include <algorithm>

#include "openclose/geometry/box.h"
#include "openclose/scene/outline.h"

namespace openclose {
namespace {

/// The only block that contains the point.
int block_at(const Value& value, const Vec2& point, const std::vector<BlockInput>& blocks) {
  std::vector<int> found;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (!Box::around(blocks[b].vertices).inflated(tolerance::farthest_point_outside_block_m).contains(point)) continue;
    if (contains(blocks[b].vertices, point) || distance_to_boundary(blocks[b].vertices, point) <= tolerance::farthest_point_outside_block_m) {
      found.push_back(static_cast<int>(b));
    }
  }
  const std::string accepted = "a point inside a block, or on the boundary of one that the key block names";
  const std::string where = fmt::format("({}, {})", point.x(), point.y());
  if (found.empty()) {
    const auto nearest = std::ranges::min_element(blocks, {}, [&](const BlockInput& block) { return distance_to_boundary(block.vertices, point); });
    value.fail(fmt::format("{} lies in no block; the nearest one is {}, {:.3g} m away", where, in_quotes(nearest->name),
                           distance_to_boundary(nearest->vertices, point)),
               accepted);
  }
  if (found.size() > 1) {
    value.fail(fmt::format("{} lies where {} and {} meet", where, in_quotes(blocks[found[0]].name), in_quotes(blocks[found[1]].name)), accepted);
  }
  return found.front();
}

}  // namespace

int block_of_point(const Value& value, int named, const Vec2& point, const std::vector<BlockInput>& blocks) {
  if (named == unnamed_block) return block_at(value, point, blocks);
  require_inside(value, point, blocks[named].vertices, blocks[named].name);
  return named;
}

}  // namespace openclose
