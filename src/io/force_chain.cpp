#include "openclose/io/force_chain.h"

#include <algorithm>
#include <cmath>

#include "openclose/geometry/polygon.h"

namespace openclose {
namespace {

/// [-] Of the size of the median block.
constexpr double stump_of_force = 0.25;
/// [-] Of the size of the median block, how far a bar may come to lie outside: the thrust of an arch grazes the edge of its crown, and a chain that
/// ended there would seem to carry nothing through the keystone.
constexpr double grazing_depth = 0.1;
constexpr double step_into_block = 1e-3;

/// [m] About as far as the centroid, and hardly out of the block; of a fixed block, which may be large, a stump.
double reach_into(const Picture::Block& block, const Vec2& point, const Vec2& direction, double size) {
  double reach = stump_of_force * size;
  if (!block.fixed) {
    const PolygonProperties shape = polygon_properties(block.outline);
    reach = std::min((shape.centroid - point).norm(), 0.5 * std::sqrt(shape.area));
  }
  // Where the way leaves the block, seen from just within it: the point itself lies on its boundary.
  const Polygon& outline = block.outline;
  const double within = step_into_block * size;
  const Vec2 start = point + within * direction;
  if (!contains(outline, start)) return 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 edge = outline[(i + 1) % outline.size()] - outline[i], to_edge = outline[i] - start;
    const double slope = cross(direction, edge);
    if (slope == 0.0) continue;
    const double along = cross(to_edge, edge) / slope, on_edge = cross(to_edge, direction) / slope;
    const double beyond = grazing_depth * size * edge.norm() / std::abs(slope);
    if (along >= 0.0 && on_edge >= 0.0 && on_edge <= 1.0) reach = std::min(reach, within + along + beyond);
  }
  return reach;
}

}  // namespace

Picture::Force force_through(const PairForce& pair, const std::vector<Picture::Block>& blocks, double size) {
  const Vec2 direction = pair.on_a.normalized();
  double into_a = reach_into(blocks[static_cast<std::size_t>(pair.a)], pair.point, direction, size);
  double into_b = reach_into(blocks[static_cast<std::size_t>(pair.b)], pair.point, -direction, size);
  // A hinge presses corner on corner, and its force leaves both blocks at once: without a stump it would be a dot, and the chain be broken.
  const double stump = 0.5 * stump_of_force * size;
  if (into_a + into_b < stump) into_a = into_b = stump;
  return {pair.point + into_a * direction, pair.point - into_b * direction, pair.on_a.norm()};
}

}  // namespace openclose
