#include "openclose/geometry/touch.h"

#include <algorithm>
#include <vector>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/fractions.h"

namespace openclose {

double common_length(const Segment& segment, const Polygon& polygon) {
  const Box reach = segment.box().inflated(tolerance::touching_m);
  if (!reach.overlaps(Box::around(polygon))) return 0.0;
  // Between two of these places the segment is either along the polygon or not: the feet of the vertices and the crossings with the edges.
  std::vector<double> places{0.0, 1.0};
  const auto add = [&](double place) {
    if (place > 0.0 && place < 1.0) places.push_back(place);
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Segment edge = edge_of(polygon, i);
    if (!reach.overlaps(edge.box())) continue;
    add(foot(segment, edge.from));
    add(foot(segment, edge.to));
    if (const std::optional<double> place = crossing(segment, edge)) add(*place);
  }
  std::sort(places.begin(), places.end());
  double length = 0.0;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Vec2 middle = segment.at(0.5 * (places[i] + places[i + 1]));
    const bool common = contains(polygon, middle) || distance_to_boundary(polygon, middle) <= tolerance::touching_m;
    if (common) length += (places[i + 1] - places[i]) * segment.length();
  }
  return length;
}

}  // namespace openclose
