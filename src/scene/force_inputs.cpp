#include "openclose/scene/force_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/point_of_block.h"

namespace openclose {
namespace {

/// The edge of a polygon on which both points lie, as the vector from its first to its second vertex.
std::optional<Vec2> edge_with(const Polygon& outline, const Vec2& a, const Vec2& b) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &first = outline[i], &second = outline[(i + 1) % outline.size()];
    const double farther = std::max(distance_to_segment(a, first, second), distance_to_segment(b, first, second));
    if (farther <= tolerance::farthest_point_outside_block_m) return second - first;
  }
  return std::nullopt;
}

std::string between(const Vec2& a, const Vec2& b) {
  return fmt::format("({}, {}) and ({}, {})", a.x(), a.y(), b.x(), b.y());
}

}  // namespace

void Load::complete(const Table& table, const std::vector<BlockInput>& blocks) {
  block = block_of_point(table.at("point_m"), block, point, blocks);
}

void Support::complete(const Table& table, const std::vector<BlockInput>& blocks) {
  if (stiffness.isZero(0.0)) table.at("stiffness_n_per_m").fail("both stiffnesses are 0", "[kx, ky] of which one may be 0");
  block = block_of_point(table.at("point_m"), block, point, blocks);
}

void Surcharge::complete(const Table& table, const std::vector<BlockInput>& blocks) {
  const Value value = table.at("to_m");
  const std::string accepted = "from_m and to_m at different points of one edge of a block, which the key block names where two blocks meet";
  if ((to - from).norm() <= tolerance::farthest_point_outside_block_m) value.fail(between(from, to) + " are one point", accepted);
  std::vector<int> found;
  std::optional<Vec2> edge;
  for (int b = 0; b < static_cast<int>(blocks.size()); ++b) {
    if (block != unnamed_block && b != block) continue;
    if (const std::optional<Vec2> here = edge_with(blocks[b].vertices, from, to)) {
      edge = here;
      found.push_back(b);
    }
  }
  if (found.empty()) {
    const std::string whose = block == unnamed_block ? "any block" : in_quotes(blocks[block].name);
    value.fail(between(from, to) + " are not on one edge of " + whose, accepted);
  }
  if (found.size() > 1) {
    value.fail(fmt::format("{} are on edges of {} and {}", between(from, to), in_quotes(blocks[found[0]].name), in_quotes(blocks[found[1]].name)),
               accepted);
  }
  block = found.front();
  if ((to - from).dot(*edge) < 0.0) std::swap(from, to);
}

}  // namespace openclose
