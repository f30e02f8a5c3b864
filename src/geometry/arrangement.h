// Segments cut at each other: the points where they meet, and the pieces between these points.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "openclose/geometry/segment.h"

namespace openclose {

/// A segment to be cut, with a number of the caller's. Those marked `rigid` keep their place: what ends or crosses within
/// tolerance::shortest_edge_m of one is put onto it.
struct SourceSegment {
  Segment segment;
  int source = 0;
  bool rigid = false;
};

/// A part of a source between two neighbouring nodes, in the direction of the source.
struct Piece {
  int from = 0;
  int to = 0;
  int source = 0;
  bool rigid = false;
};

struct Arrangement {
  std::vector<Vec2> nodes;    ///< [m]
  std::vector<Piece> pieces;  ///< sources that run along each other give the same piece, once for each source
};

/// What an arrangement may grow to.
struct ArrangementLimits {
  std::size_t pairs = 0;                     ///< of segments to be compared
  std::size_t crossings = 0;                 ///< that count
  std::function<bool(const Vec2&)> counted;  ///< whether a crossing at this place does
};

/// Cuts all segments at each other. The pieces of the result meet in common nodes only.
///
/// Every node is computed once: from the ends of the segments, or from two whole segments that cross. Nodes closer together than twice
/// tolerance::shortest_edge_m become one, the one met first; a piece that passes a node within once that length is led through it. So lines that
/// should meet in one point do, and lines that should coincide do. A piece moved that way may meet new ones, so the cutting is repeated until nothing
/// changes (once, unless nodes were that close).
///
/// The segments are taken in the order given, so that the same list gives the same bits; a caller who wants them independent of the order sorts.
/// Segments shorter than tolerance::shortest_edge_m vanish. None: it would grow beyond the limits; found out without building it.
std::optional<Arrangement> arrange(const std::vector<SourceSegment>& segments, const ArrangementLimits& limits);

}  // namespace openclose
