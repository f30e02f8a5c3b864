#include "openclose/geometry/near_pairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace openclose {
namespace {

/// Fewer segments than this are compared each with each at once.
constexpr std::size_t few = 8;
/// A cut pays when it leaves less than this part of the comparisons.
constexpr double worthwhile = 0.8;

/// What of a segment lies in a part of the plane.
struct Piece {
  int segment;
  Vec2 from, to;
};

/// A line across the plane: points x with normal.dot(x) = offset.
struct Cut {
  Vec2 normal;
  double offset;

  double height(const Vec2& point) const { return normal.dot(point) - offset; }
};

/// The direction of most of the length: directions, which have no sense, add up when their angles are doubled.
Vec2 main_direction(const std::vector<Piece>& pieces) {
  Vec2 doubled = Vec2::Zero();
  for (const Piece& p : pieces) {
    const Vec2 way = p.to - p.from;
    const double length = way.norm();
    if (length > 0.0) doubled += Vec2(way.x() * way.x() - way.y() * way.y(), 2.0 * way.x() * way.y()) / length;
  }
  const double angle = 0.5 * std::atan2(doubled.y(), doubled.x());
  return {std::cos(angle), std::sin(angle)};
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

  /// Collects the pairs among pieces that lie in one part of the plane; false when there are too many.
  bool search(const std::vector<Piece>& pieces) {
    if (pieces.size() > few) {
      // Segments side by side that run across both axes are parted by no cut but one along them.
      for (const Vec2& normal : {Vec2(Vec2::UnitX()), Vec2(Vec2::UnitY()), perpendicular(main_direction(pieces))}) {
        const Cut cut = middle(pieces, normal);
        const std::array<std::vector<Piece>, 2> sides{side(pieces, cut, 1.0), side(pieces, cut, -1.0)};
        if (squared(sides[0]) + squared(sides[1]) > worthwhile * squared(pieces)) continue;
        return search(sides[0]) && search(sides[1]);
      }
    }
    return compare(pieces);
  }

  std::vector<std::pair<int, int>> sorted_pairs() {
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    return std::move(pairs_);
  }

 private:
  static double squared(const std::vector<Piece>& pieces) { return static_cast<double>(pieces.size()) * static_cast<double>(pieces.size()); }

  static Cut middle(const std::vector<Piece>& pieces, const Vec2& normal) {
    std::vector<double> middles;
    middles.reserve(pieces.size());
    for (const Piece& p : pieces) middles.push_back(normal.dot(0.5 * (p.from + p.to)));
    const auto half = middles.begin() + static_cast<std::ptrdiff_t>(middles.size() / 2);
    std::nth_element(middles.begin(), half, middles.end());
    return {normal, *half};
  }

  /// What lies on one side of a cut or less than the margin beyond it: of two points within the margin of each other one side has both. Twice the
  /// margin, and a part of the coordinates, for rounding.
  std::vector<Piece> side(const std::vector<Piece>& pieces, const Cut& cut, double sign) const {
    std::vector<Piece> kept;
    for (const Piece& p : pieces) {
      const double from = sign * cut.height(p.from), to = sign * cut.height(p.to);
      const double reach = -2.0 * margin_ - rounding * (std::abs(cut.offset) + p.from.cwiseAbs().sum() + p.to.cwiseAbs().sum());
      if (std::max(from, to) < reach) continue;
      const auto clipped = [&](const Vec2& end, double height, const Vec2& other, double height_of_other) {
        return height >= reach ? end : Vec2(end + (reach - height) / (height_of_other - height) * (other - end));
      };
      kept.push_back({p.segment, clipped(p.from, from, p.to, to), clipped(p.to, to, p.from, from)});
    }
    return kept;
  }

  bool compare(const std::vector<Piece>& pieces) {
    for (std::size_t a = 0; a < pieces.size(); ++a) {
      const Box reach = boxes_[pieces[a].segment].inflated(margin_);
      for (std::size_t b = a + 1; b < pieces.size(); ++b) {
        const auto [i, j] = std::minmax(pieces[a].segment, pieces[b].segment);
        if (!reach.overlaps(boxes_[pieces[b].segment])) continue;
        ++compared_;
        if (!apart(i, j)) pairs_.emplace_back(i, j);
      }
      if (compared_ > limit_) return false;
    }
    return true;
  }

  /// Farther than the margin, whatever rounding does to it.
  bool apart(int i, int j) const { return beside(segments_[i], segments_[j], 2.0 * margin_) || beside(segments_[j], segments_[i], 2.0 * margin_); }

  static constexpr double rounding = 1e-14;  ///< [-] of coordinates

  const std::vector<Segment>& segments_;
  double margin_;
  std::size_t limit_;
  std::size_t compared_ = 0;
  std::vector<Box> boxes_;
  std::vector<std::pair<int, int>> pairs_;
};

}  // namespace

std::optional<std::vector<std::pair<int, int>>> near_pairs(const std::vector<Segment>& segments, double margin, std::size_t limit) {
  std::vector<Piece> whole;
  whole.reserve(segments.size());
  for (const Segment& segment : segments) whole.push_back({static_cast<int>(whole.size()), segment.from, segment.to});
  Search search(segments, margin, limit);
  if (!search.search(whole)) return std::nullopt;
  return search.sorted_pairs();
}

}  // namespace openclose
