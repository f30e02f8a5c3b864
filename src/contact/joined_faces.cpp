#include "openclose/contact/joined_faces.h"

#include <algorithm>
#include <cmath>

#include "openclose/core/tolerance.h"

namespace openclose {

Joined joined_at(const BlockSystem& system, const GroundOutline& ground, const Contact& contact, double gap) {
  const Vec2 start = system.position(contact.edge_block, contact.edge), end = system.position(contact.edge_block, system.next(contact.edge));
  const Vec2 along = (end - start).normalized(), outward = -perpendicular(along);
  const auto [before, after] = ground.straight_on(contact.edge);
  const double begin = -before, length = (end - start).norm() + after;
  const Vec2 corner = system.position(contact.vertex_block, contact.vertex) - start;
  Joined joined;
  const auto [ahead, back] = ground.own_spans(system, contact.vertex);
  for (const bool is_ahead : {true, false}) {
    const Vec2 side = is_ahead ? ahead : back, far = corner + side;
    // The block lies on the left of its outline: a side that faces the edge runs against it.
    const double forward = side.dot(along) * (is_ahead ? -1.0 : 1.0);
    if (forward <= std::cos(tolerance::parallel_none_rad) * side.norm()) continue;
    const double low = std::max(begin, std::min(corner.dot(along), far.dot(along))),
                 high = std::min(length, std::max(corner.dot(along), far.dot(along)));
    const auto off = [&](double x) { return corner.dot(outward) + (x - corner.dot(along)) / side.dot(along) * side.dot(outward); };
    if (!(high > low) || std::max(std::abs(off(low)), std::abs(off(high))) > gap) continue;
    (side.dot(along) > 0.0 ? joined.ahead : joined.behind) += 0.5 * (high - low);
  }
  joined.length = std::min(joined.ahead + joined.behind, contact.length);
  return joined;
}

}  // namespace openclose
