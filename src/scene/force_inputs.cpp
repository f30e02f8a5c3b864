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

/// Of the outline of a block, from one corner to the next.
struct Edge {
  int block;
  Vec2 first, second;

  double distance_to(const Vec2& point) const { return distance_to_segment(point, first, second); }
};

/// f(edge) for all edges of all blocks, or of the one that is named.
template <class F>
void for_each_edge(const std::vector<BlockInput>& blocks, int named, F f) {
  for (int b = 0; b < static_cast<int>(blocks.size()); ++b) {
    if (named != unnamed_block && b != named) continue;
    const Polygon& outline = blocks[b].vertices;
    for (std::size_t i = 0; i < outline.size(); ++i) f(Edge{b, outline[i], outline[(i + 1) % outline.size()]});
  }
}

std::string written(const Vec2& point) {
  return fmt::format("({:.9g}, {:.9g})", point.x(), point.y());
}

/// "(1, 2) is on the edge from (0, 2) to (3, 2) of "block"". Of the edges that meet in a corner it is the one that comes nearest to the other end of
/// what is to lie there; for a point on no edge it is the nearest one.
std::string place_in_words(const Vec2& point, const Vec2& other_end, const std::vector<BlockInput>& blocks, int named) {
  const auto rank = [&](const Edge& edge) {
    return std::pair(std::max(edge.distance_to(point), tolerance::farthest_point_outside_block_m), edge.distance_to(other_end));
  };
  std::optional<Edge> nearest;
  for_each_edge(blocks, named, [&](const Edge& edge) {
    if (!nearest || rank(edge) < rank(*nearest)) nearest = edge;
  });
  const double distance = nearest->distance_to(point);
  const std::string where = distance <= tolerance::farthest_point_outside_block_m ? "on" : fmt::format("{:.3g} m from", distance);
  return fmt::format("{} is {} the edge from {} to {} of {}", written(point), where, written(nearest->first), written(nearest->second),
                     in_quotes(blocks[nearest->block].name));
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
  const std::string ends = written(from) + " and " + written(to);
  if ((to - from).norm() <= tolerance::farthest_point_outside_block_m) value.fail(ends + " are one point", accepted);
  std::vector<Edge> found;  // the first one of each block
  for_each_edge(blocks, block, [&](const Edge& edge) {
    const bool has_both = std::max(edge.distance_to(from), edge.distance_to(to)) <= tolerance::farthest_point_outside_block_m;
    if (has_both && (found.empty() || found.back().block != edge.block)) found.push_back(edge);
  });
  if (found.empty()) {
    const std::string whose = block == unnamed_block ? "any block" : in_quotes(blocks[block].name);
    value.fail(fmt::format("{} are not on one edge of {}: {}, {}", ends, whose, place_in_words(from, to, blocks, block),
                           place_in_words(to, from, blocks, block)),
               accepted + "; a [[surcharge]] for each edge");
  }
  if (found.size() > 1) {
    value.fail(fmt::format("{} are on edges of {} and {}", ends, in_quotes(blocks[found[0].block].name), in_quotes(blocks[found[1].block].name)),
               accepted);
  }
  block = found.front().block;
  if ((to - from).dot(found.front().second - found.front().first) < 0.0) std::swap(from, to);
}

}  // namespace openclose
