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

LabelledOutline from_lowest(LabelledOutline outline);

/// Without the vertices that are no corners (see corners), but for those at which a straight edge gets another label.
/// \param labels  of the edges of the polygon
LabelledOutline simplified(const Polygon& polygon, const std::vector<int>& labels);

}  // namespace openclose
