#include "openclose/geometry/near_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace openclose {
namespace {

/// Fewer segments than this are compared each with each at once.
constexpr std::size_t few = 8;
/// A cut pays when it leaves less than this part of the comparisons.
constexpr double worthwhile = 0.8;

bool crosses(const Segment& segment, const Box& cell) {
  if (!segment.box().overlaps(cell)) return false;
  const Vec2 half = 0.5 * (cell.high - cell.low);
  const Vec2 normal = perpendicular(segment.to - segment.from);
  return std::abs(normal.dot(0.5 * (cell.low + cell.high) - segment.from)) <= normal.cwiseAbs().dot(half);
}

/// Whether both ends of a segment lie on the same side of the other's line, farther than the distance.
bool beside(const Segment& segment, const Segment& other, double distance) {
  const Vec2 along = other.to - other.from;
  const double from = cross(along, segment.from - other.from);
  const double to = cross(along, segment.to - other.from);
  return (from > 0.0) == (to > 0.0) && std::min(std::abs(from), std::abs(to)) > distance * along.norm();
}

class Search {
 public:
  Search(const std::vector<Segment>& segments, double margin, std::size_t limit) : segments_(segments), margin_(margin), limit_(limit) {
    for (const Segment& segment : segments) boxes_.push_back(segment.box());
  }

  /// Collects the pairs of the segments that cross the cell; false when there are too many.
  bool search(const Box& cell, const std::vector<int>& members) {
    if (members.size() > few) {
      const int longer = cell.high.x() - cell.low.x() >= cell.high.y() - cell.low.y() ? 0 : 1;
      for (const int axis : {longer, 1 - longer}) {
        const std::array<Box, 2> halves = halved(cell, members, axis);
        const std::array<std::vector<int>, 2> parts{within(halves[0], members), within(halves[1], members)};
        if (squared(parts[0]) + squared(parts[1]) > worthwhile * squared(members)) continue;
        return search(halves[0], parts[0]) && search(halves[1], parts[1]);
      }
    }
    return compare(members);
  }

  std::vector<std::pair<int, int>> sorted_pairs() {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    return std::move(pairs_);
  }

 private:
  static double squared(const std::vector<int>& members) { return static_cast<double>(members.size()) * static_cast<double>(members.size()); }

  std::array<Box, 2> halved(const Box& cell, const std::vector<int>& members, int axis) const {
    std::vector<double> middles;
    middles.reserve(members.size());
    for (const int i : members)
      middles.push_back(0.5 * (std::max(boxes_[i].low[axis], cell.low[axis]) + std::min(boxes_[i].high[axis], cell.high[axis])));
    std::nth_element(middles.begin(), middles.begin() + middles.size() / 2, middles.end());
    std::array<Box, 2> halves{cell, cell};
    halves[0].high[axis] = halves[1].low[axis] = middles[middles.size() / 2];
    return halves;
  }

  std::vector<int> within(const Box& cell, const std::vector<int>& members) const {
    const Box wider = cell.inflated(margin_);
    std::vector<int> kept;
    for (const int i : members) {
      if (boxes_[i].overlaps(wider) && crosses(segments_[i], wider)) kept.push_back(i);
    }
    return kept;
  }

  bool compare(const std::vector<int>& members) {
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Box reach = boxes_[members[i]].inflated(margin_);
      for (std::size_t j = i + 1; j < members.size(); ++j) {
        if (!reach.overlaps(boxes_[members[j]])) continue;
        ++compared_;
        if (!apart(members[i], members[j])) pairs_.emplace_back(members[i], members[j]);
      }
      if (compared_ > limit_) return false;
    }
    return true;
  }

  /// Farther than the margin, whatever rounding does to it.
  bool apart(int i, int j) const { return beside(segments_[i], segments_[j], 2.0 * margin_) || beside(segments_[j], segments_[i], 2.0 * margin_); }

  const std::vector<Segment>& segments_;
  double margin_;
  std::size_t limit_;
  std::size_t compared_ = 0;
  std::vector<Box> boxes_;
  std::vector<std::pair<int, int>> pairs_;
};

}  // namespace

std::optional<std::vector<std::pair<int, int>>> near_pairs(const std::vector<Segment>& segments, double margin, std::size_t limit) {
  if (segments.empty()) return std::vector<std::pair<int, int>>{};
  Box all = segments.front().box();
  for (const Segment& segment : segments) all = {all.low.cwiseMin(segment.box().low), all.high.cwiseMax(segment.box().high)};
  std::vector<int> members(segments.size());
  std::iota(members.begin(), members.end(), 0);
  Search search(segments, margin, limit);
  if (!search.search(all, members)) return std::nullopt;
  return search.sorted_pairs();
}

}  // namespace openclose
