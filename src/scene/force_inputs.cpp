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

/// A part of an edge that lies along a stretch.
struct Piece {
  Edge edge;
  double begin, end;  ///< [m] from the beginning of the stretch
};

/// The parts of edges along the stretch whose outlines run the same way as it, or against it, by where they begin.
std::vector<Piece> pieces_along(const Vec2& from, const Vec2& to, bool same_way, const std::vector<BlockInput>& blocks, int named) {
  const double length = (to - from).norm();
  const Vec2 along = (to - from) / length;
  // Ends are typed with six decimals or so, which the line through a short stretch magnifies at the far ends of a long edge.
  const auto is_near = [&](const Edge& edge, double way) {
    return edge.distance_to(from + way * along) <= tolerance::farthest_point_outside_block_m;
  };
  std::vector<Piece> pieces;
  for_each_edge(blocks, named, [&](const Edge& edge) {
    const double a = along.dot(edge.first - from), b = along.dot(edge.second - from);
    const double begin = std::max(std::min(a, b), 0.0), end = std::min(std::max(a, b), length);
    if ((b > a) != same_way || end - begin <= tolerance::farthest_point_outside_block_m) return;
    if (is_near(edge, begin) && is_near(edge, end)) pieces.push_back({edge, begin, end});
  });
  std::ranges::sort(pieces, {}, &Piece::begin);
  // Blocks may overlap by the rounding of drawings.
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    const double reached = pieces[i - 1].end;
    if (pieces[i].begin < reached && reached - pieces[i].begin <= tolerance::deepest_initial_overlap_m)
      pieces[i].begin = std::min(reached, pieces[i].end);
  }
  return pieces;
}

/// The first part of a stretch on which no piece lies, or two do.
struct Fault {
  double begin, end;  ///< [m]
  const char* edges;  ///< that there are
};

/// Nothing if the pieces cover the stretch once.
std::optional<Fault> fault_of(const std::vector<Piece>& pieces, double length) {
  constexpr double near = tolerance::farthest_point_outside_block_m;
  double reached = 0.0;
  for (const Piece& piece : pieces) {
    if (piece.begin - reached > near) return Fault{reached, piece.begin, "none"};
    if (reached - piece.begin > near) return Fault{piece.begin, reached, "two"};
    reached = piece.end;
  }
  if (length - reached > near) return Fault{reached, length, "none"};
  return std::nullopt;
}

}  // namespace

std::vector<Load> Load::completed(const Table& table, const std::vector<BlockInput>& blocks) const {
  Load load = *this;
  load.block = block_of_point(table.at("point_m"), block, point, blocks);
  return {load};
}

std::vector<Support> Support::completed(const Table& table, const std::vector<BlockInput>& blocks) const {
  if (stiffness.isZero(0.0)) table.at("stiffness_n_per_m").fail("both stiffnesses are 0", "[kx, ky] of which one may be 0");
  Support support = *this;
  support.block = block_of_point(table.at("point_m"), block, point, blocks);
  return {support};
}

std::vector<Surcharge> Surcharge::completed(const Table& table, const std::vector<BlockInput>& blocks) const {
  const Value value = table.at("to_m");
  const std::string accepted =
      "from_m and to_m at different points of edges in one line, with blocks on one side only or with the key block, which names one of them";
  const std::string ends = written(from) + " and " + written(to);
  const double length = (to - from).norm(), near = tolerance::farthest_point_outside_block_m;
  if (length <= near) value.fail(ends + " are one point", accepted);
  const std::vector<Piece> forwards = pieces_along(from, to, true, blocks, block), backwards = pieces_along(from, to, false, blocks, block);
  if (!forwards.empty() && !backwards.empty()) {
    const auto named = [&](const std::vector<Piece>& pieces) { return in_quotes(blocks[pieces.front().edge.block].name); };
    value.fail(fmt::format("{} are on edges of {} and {}", ends, named(forwards), named(backwards)), accepted);
  }
  const std::vector<Piece>& pieces = forwards.empty() ? backwards : forwards;
  const auto at = [&](double way) { return Vec2(from + way / length * (to - from)); };
  if (const auto fault = fault_of(pieces, length)) {
    const std::string whose = block == unnamed_block ? "any block" : in_quotes(blocks[block].name);
    value.fail(
        fmt::format("{} are not on edges of {} in one line, with {} from {} to {}: {}, {}", ends, whose, fault->edges, written(at(fault->begin)),
                    written(at(fault->end)), place_in_words(from, to, blocks, block), place_in_words(to, from, blocks, block)),
        accepted + "; a [[surcharge]] for each straight stretch");
  }
  std::vector<Surcharge> list;
  for (const Piece& piece : pieces) {
    Surcharge part = *this;
    part.block = piece.edge.block;
    // Ends as they are given, not as they are computed.
    if (piece.begin > near) part.from = at(piece.begin);
    if (piece.end < length - near) part.to = at(piece.end);
    if (forwards.empty()) std::swap(part.from, part.to);
    list.push_back(part);
  }
  return list;
}

}  // namespace openclose
