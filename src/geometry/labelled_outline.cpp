#include "openclose/geometry/labelled_outline.h"

#include <algorithm>
#include <utility>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

int lowest_vertex(const Polygon& polygon) {
  const auto lower = [](const Vec2& a, const Vec2& b) { return std::pair(a.y(), a.x()) < std::pair(b.y(), b.x()); };
  return static_cast<int>(std::min_element(polygon.begin(), polygon.end(), lower) - polygon.begin());
}

}  // namespace

Polygon from_lowest(Polygon polygon) {
  if (!polygon.empty()) std::rotate(polygon.begin(), polygon.begin() + lowest_vertex(polygon), polygon.end());
  return polygon;
}

LabelledOutline from_lowest(LabelledOutline outline) {
  if (outline.polygon.empty()) return outline;
  const int lowest = lowest_vertex(outline.polygon);
  std::rotate(outline.polygon.begin(), outline.polygon.begin() + lowest, outline.polygon.end());
  std::rotate(outline.labels.begin(), outline.labels.begin() + lowest, outline.labels.end());
  return outline;
}

LabelledOutline simplified(const Polygon& polygon, const std::vector<int>& labels) {
  const std::vector<int> kept = corners(polygon);
  const int count = static_cast<int>(polygon.size());
  LabelledOutline outline;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const int end = kept[(k + 1) % kept.size()];
    bool has_begun = false;
    int i = kept[k];
    do {
      const int next = (i + 1) % count;
      const bool has_length = (polygon[next] - polygon[i]).norm() >= tolerance::shortest_edge_m;
      if (has_length && (!has_begun || labels[i] != outline.labels.back())) {
        outline.polygon.push_back(has_begun ? polygon[i] : polygon[kept[k]]);
        outline.labels.push_back(labels[i]);
        has_begun = true;
      }
      i = next;
    } while (i != end);
  }
  return outline;
}

}  // namespace openclose
