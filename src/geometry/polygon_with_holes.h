// Domains: polygons with holes, and what can be wrong with them.
#pragma once

#include <optional>
#include <vector>

#include "openclose/geometry/polygon.h"

namespace openclose {

/// A simple polygon less simple polygons inside it, all counter-clockwise, none touching another.
struct PolygonWithHoles {
  Polygon outer;
  std::vector<Polygon> holes;

  bool contains(const Vec2& point) const;
  double area() const;  ///< [m2]
};

/// What is wrong with a domain: the first of its rings (0: the outer one, k: hole k - 1) that meets the one before it in the pair, lies outside
/// the outer one, or inside another hole.
struct RingFault {
  enum class Kind { meets, outside, nested } kind = Kind::meets;
  int ring = 0;
  int other = 0;
};
std::optional<RingFault> first_ring_fault(const PolygonWithHoles& domain);

/// The outer one first.
std::vector<const Polygon*> rings_of(const PolygonWithHoles& domain);
Polygon moved(Polygon polygon, const Vec2& by);
PolygonWithHoles moved(PolygonWithHoles domain, const Vec2& by);

/// A place near a domain that lies far from the origin, else the origin itself. What is taken from the coordinates there has so few digits that no
/// vertex of the domain loses any, there and back: multiples of a power of two above the domain's size, and none of a coordinate that is not at least
/// as far away. The cutting then has all digits for crossings and angles, and only the corners of the blocks are rounded to what is left of them.
Vec2 local_origin(const Polygon& outer);

}  // namespace openclose
