#include "openclose/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/near_pairs.h"

namespace openclose {
namespace {

int size_of(const Polygon& polygon) {
  return static_cast<int>(polygon.size());
}

const Vec2& vertex_after(const Polygon& polygon, int i) {
  return polygon[i + 1 < size_of(polygon) ? i + 1 : 0];
}

bool repeats(const Vec2& a, const Vec2& b) {
  return (a - b).norm() < tolerance::shortest_edge_m;
}

bool is_straight(const Vec2& before, const Vec2& corner, const Vec2& after) {
  const Vec2 in = corner - before;
  const Vec2 out = after - corner;
  return std::abs(std::atan2(cross(in, out), in.dot(out))) < tolerance::straight_corner_rad;
}

std::vector<int> distinct_vertices(const Polygon& polygon) {
  std::vector<int> kept;
  for (int i = 0; i < size_of(polygon); ++i) {
    if (kept.empty() || !repeats(polygon[kept.back()], polygon[i])) kept.push_back(i);
  }
  while (kept.size() > 1 && repeats(polygon[kept.back()], polygon[kept.front()])) kept.pop_back();
  return kept;
}

std::vector<int> without_straight_corners(const Polygon& polygon, const std::vector<int>& indices) {
  std::vector<int> kept;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const int before = kept.empty() ? indices.back() : kept.back();
    const int after = i + 1 < indices.size() ? indices[i + 1] : (kept.empty() ? indices.front() : kept.front());
    if (!is_straight(polygon[before], polygon[indices[i]], polygon[after])) kept.push_back(indices[i]);
  }
  return kept;
}

bool on_opposite_sides(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  return (cross(b - a, p - a) > 0.0) != (cross(b - a, q - a) > 0.0);
}

bool folded(const Vec2& before, const Vec2& corner, const Vec2& after) {
  return std::min(distance_to_segment(before, corner, after), distance_to_segment(after, before, corner)) < tolerance::shortest_edge_m;
}

/// Whether edges i < j have a point in common that is not the corner between them.
bool edges_meet(const Polygon& polygon, int i, int j) {
  const Vec2& a = polygon[i];
  const Vec2& b = vertex_after(polygon, i);
  const Vec2& p = polygon[j];
  const Vec2& q = vertex_after(polygon, j);
  const bool next = j == i + 1;
  const bool closing = i == 0 && j == size_of(polygon) - 1;
  if (!next && !closing) return segments_meet(a, b, p, q);
  return (next && folded(a, b, q)) || (closing && folded(p, a, b));
}

/// Comparisons that a simple outline needs for each of its edges are a few tens; where many more edges lie near each other, they are compared each
/// with each in their order, which takes no memory and soon finds two that meet.
constexpr std::size_t comparisons_of_edge = 100;

}  // namespace

PolygonProperties polygon_properties(const Polygon& polygon) {
  const Vec2& origin = polygon.front();
  double twice_area = 0.0;
  Vec2 moment = Vec2::Zero();
  for (int i = 0; i < size_of(polygon); ++i) {
    const Vec2 a = polygon[i] - origin;
    const Vec2 b = vertex_after(polygon, i) - origin;
    twice_area += cross(a, b);
    moment += cross(a, b) * (a + b);
  }
  const Vec2 centroid = moment / (3.0 * twice_area);

  double twelve_j = 0.0;
  for (int i = 0; i < size_of(polygon); ++i) {
    const Vec2 a = polygon[i] - origin - centroid;
    const Vec2 b = vertex_after(polygon, i) - origin - centroid;
    twelve_j += cross(a, b) * (a.squaredNorm() + a.dot(b) + b.squaredNorm());
  }
  return {twice_area / 2.0, origin + centroid, twelve_j / 12.0};
}

double signed_area(const Polygon& polygon) {
  double twice_area = 0.0;
  for (int i = 1; i + 1 < size_of(polygon); ++i) twice_area += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  return twice_area / 2.0;
}

double longest_edge(const Polygon& polygon) {
  double longest = 0.0;
  for (int i = 0; i < size_of(polygon); ++i) longest = std::max(longest, (vertex_after(polygon, i) - polygon[i]).norm());
  return longest;
}

Polygon reversed(const Polygon& polygon) {
  Polygon turned = polygon;
  std::reverse(turned.begin() + 1, turned.end());
  return turned;
}

std::vector<int> corners(const Polygon& polygon) {
  std::vector<int> kept = distinct_vertices(polygon);
  // Dropping one vertex changes the angles at its neighbours, so the pass is repeated until it drops nothing.
  while (kept.size() >= 3) {
    std::vector<int> fewer = without_straight_corners(polygon, kept);
    if (fewer.size() == kept.size()) break;
    kept = std::move(fewer);
  }
  return kept;
}

Polygon convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  Polygon hull;
  const auto add_chain = [&hull](auto first, auto last) {
    const std::size_t begin = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= begin + 2 && cross(hull.back() - hull[hull.size() - 2], *first - hull.back()) <= 0.0) hull.pop_back();
      hull.push_back(*first);
    }
    if (hull.size() > begin + 1) hull.pop_back();  // the next chain begins with it
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

/// Near misses are left to the distances of the end points, which are the only places where rounding could decide the signs wrongly.
bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  if (!Box::around(a, b).inflated(tolerance::shortest_edge_m).overlaps(Box::around(p, q))) return false;
  if (on_opposite_sides(a, b, p, q) && on_opposite_sides(p, q, a, b)) return true;
  const double gap =
      std::min({distance_to_segment(a, p, q), distance_to_segment(b, p, q), distance_to_segment(p, a, b), distance_to_segment(q, a, b)});
  return gap < tolerance::shortest_edge_m;
}

std::optional<std::pair<int, int>> first_self_intersection(const Polygon& polygon) {
  const int n = size_of(polygon);
  std::vector<Segment> edges;
  edges.reserve(polygon.size());
  for (int i = 0; i < n; ++i) edges.push_back({polygon[i], vertex_after(polygon, i)});
  if (const auto near = near_pairs(edges, tolerance::shortest_edge_m, comparisons_of_edge * polygon.size())) {
    for (const auto& [i, j] : *near) {
      if (edges_meet(polygon, i, j)) return std::pair{i, j};
    }
    return std::nullopt;
  }
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      if (edges_meet(polygon, i, j)) return std::pair{i, j};
    }
  }
  return std::nullopt;
}

bool contains(const Polygon& polygon, const Vec2& point) {
  bool inside = false;
  for (int i = 0; i < size_of(polygon); ++i) {
    const Vec2 a = polygon[i] - point;
    const Vec2 b = vertex_after(polygon, i) - point;
    if ((a.y() > 0.0) == (b.y() > 0.0)) continue;
    // The edge crosses the horizontal through the point; to the right of it if the point is on the left of the edge taken upwards.
    if ((cross(a, b) > 0.0) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

double distance_to_segment(const Vec2& point, const Vec2& a, const Vec2& b) {
  const Vec2 edge = b - a;
  const Vec2 arm = point - a;
  const double length_squared = edge.squaredNorm();
  const double along = length_squared > 0.0 ? std::clamp(arm.dot(edge) / length_squared, 0.0, 1.0) : 0.0;
  return (arm - along * edge).norm();
}

double distance_to_boundary(const Polygon& polygon, const Vec2& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < size_of(polygon); ++i) nearest = std::min(nearest, distance_to_segment(point, polygon[i], vertex_after(polygon, i)));
  return nearest;
}

}  // namespace openclose
