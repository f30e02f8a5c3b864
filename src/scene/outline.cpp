#include "openclose/scene/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

/// Whether all vertices lie on a line, to within the thinnest block.
bool is_flat(const Polygon& polygon) {
  const auto farther = [&](const Vec2& a, const Vec2& b) { return (a - polygon[0]).norm() < (b - polygon[0]).norm(); };
  const Vec2 end = *std::max_element(polygon.begin(), polygon.end(), farther);
  const auto on_line = [&](const Vec2& vertex) { return distance_to_segment(vertex, polygon[0], end) < tolerance::thinnest_block_m; };
  return std::all_of(polygon.begin(), polygon.end(), on_line);
}

[[noreturn]] void fail_sliver(const Value& value, double area, double longest, const std::string& noun) {
  value.fail(fmt::format("the polygon has an area of {:.3g} m2 on a longest edge of {:.3g} m", area, longest),
             fmt::format("a {} at least {} m wide (2 area / longest edge)", noun, tolerance::thinnest_block_m));
}

std::string edge_name(const std::vector<int>& vertices, int edge) {
  return fmt::format("[{}]-[{}]", vertices[edge], vertices[(edge + 1) % static_cast<int>(vertices.size())]);
}

}  // namespace

Polygon outline(const Value& value, const Polygon& written, const std::string& noun) {
  if (written.size() < 3) value.fail(fmt::format("the polygon has {} vertices", written.size()), "at least 3");
  if (is_flat(written)) fail_sliver(value, std::abs(signed_area(written)), longest_edge(written), noun);

  const std::vector<int> kept = corners(written);
  Polygon polygon;
  for (const int i : kept) polygon.push_back(written[i]);

  if (const auto meeting = first_self_intersection(polygon)) {
    const std::string pair = edge_name(kept, meeting->first) + " and " + edge_name(kept, meeting->second);
    value.fail("the polygon intersects or touches itself: edges " + pair, "a simple polygon; vertices are numbered from 0");
  }
  const double area = signed_area(polygon);
  const double longest = longest_edge(polygon);
  if (2.0 * std::abs(area) / longest < tolerance::thinnest_block_m) fail_sliver(value, std::abs(area), longest, noun);
  return area > 0.0 ? polygon : reversed(polygon);
}

void require_inside(const Value& value, const Vec2& point, const Polygon& polygon, const std::string& block_name) {
  const double distance = distance_to_boundary(polygon, point);
  if (contains(polygon, point) || distance <= tolerance::farthest_point_outside_block_m) return;
  value.fail(fmt::format("({}, {}) lies {:.3g} m outside the block {}", point.x(), point.y(), distance, in_quotes(block_name)),
             fmt::format("a point of the block, to within {} m", tolerance::farthest_point_outside_block_m));
}

}  // namespace openclose
