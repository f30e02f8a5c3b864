#include "openclose/geometry/cutting_sources.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "openclose/geometry/box.h"
#include "openclose/geometry/labelled_outline.h"

namespace openclose {
namespace {

bool before(const Vec2& a, const Vec2& b) {
  return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
}

/// With their numbers, in an order that depends neither on that of the holes nor on which vertex of a ring is written first.
std::vector<std::pair<int, Polygon>> rings_in_order(const PolygonWithHoles& domain) {
  std::vector<std::pair<int, Polygon>> rings{{0, from_lowest(domain.outer)}};
  for (const Polygon& hole : domain.holes) rings.emplace_back(static_cast<int>(rings.size()), from_lowest(hole));
  std::sort(rings.begin() + 1, rings.end(), [](const auto& a, const auto& b) { return before(a.second.front(), b.second.front()); });
  return rings;
}

}  // namespace

void make_canonical(std::vector<JointTrace>& traces) {
  for (JointTrace& trace : traces) {
    if (!before(trace.segment.to, trace.segment.from)) continue;
    std::swap(trace.segment.from, trace.segment.to);
    std::swap(trace.goes_on_from, trace.goes_on_to);
  }
  const auto key = [](const JointTrace& trace) {
    const auto& [from, to] = trace.segment;
    return std::tuple(from.x(), from.y(), to.x(), to.y(), trace.joint);
  };
  std::sort(traces.begin(), traces.end(), [&](const JointTrace& a, const JointTrace& b) { return key(a) < key(b); });
}

std::vector<SourceSegment> sources_of(const PolygonWithHoles& domain, const std::vector<JointTrace>& traces, double reach) {
  std::vector<SourceSegment> sources;
  for (const auto& [number, ring] : rings_in_order(domain)) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2& next = ring[i + 1 < ring.size() ? i + 1 : 0];
      // The domain is on the left of the outer boundary and on the right of a hole's.
      sources.push_back({number == 0 ? Segment{ring[i], next} : Segment{next, ring[i]}, source_of_ring(number), true});
    }
  }
  for (const JointTrace& trace : traces) sources.push_back({trace.segment, trace.joint, false});
  // A stub at each end makes it reach what it misses; the trace itself stays as it was given, to the last bit.
  const Box box = Box::around(domain.outer).inflated(reach);
  for (const JointTrace& trace : traces) {
    const auto& [from, to] = trace.segment;
    const Vec2 more = reach * (to - from).normalized();
    if (reach > 0.0 && !trace.goes_on_from && box.contains(from)) sources.push_back({{from - more, from}, trace.joint, false});
    if (reach > 0.0 && !trace.goes_on_to && box.contains(to)) sources.push_back({{to, to + more}, trace.joint, false});
  }
  return sources;
}

}  // namespace openclose
