#include "openclose/geometry/overlap.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/fractions.h"
#include "openclose/geometry/touching_outlines.h"

namespace openclose {
namespace {

/// Polygons with more corners are looked at only where they are near each other.
constexpr std::size_t few_corners = 64;

/// Fractions of the segment, in order, between which its distance to the boundary of the polygon has no reason to vanish. Of many edges those are
/// left out that are farther away than the common box is wide: what is as deep as that is found without them.
std::vector<double> divisions(const Segment& segment, const Polygon& polygon, const Box& common) {
  const Box reach = segment.box().inflated((common.high - common.low).minCoeff());
  std::vector<double> fractions{0.0, 1.0};
  const auto add = [&](double fraction) {
    if (fraction > 0.0 && fraction < 1.0) fractions.push_back(fraction);
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Segment other = edge_of(polygon, i);
    if (!common.overlaps(other.box()) || (polygon.size() > few_corners && !reach.overlaps(other.box()))) continue;
    if (const std::optional<double> fraction = crossing(segment, other)) add(*fraction);
    add(foot(segment, other.from));
    add(foot(segment, other.to));
  }
  std::sort(fractions.begin(), fractions.end());
  return fractions;
}

/// Depth inside `polygon` of the boundary of `other`.
double depth_of_boundary(const Polygon& other, const Polygon& polygon, const Box& common) {
  double depth = 0.0;
  const auto sample = [&](const Vec2& point) {
    if (common.contains(point) && contains(polygon, point)) depth = std::max(depth, distance_to_boundary(polygon, point));
  };
  for (std::size_t i = 0; i < other.size(); ++i) {
    const Segment segment = edge_of(other, i);
    if (!common.overlaps(segment.box())) continue;
    const std::vector<double> fractions = divisions(segment, polygon, common);
    for (std::size_t k = 0; k + 1 < fractions.size(); ++k) {
      sample(segment.at(fractions[k]));
      sample(segment.at(0.5 * (fractions[k] + fractions[k + 1])));
    }
  }
  return depth;
}

/// The unit vector from vertex i into the polygon, along the bisector of its angle.
Vec2 inwards(const Polygon& polygon, std::size_t i) {
  const std::size_t n = polygon.size();
  const Vec2 in = (polygon[i] - polygon[(i + n - 1) % n]).normalized();
  const Vec2 out = (polygon[(i + 1) % n] - polygon[i]).normalized();
  return perpendicular(in + out).normalized();
}

/// Where the segment crosses an edge; none where it does not.
std::optional<double> crossing_of_edge(const Segment& segment, const Segment& side) {
  const std::optional<double> on_side = crossing(side, segment);
  if (!on_side || *on_side < 0.0 || *on_side > 1.0) return std::nullopt;
  const double fraction = *crossing(segment, side);
  return fraction > 0.0 && fraction < 1.0 ? std::optional(fraction) : std::nullopt;
}

/// From vertex i along the bisector of its angle, as far as the common box can reach; of a polygon with many corners until it leaves it.
Segment bisector(const Polygon& polygon, std::size_t i, const Box& common) {
  const std::size_t n = polygon.size();
  const Segment whole{polygon[i], polygon[i] + (common.high - common.low).norm() * inwards(polygon, i)};
  double end = 1.0;
  for (std::size_t k = 0; k < n && n > few_corners; ++k) {
    if (k == i || (k + 1) % n == i) continue;
    if (const std::optional<double> fraction = crossing_of_edge(whole, edge_of(polygon, k))) end = std::min(end, *fraction);
  }
  return {whole.from, whole.at(end)};
}

void add_crossings(const Segment& segment, const Polygon& polygon, std::vector<double>& fractions) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (const std::optional<double> fraction = crossing_of_edge(segment, edge_of(polygon, i))) fractions.push_back(*fraction);
  }
}

/// Depth, below the nearer boundary, of points on the bisectors of the corners of `polygon`.
double depth_of_bisectors(const Polygon& polygon, const Polygon& other, const Box& common) {
  double depth = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (!common.contains(polygon[i])) continue;
    const Segment segment = bisector(polygon, i, common);
    std::vector<double> fractions{0.0, 1.0};
    if (polygon.size() <= few_corners) add_crossings(segment, polygon, fractions);
    add_crossings(segment, other, fractions);
    std::sort(fractions.begin(), fractions.end());
    for (std::size_t k = 0; k + 1 < fractions.size(); ++k) {
      const Vec2 point = segment.at(0.5 * (fractions[k] + fractions[k + 1]));
      if (!common.contains(point) || !contains(polygon, point) || !contains(other, point)) continue;
      depth = std::max(depth, std::min(distance_to_boundary(polygon, point), distance_to_boundary(other, point)));
    }
  }
  return depth;
}

/// Whether the line along an edge of a convex polygon keeps the other one out but for this depth [m].
bool parts(const Polygon& convex, const Polygon& other, double depth) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vec2 along = convex[(i + 1) % convex.size()] - convex[i];
    const double reach = depth * along.norm();
    const auto is_behind = [&](const Vec2& point) { return cross(along, point - convex[i]) > reach; };
    if (std::ranges::none_of(other, is_behind)) return true;
  }
  return false;
}

/// Edges that may come into the box.
std::size_t edges_in(const Polygon& polygon, const Box& box) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) count += edge_of(polygon, i).box().overlaps(box);
  return count;
}

/// Whether no edge of the one comes near the box of the other, and a corner of that lies outside: for blocks in a hollow of one that is not convex.
bool lies_beside(const Polygon& inner, const Polygon& hollow) {
  const Box box = Box::around(inner);
  for (std::size_t i = 0; i < hollow.size(); ++i) {
    if (Box::around(hollow[i], hollow[(i + 1) % hollow.size()]).overlaps(box)) return false;
  }
  return !contains(hollow, inner[0]);
}

}  // namespace

double overlap_depth(const Polygon& a, const Polygon& b) {
  const Box common = Box::around(a).common(Box::around(b));
  if (common.empty()) return 0.0;
  const double depth = std::max({depth_of_boundary(a, b, common), depth_of_boundary(b, a, common),  //
                                 depth_of_bisectors(a, b, common), depth_of_bisectors(b, a, common)});
  return depth < tolerance::shortest_edge_m ? 0.0 : depth;
}

Outline outline_of(const Polygon& polygon) {
  Outline outline{polygon, true};
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 before = polygon[i] - polygon[(i + n - 1) % n], after = polygon[(i + 1) % n] - polygon[i];
    outline.is_convex = outline.is_convex && cross(before, after) >= 0.0;
  }
  return outline;
}

double overlap_depth_beyond(double depth, const Outline& a, const Outline& b) {
  if ((a.is_convex && parts(a.corners, b.corners, depth)) || (b.is_convex && parts(b.corners, a.corners, depth))) return 0.0;
  if ((!a.is_convex && lies_beside(b.corners, a.corners)) || (!b.is_convex && lies_beside(a.corners, b.corners))) return 0.0;
  const Box common = Box::around(a.corners).common(Box::around(b.corners));
  if (edges_in(a.corners, common) * edges_in(b.corners, common) > few_corners * few_corners && only_touch(a.corners, b.corners, depth)) return 0.0;
  return overlap_depth(a.corners, b.corners);
}

}  // namespace openclose
