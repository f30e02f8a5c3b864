#include "openclose/integrator/depth_limits.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

/// [-] Cosine from which on two outward normals look opposite ways: faces of a plate or of a wall, not the two sides of a corner.
constexpr double opposite = -0.7;

/// [m] From edge (a, b) along its inward normal to the nearest point of edge (c, d) that lies opposite to it; negative if none does.
double distance_behind(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 along = (b - a).normalized(), inward = perpendicular(along);
  const double length = (b - a).norm(), from = along.dot(d - a), to = along.dot(c - a);
  if (along.dot((d - c).normalized()) > opposite || std::min(to, length) <= std::max(from, 0.0)) return -1.0;
  const double depth_from = inward.dot(d - a), slope = (inward.dot(c - a) - depth_from) / (to - from);
  const auto depth = [&](double x) { return depth_from + slope * (x - from); };
  return std::min(depth(std::max(from, 0.0)), depth(std::min(to, length)));
}

}  // namespace

void DepthLimits::begin(const BlockSystem& system) {
  blocks_.clear();
  edges_.clear();
  for (const auto& block : system.blocks()) {
    const int first = block.first_vertex, end = first + block.vertex_count;
    double perimeter = 0.0;
    for (int v = first; v < end; ++v) perimeter += (system.arm(system.next(v)) - system.arm(v)).norm();
    const double width = 4.0 * block.area / perimeter;
    blocks_.push_back(width);
    for (int e = first; e < end; ++e) {
      double thickness = width;
      for (int f = first; f < end; ++f) {
        if (f == e || f == system.next(e) || e == system.next(f)) continue;
        const double behind = distance_behind(system.arm(e), system.arm(system.next(e)), system.arm(f), system.arm(system.next(f)));
        if (behind > 0.0) thickness = std::min(thickness, behind);
      }
      edges_.push_back(thickness);
    }
  }
}

}  // namespace openclose
