#include "openclose/geometry/polygon_with_holes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"

namespace openclose {
namespace {

bool rings_meet(const Polygon& a, const Polygon& b) {
  if (!Box::around(a).inflated(tolerance::shortest_edge_m).overlaps(Box::around(b))) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (segments_meet(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<const Polygon*> rings_of(const PolygonWithHoles& domain) {
  std::vector<const Polygon*> rings{&domain.outer};
  for (const Polygon& hole : domain.holes) rings.push_back(&hole);
  return rings;
}

Polygon moved(Polygon polygon, const Vec2& by) {
  for (Vec2& vertex : polygon) vertex += by;
  return polygon;
}

PolygonWithHoles moved(PolygonWithHoles domain, const Vec2& by) {
  domain.outer = moved(std::move(domain.outer), by);
  for (Polygon& hole : domain.holes) hole = moved(std::move(hole), by);
  return domain;
}

bool PolygonWithHoles::contains(const Vec2& point) const {
  const auto in_hole = [&](const Polygon& hole) { return openclose::contains(hole, point); };
  return openclose::contains(outer, point) && std::none_of(holes.begin(), holes.end(), in_hole);
}

double PolygonWithHoles::area() const {
  double area = signed_area(outer);
  for (const Polygon& hole : holes) area -= signed_area(hole);
  return area;
}

std::optional<RingFault> first_ring_fault(const PolygonWithHoles& domain) {
  const std::vector<const Polygon*> rings = rings_of(domain);
  for (int r = 1; r < static_cast<int>(rings.size()); ++r) {
    for (int other = 0; other < r; ++other) {
      if (rings_meet(*rings[r], *rings[other])) return RingFault{RingFault::Kind::meets, r, other};
      if (other == 0 && !contains(*rings[0], rings[r]->front())) return RingFault{RingFault::Kind::outside, r, 0};
      if (other > 0 && (contains(*rings[other], rings[r]->front()) || contains(*rings[r], rings[other]->front()))) {
        return RingFault{RingFault::Kind::nested, r, other};
      }
    }
  }
  return std::nullopt;
}

Vec2 local_origin(const Polygon& outer) {
  const Box box = Box::around(outer);
  const double grid = std::exp2(std::ceil(std::log2((box.high - box.low).maxCoeff())));
  const auto near = [&](double low, double high) {
    return std::min(std::abs(low), std::abs(high)) < 2.0 * grid || low * high < 0.0 ? 0.0 : grid * std::round(0.5 * (low + high) / grid);
  };
  return {near(box.low.x(), box.high.x()), near(box.low.y(), box.high.y())};
}

}  // namespace openclose
