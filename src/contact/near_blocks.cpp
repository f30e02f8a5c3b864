#include "openclose/contact/near_blocks.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace openclose {
namespace {

/// The boxes by strips of y, those of a strip from left to right.
class Strips {
 public:
  explicit Strips(const std::vector<Box>& boxes) {
    const int n = static_cast<int>(boxes.size());
    std::vector<double> heights;
    bottom_ = boxes[0].low.y();
    double top = boxes[0].high.y();
    for (const Box& box : boxes) {
      heights.push_back(box.high.y() - box.low.y());
      bottom_ = std::min(bottom_, box.low.y());
      top = std::max(top, box.high.y());
    }
    std::nth_element(heights.begin(), heights.begin() + n / 2, heights.end());
    height_ = std::max(heights[n / 2], (top - bottom_) / n);
    deal_out(boxes, at(top) + 1);
  }

  int count() const { return static_cast<int>(begins_.size()) - 1; }
  int at(double y) const { return static_cast<int>((y - bottom_) / height_); }
  std::span<const int> members(int strip) const { return {members_.data() + begins_[strip], members_.data() + begins_[strip + 1]}; }

 private:
  void deal_out(const std::vector<Box>& boxes, int strips) {
    std::vector<int> from_left(boxes.size());
    begins_.assign(strips + 1, 0);
    std::iota(from_left.begin(), from_left.end(), 0);
    std::sort(from_left.begin(), from_left.end(), [&](int i, int j) { return std::pair(boxes[i].low.x(), i) < std::pair(boxes[j].low.x(), j); });
    for (const Box& box : boxes) {
      for (int k = at(box.low.y()); k <= at(box.high.y()); ++k) ++begins_[k + 1];
    }
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    members_.resize(begins_.back());
    std::vector<int> next(begins_.begin(), begins_.end() - 1);
    for (const int b : from_left) {
      for (int k = at(boxes[b].low.y()); k <= at(boxes[b].high.y()); ++k) members_[next[k]++] = b;
    }
  }

  double bottom_ = 0.0, height_ = 0.0;  ///< [m] of the lowest strip, of each
  std::vector<int> begins_, members_;
};

}  // namespace

std::vector<std::pair<int, int>> near_blocks(const BlockSystem& system, const std::vector<Box>& boxes, BlockShapes& shapes, double room,
                                             PairsOf which) {
  std::vector<std::pair<int, int>> pairs;
  const int n = static_cast<int>(boxes.size());
  if (n < 2) return pairs;
  const Strips strips(boxes);
  std::vector<int> counts(n + 1, 0);  // of pairs by their lower number
  for (int k = 0; k < strips.count(); ++k) {
    const std::span<const int> members = strips.members(k);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Box& box = boxes[members[i]];
      for (std::size_t j = i + 1; j < members.size() && boxes[members[j]].low.x() <= box.high.x(); ++j) {
        const auto [a, b] = std::minmax(members[i], members[j]);
        const int first = system.block(a).equation, second = system.block(b).equation;
        const bool is_asked_for =
            which == PairsOf::free_blocks ? first >= 0 || second >= 0 : first == BlockSystem::fixed && second == BlockSystem::fixed;
        if (!is_asked_for || !box.overlaps(boxes[members[j]])) continue;
        // Where both begin, and nowhere else.
        if (strips.at(std::max(box.low.y(), boxes[members[j]].low.y())) != k) continue;
        if (shapes.apart(a, b, room)) continue;
        pairs.emplace_back(a, b);
        ++counts[a + 1];
      }
    }
  }

  // In order: into their places by the lower number, then sorted among the few that share it.
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  std::vector<std::pair<int, int>> ordered(pairs.size());
  std::vector<int> places(counts.begin(), counts.end() - 1);
  for (const auto& pair : pairs) ordered[places[pair.first]++] = pair;
  for (int b = 0; b < n; ++b) std::sort(ordered.begin() + counts[b], ordered.begin() + counts[b + 1]);
  return ordered;
}

}  // namespace openclose
