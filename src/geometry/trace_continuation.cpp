#include "openclose/geometry/trace_continuation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// How far from a point, along a unit vector, a segment is met: where the two cross, or where an end of the segment lies beside the way.
std::optional<double> distance_ahead(const Vec2& point, const Vec2& along, const Segment& segment, double reach) {
  std::optional<double> nearest;
  const auto add = [&](double distance) {
    if (distance > 0.0 && (!nearest || distance < *nearest)) nearest = distance;
  };
  for (const Vec2& end : {segment.from, segment.to}) {
    if (std::abs(cross(along, end - point)) <= reach) add(along.dot(end - point));
  }
  const Vec2 across = segment.to - segment.from;
  const double sine = cross(along, across);
  if (sine == 0.0) return nearest;
  const double part = cross(segment.from - point, along) / sine;
  if (part >= 0.0 && part <= 1.0) add(cross(segment.from - point, across) / sine);
  return nearest;
}

class Continuation {
 public:
  Continuation(const std::vector<JointTrace>& traces, const std::vector<const Polygon*>& rings, double reach)
      : rings_(rings), reach_(std::max(reach, tolerance::shortest_edge_m)) {
    for (const JointTrace& trace : traces) met_.push_back(trace.segment);
    for (const Polygon* ring : rings) {
      for (std::size_t i = 0; i < ring->size(); ++i) met_.push_back({(*ring)[i], (*ring)[(i + 1) % ring->size()]});
    }
  }

  /// From the end of a trace to what it meets next; nothing where it ends on something already, or outside.
  std::optional<Segment> from_end(std::size_t trace, const Vec2& other_end, const Vec2& end) const {
    if (!is_inside(end)) return std::nullopt;
    const Vec2 along = (end - other_end).normalized();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < met_.size(); ++i) {
      if (i == trace) continue;
      if (distance_to_segment(end, met_[i].from, met_[i].to) <= reach_) return std::nullopt;
      if (const auto distance = distance_ahead(end, along, met_[i], reach_)) nearest = std::min(nearest, *distance);
    }
    return Segment{end, end + nearest * along};
  }

 private:
  /// Inside the outer ring and outside of the others.
  bool is_inside(const Vec2& point) const {
    return std::ranges::all_of(rings_, [&](const Polygon* ring) { return contains(*ring, point) == (ring == rings_.front()); });
  }

  const std::vector<const Polygon*>& rings_;
  double reach_;
  std::vector<Segment> met_;
};

}  // namespace

bool continue_traces(std::vector<JointTrace>& traces, const std::vector<const Polygon*>& rings, double reach) {
  if (std::ranges::all_of(traces, [](const JointTrace& trace) { return trace.bridge == JointTrace::no_bridge; })) return false;
  const Continuation continuation(traces, rings, reach);
  const std::size_t given = traces.size();
  for (std::size_t t = 0; t < given; ++t) {
    const JointTrace trace = traces[t];
    if (trace.bridge == JointTrace::no_bridge) continue;
    const auto& [from, to] = trace.segment;
    const auto lead_on = [&](const Vec2& other_end, const Vec2& end, bool JointTrace::*goes_on) {
      if (trace.*goes_on) return;
      const std::optional<Segment> more = continuation.from_end(t, other_end, end);
      if (!more) return;
      traces[t].*goes_on = true;
      traces.push_back({*more, trace.bridge, JointTrace::no_bridge, true, false});
    };
    lead_on(to, from, &JointTrace::goes_on_from);
    lead_on(from, to, &JointTrace::goes_on_to);
  }
  return traces.size() > given;
}

}  // namespace openclose
