#include "convex_pieces.h"

#include <algorithm>
#include <stdexcept>

namespace openclose::peers {
namespace {

/// [m2] Twice the area of a triangle, > 0 if counter-clockwise.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool is_convex(const Polygon& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0.0) return false;
  }
  return true;
}

/// The corner at i is convex and no other vertex lies in its triangle.
bool is_ear(const Polygon& p, std::size_t i) {
  const std::size_t n = p.size();
  const Vec2 &a = p[(i + n - 1) % n], &b = p[i], &c = p[(i + 1) % n];
  if (turn(a, b, c) <= 0.0) return false;
  return std::none_of(p.begin(), p.end(), [&](const Vec2& q) {
    if (q == a || q == b || q == c) return false;
    return turn(a, b, q) >= 0.0 && turn(b, c, q) >= 0.0 && turn(c, a, q) >= 0.0;
  });
}

}  // namespace

std::vector<Polygon> convex_pieces(const Polygon& polygon, std::size_t most) {
  if (polygon.size() <= most && is_convex(polygon)) return {polygon};
  std::vector<Polygon> pieces;
  Polygon rest = polygon;
  while (rest.size() > 3) {
    std::size_t ear = 0;
    while (ear < rest.size() && !is_ear(rest, ear)) ++ear;
    if (ear == rest.size()) throw std::runtime_error("a block has no ear to cut off");
    const std::size_t n = rest.size();
    pieces.push_back({rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  pieces.push_back(rest);
  return pieces;
}

}  // namespace openclose::peers
