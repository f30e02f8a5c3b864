#include "openclose/geometry/touching_outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/fractions.h"
#include "openclose/geometry/near_pairs.h"

namespace openclose {
namespace {

/// [-] Of the vertices: edges in strips, or comparisons of edges, that are worth their memory. Outlines that need more are left undecided.
constexpr std::size_t most_of_vertices = 64;

std::vector<Segment> edges_of(const Polygon& polygon) {
  std::vector<Segment> edges;
  edges.reserve(polygon.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) edges.push_back(edge_of(polygon, i));
  return edges;
}

/// Tells points inside a polygon by the edges in a strip across it, as contains() does by all.
class Inside {
 public:
  /// \param within  where points are asked for
  Inside(const std::vector<Segment>& edges, const Box& within) {
    const Vec2 size = within.high - within.low;
    // Edges of teeth lie along each other: across them a strip has few.
    Vec2 extents = Vec2::Zero();
    for (const Segment& edge : edges) {
      const Box part = edge.box().common(within);
      if (!part.empty()) extents += part.high - part.low;
    }
    is_turned_ = extents.x() * size.y() < extents.y() * size.x();
    low_ = turned(within.low).y();
    std::size_t strips = edges.size();
    do {
      strips_.assign(strips, {});
      width_ = turned(size).y() / static_cast<double>(strips);
      strips /= 2;
    } while (!fill(edges) && strips > 0);
  }

  bool contains(const Vec2& point) const {
    const Vec2 at = turned(point);
    const double place = (at.y() - low_) / width_;
    if (!(place >= 0.0 && place <= static_cast<double>(strips_.size()))) return false;
    bool inside = false;
    for (const Segment& edge : strips_[strip(at.y())]) {
      const Vec2 a = edge.from - at, b = edge.to - at;
      if ((a.y() > 0.0) == (b.y() > 0.0)) continue;
      if ((cross(a, b) > 0.0) == (b.y() > a.y())) inside = !inside;
    }
    return inside;
  }

 private:
  /// The direction of the strips to the right; the parity of crossings does not depend on the sense of its boundary.
  Vec2 turned(const Vec2& point) const { return is_turned_ ? Vec2(point.y(), point.x()) : point; }

  std::size_t strip(double height) const {
    const auto place = static_cast<std::ptrdiff_t>(std::floor((height - low_) / width_));
    return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(place, 0, static_cast<std::ptrdiff_t>(strips_.size()) - 1));
  }

  /// \return false if there are too many of them
  bool fill(const std::vector<Segment>& edges) {
    std::size_t count = 0;
    for (const Segment& edge : edges) {
      const Segment there{turned(edge.from), turned(edge.to)};
      const auto [low, high] = std::minmax({there.from.y(), there.to.y()});
      if (high < low_ || low > low_ + width_ * static_cast<double>(strips_.size())) continue;
      const std::size_t last = strip(high);
      count += last - strip(low) + 1;
      if (count > most_of_vertices * edges.size() && strips_.size() > 1) return false;
      for (std::size_t s = strip(low); s <= last; ++s) strips_[s].push_back(there);
    }
    return true;
  }

  bool is_turned_ = false;
  double low_ = 0.0, width_ = 0.0;
  std::vector<std::vector<Segment>> strips_;
};

/// An edge near a segment, and between which fractions of that it lies.
struct Near {
  const Segment* edge;
  double from, to;
};

/// The edges of one polygon against the other one.
class Side {
 public:
  Side(const std::vector<Segment>& edges, const Inside& own, const Inside& other, double depth)
      : edges_(edges), own_(own), other_(other), depth_(depth), near_(edges.size()) {}

  void add(std::size_t edge, const Segment& near) {
    const Segment& segment = edges_[edge];
    const auto [low, high] = std::minmax({foot(segment, near.from), foot(segment, near.to)});
    near_[edge].push_back({&near, low, high});
  }

  /// Of the edges that may come into the box.
  bool lies_along_or_outside(const Box& box) {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (edges_[i].box().overlaps(box) && !lies_along_or_outside(edges_[i], near_[i])) return false;
    }
    return true;
  }

  bool is_outside_beside_corners(const Box& box) const {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      if (!box.contains(edges_[i].to)) continue;
      const Segment &before = edges_[i], &after = edges_[i + 1 < edges_.size() ? i + 1 : 0];
      const Vec2 in = (before.to - before.from).normalized(), out = (after.to - after.from).normalized();
      const Vec2 bisector = perpendicular(in + out).normalized();
      // Of half the angle: how fast a point on the bisector gets away from both edges.
      const double sine = std::abs(cross(out, bisector));
      const double at_depth = 2.0 * depth_ / std::max(sine, std::numeric_limits<double>::min());
      for (const double way : {at_depth, 0.25 * std::min(before.length(), after.length())}) {
        const Vec2 point = before.to + way * bisector;
        if (own_.contains(point) && other_.contains(point)) return false;
      }
    }
    return true;
  }

 private:
  bool lies_along_or_outside(const Segment& segment, std::vector<Near>& near) {
    std::ranges::sort(near, {}, &Near::from);
    const double reach = depth_ / segment.length();
    const std::vector<double> places = divisions(segment, near);
    std::vector<Near> beside;
    std::size_t next = 0;
    for (std::size_t k = 0; k + 1 < places.size(); ++k) {
      while (next < near.size() && near[next].from - reach <= places[k + 1]) beside.push_back(near[next++]);
      std::erase_if(beside, [&](const Near& one) { return one.to + reach < places[k]; });
      const Vec2 from = segment.at(places[k]), to = segment.at(places[k + 1]);
      // The distance to an edge is a convex function of the place: no point between is farther than both ends.
      const bool lies_along = std::ranges::any_of(beside, [&](const Near& one) {
        return distance_to_segment(from, one.edge->from, one.edge->to) <= depth_ && distance_to_segment(to, one.edge->from, one.edge->to) <= depth_;
      });
      if (!lies_along && other_.contains(segment.at(0.5 * (places[k] + places[k + 1])))) return false;
    }
    return true;
  }

  /// Where edges begin or end beside the segment, and where it crosses them: what does not lie along one is inside or outside from one place to the
  /// next.
  static std::vector<double> divisions(const Segment& segment, const std::vector<Near>& near) {
    std::vector<double> places{0.0, 1.0};
    const auto add = [&](double place) {
      if (place > 0.0 && place < 1.0) places.push_back(place);
    };
    for (const Near& one : near) {
      add(one.from);
      add(one.to);
      if (const std::optional<double> place = crossing(segment, *one.edge)) add(*place);
    }
    std::ranges::sort(places);
    return places;
  }

  const std::vector<Segment>& edges_;
  const Inside &own_, &other_;
  double depth_;
  std::vector<std::vector<Near>> near_;
};

}  // namespace

bool only_touch(const Polygon& a, const Polygon& b, double depth) {
  const Box common = Box::around(a).common(Box::around(b)).inflated(std::max(depth, tolerance::shortest_edge_m));
  if (common.empty()) return true;
  const std::vector<Segment> edges_a = edges_of(a), edges_b = edges_of(b);
  // What lies beside the common box is none of both.
  std::vector<Segment> near;
  std::vector<std::size_t> numbers;
  for (const std::vector<Segment>* edges : {&edges_a, &edges_b}) {
    for (std::size_t i = 0; i < edges->size(); ++i) {
      if (!(*edges)[i].box().overlaps(common)) continue;
      near.push_back((*edges)[i]);
      numbers.push_back(edges == &edges_a ? i : edges_a.size() + i);
    }
  }
  const auto pairs = near_pairs(near, depth, most_of_vertices * near.size());
  if (!pairs) return false;
  const Inside in_a(edges_a, common), in_b(edges_b, common);
  Side side_a(edges_a, in_a, in_b, depth), side_b(edges_b, in_b, in_a, depth);
  for (const auto& [i, j] : *pairs) {
    const std::size_t first = numbers[static_cast<std::size_t>(i)], second = numbers[static_cast<std::size_t>(j)];
    if (first >= edges_a.size() || second < edges_a.size()) continue;
    side_a.add(first, edges_b[second - edges_a.size()]);
    side_b.add(second - edges_a.size(), edges_a[first]);
  }
  return side_a.lies_along_or_outside(common) && side_b.lies_along_or_outside(common) &&  //
         side_a.is_outside_beside_corners(common) && side_b.is_outside_beside_corners(common);
}

}  // namespace openclose
