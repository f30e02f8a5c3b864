// A polygon of which each edge has a number of the caller's.
#pragma once

#include <vector>

#include "openclose/geometry/polygon.h"

namespace openclose {

struct LabelledOutline {
  Polygon polygon;
  std::vector<int> labels;  ///< of the edge from each vertex to the next
};

/// The same polygon, beginning with the lowest vertex (leftmost of several).
Polygon from_lowest(Polygon polygon);

/// Corners only, beginning with the lowest vertex. Edges that become one have the label that most of their length has; of two with as much, the
/// smaller.
/// \param labels  of the edges of the polygon
LabelledOutline simplified(const Polygon& polygon, const std::vector<int>& labels);

}  // namespace openclose
