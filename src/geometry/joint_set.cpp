#include "openclose/geometry/joint_set.h"

#include <algorithm>
#include <cmath>

#include "openclose/geometry/box.h"

namespace openclose {
namespace {

enum Kind : std::uint64_t { turn, spacing_above, spacing_below, trace_ahead, gap_ahead, trace_behind, gap_behind };

/// [-] of the size of the domain by which joints that run through go beyond it, so that their ends are never in doubt.
constexpr double overhang = 0.01;

/// Scattered lengths are summed up from the origin; one that lies this many times the limit away is refused.
constexpr double far = 10.0;

std::uint64_t mixed(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

struct Interval {
  double from = 0.0;
  double to = 0.0;
};

/// The part of the line point + t * along, along a unit vector, that lies in the box.
std::optional<Interval> clipped(const Vec2& point, const Vec2& along, const Box& box) {
  Interval part{-INFINITY, INFINITY};
  for (const int axis : {0, 1}) {
    if (along[axis] == 0.0) {
      if (point[axis] < box.low[axis] || point[axis] > box.high[axis]) return std::nullopt;
      continue;
    }
    const auto [from, to] = std::minmax({(box.low[axis] - point[axis]) / along[axis], (box.high[axis] - point[axis]) / along[axis]});
    part = {std::max(part.from, from), std::min(part.to, to)};
  }
  if (part.from >= part.to) return std::nullopt;
  return part;
}

/// Within the polygon, between the places where the line crosses its edges.
std::vector<Interval> clipped(const Vec2& point, const Vec2& along, const Interval& part, const Polygon& region) {
  std::vector<double> crossings{part.from, part.to};
  for (std::size_t i = 0; i < region.size(); ++i) {
    const Vec2& a = region[i];
    const Vec2 edge = region[i + 1 < region.size() ? i + 1 : 0] - a;
    const double sine = cross(along, edge);
    if (sine == 0.0) continue;
    const double on_edge = cross(a - point, along) / sine;
    const double place = cross(a - point, edge) / sine;
    if (on_edge >= 0.0 && on_edge <= 1.0 && place > part.from && place < part.to) crossings.push_back(place);
  }
  std::sort(crossings.begin(), crossings.end());
  std::vector<Interval> inside;
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    const Interval piece{crossings[i], crossings[i + 1]};
    if (!contains(region, point + 0.5 * (piece.from + piece.to) * along)) continue;
    if (!inside.empty() && inside.back().to == piece.from) {
      inside.back().to = piece.to;
    } else {
      inside.push_back(piece);
    }
  }
  return inside;
}

class Tracer {
 public:
  Tracer(const JointSet& set, const Polygon& domain, int limit) : set_(set), limit_(static_cast<std::size_t>(limit)) {
    box_ = Box::around(domain);
    const double margin = overhang * (box_.high - box_.low).maxCoeff();
    box_ = box_.inflated(margin);
    along_ = direction(set.dip);
    normal_ = perpendicular(along_);
  }

  bool trace() {
    // Turned joints reach farther: every joint that may cross the box has its foot within this distance of those of the corners.
    double low = INFINITY;
    double high = -INFINITY;
    for (const Vec2& corner : {box_.low, box_.high, Vec2(box_.low.x(), box_.high.y()), Vec2(box_.high.x(), box_.low.y())}) {
      const Vec2 arm = corner - set_.origin;
      const double more = std::abs(arm.dot(along_)) * std::tan(set_.dip_scatter);
      low = std::min(low, arm.dot(normal_) - more);
      high = std::max(high, arm.dot(normal_) + more);
    }
    const bool scattered = set_.spacing_scatter > 0.0;
    if (scattered) return trace_scattered(low, high);
    const double first = std::ceil(low / set_.spacing);
    const double last = std::floor(high / set_.spacing);
    if (last - first > static_cast<double>(limit_)) return false;
    for (double k = first; k <= last; ++k) {
      if (!add_joint(static_cast<std::int64_t>(k), k * set_.spacing)) return false;
    }
    return true;
  }

  std::vector<SetTrace> take() { return std::move(traces_); }

 private:
  /// Spacings are summed up from the origin, so that they do not depend on where the domain begins.
  bool trace_scattered(double low, double high) {
    if (std::max(high, -low) / set_.spacing > far * static_cast<double>(limit_)) return false;
    double offset = 0.0;
    for (std::int64_t k = 0; offset <= high; ++k) {
      if (offset >= low && !add_joint(k, offset)) return false;
      offset += set_.spacing * (1.0 + set_.spacing_scatter * uniform(set_.seed, k, spacing_above, 0));
    }
    offset = 0.0;
    for (std::int64_t k = 0; offset >= low; --k) {
      if (k < 0 && offset <= high && !add_joint(k, offset)) return false;
      offset -= set_.spacing * (1.0 + set_.spacing_scatter * uniform(set_.seed, k, spacing_below, 0));
    }
    return true;
  }

  bool add_joint(std::int64_t k, double offset) {
    const Vec2 foot = set_.origin + offset * normal_;
    const Vec2 along = set_.dip_scatter > 0.0 ? direction(set_.dip + set_.dip_scatter * uniform(set_.seed, k, turn, 0)) : along_;
    const std::optional<Interval> part = clipped(foot, along, box_);
    if (!part) return true;
    open_.clear();
    if (set_.trace_length) {
      if (!add_traces(k, foot, along, *part)) return false;
    } else {
      add(foot, along, *part);
    }
    if (set_.has_bridges) add_with_bridges(foot, along, *part);
    return traces_.size() <= limit_;
  }

  bool add_traces(std::int64_t k, const Vec2& foot, const Vec2& along, const Interval& part) {
    const double period = *set_.trace_length + set_.gap;
    const double shift = set_.stagger * static_cast<double>(k);
    const double start = (shift - std::floor(shift)) * period;
    const double length = *set_.trace_length;
    if ((std::max(std::abs(part.from), std::abs(part.to)) + period) / period > far * static_cast<double>(limit_)) return false;
    if (set_.trace_scatter > 0.0) return add_scattered_traces(k, foot, along, part, start);
    for (double i = std::floor((part.from - start) / period); start + i * period < part.to; ++i) {
      add_within(foot, along, {start + i * period, start + i * period + length}, part);
      if (are_too_many()) return false;
    }
    return true;
  }

  bool add_scattered_traces(std::int64_t k, const Vec2& foot, const Vec2& along, const Interval& part, double start) {
    const auto varied = [&](double length, Kind kind, std::int64_t i) {
      return length * (1.0 + set_.trace_scatter * uniform(set_.seed, k, kind, i));
    };
    double place = start;
    for (std::int64_t i = 0; place < part.to; ++i) {
      if (too_far()) return false;
      const double end = place + varied(*set_.trace_length, trace_ahead, i);
      add_within(foot, along, {place, end}, part);
      place = end + varied(set_.gap, gap_ahead, i);
      if (are_too_many()) return false;
    }
    place = start;
    for (std::int64_t i = 0; place > part.from; ++i) {
      if (too_far()) return false;
      const double end = place - varied(set_.gap, gap_behind, i);
      place = end - varied(*set_.trace_length, trace_behind, i);
      add_within(foot, along, {place, end}, part);
      if (are_too_many()) return false;
    }
    return true;
  }

  bool are_too_many() const { return traces_.size() + open_.size() > limit_; }

  /// Counts the lengths summed up between the origin and the domain.
  bool too_far() { return static_cast<double>(++summed_) > far * static_cast<double>(limit_); }

  void add_within(const Vec2& foot, const Vec2& along, const Interval& trace, const Interval& part) {
    const Interval common{std::max(trace.from, part.from), std::min(trace.to, part.to)};
    if (common.from < common.to) add(foot, along, common);
  }

  std::vector<Interval> within_region(const Vec2& foot, const Vec2& along, const Interval& part) const {
    if (set_.region.empty()) return {part};
    return clipped(foot, along, part, set_.region);
  }

  void add(const Vec2& foot, const Vec2& along, const Interval& part) {
    if (set_.has_bridges) {
      open_.push_back(part);
      return;
    }
    for (const Interval& piece : within_region(foot, along, part)) traces_.push_back({{foot + piece.from * along, foot + piece.to * along}});
  }

  /// The open parts of a line with what lies between and beside them.
  void add_with_bridges(const Vec2& foot, const Vec2& along, const Interval& part) {
    std::ranges::sort(open_, {}, &Interval::from);
    for (const Interval& whole : within_region(foot, along, part)) {
      std::vector<std::pair<Interval, bool>> pieces;
      double place = whole.from;
      for (const Interval& open : open_) {
        const Interval common{std::max(open.from, place), std::min(open.to, whole.to)};
        if (common.from >= common.to) continue;
        if (common.from > place) pieces.push_back({{place, common.from}, true});
        pieces.push_back({common, false});
        place = common.to;
      }
      if (pieces.empty()) continue;
      if (place < whole.to) pieces.push_back({{place, whole.to}, true});
      for (const auto& [piece, is_bridge] : pieces) {
        traces_.push_back({{foot + piece.from * along, foot + piece.to * along}, is_bridge, piece.from > whole.from, piece.to < whole.to});
      }
    }
  }

  const JointSet& set_;
  std::size_t limit_;
  std::size_t summed_ = 0;
  Box box_;
  Vec2 along_;
  Vec2 normal_;
  std::vector<SetTrace> traces_;
  std::vector<Interval> open_;  ///< of the present line, where the rest of it is bridges
};

}  // namespace

Vec2 direction(double angle) {
  // Twice the rounding of pi.
  constexpr double zero = 3e-16;
  Vec2 unit(std::cos(angle), std::sin(angle));
  if (std::abs(unit.x()) < zero) return {0.0, unit.y() > 0.0 ? 1.0 : -1.0};
  if (std::abs(unit.y()) < zero) return {unit.x() > 0.0 ? 1.0 : -1.0, 0.0};
  return unit;
}

double uniform(std::uint64_t seed, std::int64_t joint, std::uint64_t kind, std::int64_t draw) {
  std::uint64_t z = mixed(seed);
  for (const std::uint64_t word : {static_cast<std::uint64_t>(joint), kind, static_cast<std::uint64_t>(draw)}) z = mixed(z ^ word);
  return 2.0 * (static_cast<double>(z >> 11) * 0x1.0p-53) - 1.0;
}

std::optional<std::vector<SetTrace>> traces(const JointSet& set, const Polygon& domain, int limit) {
  Tracer tracer(set, domain, limit);
  if (!tracer.trace()) return std::nullopt;
  return tracer.take();
}

}  // namespace openclose
