#include "openclose/geometry/overlap.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"

namespace openclose {
namespace {

struct Segment {
  Vec2 start;
  Vec2 end;

  Box box() const { return Box::around(start, end); }
  Vec2 at(double fraction) const { return start + fraction * (end - start); }
};

Segment edge(const Polygon& polygon, std::size_t i) {
  return {polygon[i], polygon[i + 1 < polygon.size() ? i + 1 : 0]};
}

/// Where, as a fraction of the segment, it crosses the line of another one; none for parallel ones.
std::optional<double> crossing(const Segment& segment, const Segment& other) {
  const Vec2 along = segment.end - segment.start;
  const Vec2 across = other.end - other.start;
  const double sine = cross(along, across);
  if (sine == 0.0) return std::nullopt;
  return cross(other.start - segment.start, across) / sine;
}

double foot(const Segment& segment, const Vec2& point) {
  const Vec2 along = segment.end - segment.start;
  return (point - segment.start).dot(along) / along.squaredNorm();
}

/// Fractions of the segment, in order, between which its distance to the boundary of the polygon has no reason to vanish.
std::vector<double> divisions(const Segment& segment, const Polygon& polygon, const Box& common) {
  std::vector<double> fractions{0.0, 1.0};
  const auto add = [&](double fraction) {
    if (fraction > 0.0 && fraction < 1.0) fractions.push_back(fraction);
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Segment other = edge(polygon, i);
    if (!common.overlaps(other.box())) continue;
    if (const std::optional<double> fraction = crossing(segment, other)) add(*fraction);
    add(foot(segment, other.start));
    add(foot(segment, other.end));
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
    const Segment segment = edge(other, i);
    if (!common.overlaps(segment.box())) continue;
    const std::vector<double> fractions = divisions(segment, polygon, common);
    for (std::size_t k = 0; k + 1 < fractions.size(); ++k) {
      sample(segment.at(fractions[k]));
      sample(segment.at(0.5 * (fractions[k] + fractions[k + 1])));
    }
  }
  return depth;
}

/// From vertex i into the polygon along the bisector of its angle, as far as the common box can reach.
Segment bisector(const Polygon& polygon, std::size_t i, const Box& common) {
  const std::size_t n = polygon.size();
  const Vec2 in = (polygon[i] - polygon[(i + n - 1) % n]).normalized();
  const Vec2 out = (polygon[(i + 1) % n] - polygon[i]).normalized();
  return {polygon[i], polygon[i] + (common.high - common.low).norm() * perpendicular(in + out).normalized()};
}

void add_crossings(const Segment& segment, const Polygon& polygon, std::vector<double>& fractions) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Segment side = edge(polygon, i);
    const std::optional<double> on_side = crossing(side, segment);
    if (!on_side || *on_side < 0.0 || *on_side > 1.0) continue;
    const double fraction = *crossing(segment, side);
    if (fraction > 0.0 && fraction < 1.0) fractions.push_back(fraction);
  }
}

/// Depth, below the nearer boundary, of points on the bisectors of the corners of `polygon`.
double depth_of_bisectors(const Polygon& polygon, const Polygon& other, const Box& common) {
  double depth = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (!common.contains(polygon[i])) continue;
    const Segment segment = bisector(polygon, i, common);
    std::vector<double> fractions{0.0, 1.0};
    add_crossings(segment, polygon, fractions);
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

}  // namespace

double overlap_depth(const Polygon& a, const Polygon& b) {
  const Box common = Box::around(a).common(Box::around(b));
  if (common.empty()) return 0.0;
  const double depth = std::max({depth_of_boundary(a, b, common), depth_of_boundary(b, a, common),  //
                                 depth_of_bisectors(a, b, common), depth_of_bisectors(b, a, common)});
  return depth < tolerance::shortest_edge_m ? 0.0 : depth;
}

}  // namespace openclose
