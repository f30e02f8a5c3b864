#include "openclose/analysis/corner_entry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/overlap.h"

namespace openclose {
namespace {

/// [-] A shorter part of a step would be no step: the corner counts as being behind already.
constexpr double shortest_part = 1e-5;
/// [-] Of what is tolerated: closed contacts whose gaps exclude each other miss theirs by three times as much.
constexpr double behind = 4.0;
/// [m] To which corners that slide on something count as flush.
constexpr double flush_m = 2.0 * tolerance::edge_end_m;

/// A point that goes straight from one place to another within the step.
struct Way {
  Vec2 start, gone;
  Vec2 at(double part) const { return start + part * gone; }
};

class Ways {
 public:
  Ways(const BlockSystem& system, const StepSolution& solution) : system_(system), solution_(solution) {}

  Way operator()(int b, int vertex) const {
    return {system_.position(b, vertex), Motion::displacement(solution_.of(system_, b), system_.arm(vertex), system_.rotation_kind())};
  }
  /// [m] From the way of a corner, an arc, to its chord.
  double bow(int b) const { return 0.125 * system_.block(b).radius * std::pow(Motion::rotation(solution_.of(system_, b)), 2); }
  /// [m] By which no two points of the blocks that are near each other can come nearer.
  double approach(int a, int b) const {
    const auto of_a = solution_.of(system_, a), of_b = solution_.of(system_, b);
    const auto& block_a = system_.block(a);
    const auto& block_b = system_.block(b);
    return Motion::translation(of_a - of_b).norm() + block_a.radius * std::abs(Motion::rotation(of_a)) +
           block_b.radius * std::abs(Motion::rotation(of_b));
  }

 private:
  const BlockSystem& system_;
  const StepSolution& solution_;
};

/// How a corner moves against an edge.
class Course {
 public:
  Course(const Way& corner, const Way& start, const Way& end) : corner_(corner), start_(start), end_(end), length_((end.start - start.start).norm()) {
    // Behind is on the left. The area between edge and corner is a quadratic function of the part of the step.
    const Vec2 edge = end.start - start.start, edge_gone = end.gone - start.gone;
    const Vec2 lever = corner.start - start.start, lever_gone = corner.gone - start.gone;
    c0_ = cross(edge, lever), c1_ = cross(edge, lever_gone) + cross(edge_gone, lever), c2_ = cross(edge_gone, lever_gone);
  }
  /// [-] When it is behind by a depth [m]; 1 if it is so at once, or does not end up behind by `least` [m].
  double part(double depth, double least) const {
    const double c = c0_ - depth * length_;
    if (c >= 0.0 || c0_ + c1_ + c2_ <= least * length_) return 1.0;
    // It is before that at the start and behind it at the end, so that exactly one root lies between. Without cancellation, since c < 0.
    return -2.0 * c / (c1_ + std::sqrt(std::max(0.0, c1_ * c1_ - 4.0 * c2_ * c)));
  }
  /// [m] Behind the line of the edge, but for how that becomes longer or shorter.
  double depth(double part) const { return (c0_ + part * (c1_ + part * c2_)) / length_; }
  /// [m] Where it is along the edge.
  double along(double part) const { return (end_.at(part) - start_.at(part)).dot(corner_.at(part) - start_.at(part)) / length_; }
  double length() const { return length_; }

 private:
  const Way &corner_, &start_, &end_;
  double length_;
  double c0_, c1_, c2_;
};

/// Which edges corners are in contact with: contacts in a chain for each corner, since all of them are too many to go through for one. The chains are
/// laid when they are first asked for.
class HeldCorners {
 public:
  explicit HeldCorners(std::span<const Contact> contacts) : contacts_(contacts) {}

  bool contain(int vertex, int edge) {
    if (before_.size() < contacts_.size()) lay_chains();
    int i = vertex < static_cast<int>(last_.size()) ? last_[vertex] : none;
    while (i != none && contacts_[i].edge != edge) i = before_[i];
    return i != none;
  }

 private:
  static constexpr int none = -1;

  void lay_chains() {
    before_.resize(contacts_.size());
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const auto corner = static_cast<std::size_t>(contacts_[i].vertex);
      if (corner >= last_.size()) last_.resize(corner + 1, none);
      before_[i] = std::exchange(last_[corner], static_cast<int>(i));
    }
  }

  std::span<const Contact> contacts_;
  std::vector<int> last_, before_;  ///< contact of a corner, and the one of the same corner before a contact; or none
};

class Entries {
 public:
  Entries(const BlockSystem& system, const StepSolution& solution, const EntryTolerance& tolerance, std::span<const Contact> held)
      : system_(system), ways_(system, solution), tolerance_(tolerance), held_(held) {}

  /// [-] Of the corners of one block into another one.
  double first(int of, int into) {
    const auto& block = system_.block(of);
    const auto& target = system_.block(into);
    double first = 1.0;
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) {
      const Vec2 p = system_.position(of, v);
      if (system_.is_reflex(v) || (p - system_.centroid(into)).squaredNorm() > std::pow(target.radius + reach_, 2)) continue;
      for (int e = target.first_vertex; e < target.first_vertex + target.vertex_count; ++e) {
        if (may_enter(p, into, e)) first = std::min(first, entry(ways_(of, v), v, into, e));
      }
    }
    return first;
  }
  /// Whether a corner of one of two blocks may be in the other one at the end of the step; what is tolerated is that of these two from then on.
  bool may_be(int a, int b) {
    reach_ = ways_.approach(a, b);
    bow_ = ways_.bow(a) + ways_.bow(b);
    tolerated_ = tolerance_.of(std::min(width(a), width(b)));
    return reach_ > flush_m && (system_.centroid(a) - system_.centroid(b)).norm() <= system_.block(a).radius + system_.block(b).radius + reach_;
  }

 private:
  /// Otherwise what the two blocks have moved lets corners enter no deeper than is tolerated, and only tips are gone through within the step.
  bool may_end_too_deep() const { return reach_ > behind * tolerated_; }
  /// [m] Behind an edge: no deeper a corner is met.
  double met_depth() const { return std::max(0.5 * tolerated_, flush_m); }
  /// Whether a corner is near enough to the line of an edge to come behind it in the step, and not as deep behind it already as it may enter: of most
  /// edges that is known before its way is.
  bool may_enter(const Vec2& p, int into, int e) const {
    const Vec2 start = system_.position(into, e), edge = system_.position(into, system_.next(e)) - start;
    const double area = cross(edge, p - start), reach = area <= 0.0 ? reach_ : may_end_too_deep() ? met_depth() : 0.0;
    return area * area <= reach * reach * edge.squaredNorm();
  }
  /// [m] No more than 2 area / perimeter of a convex block, whose perimeter is at most that of the circle around it.
  double width(int b) const { return system_.block(b).area / (std::numbers::pi * system_.block(b).radius); }
  bool is_held(int v, int e) { return held_.contain(v, e); }

  double entry(const Way& corner, int v, int into, int e) {
    const Way start = ways_(into, e), end = ways_(into, system_.next(e));
    const Course course(corner, start, end);
    const double early = course.part(0.5 * tolerated_, behind * tolerated_), late = course.part(flush_m, flush_m);
    const bool is_behind_at_once = !is_within_step(early);
    const double part = is_behind_at_once ? late : early;
    if (!is_within_step(part) || is_held(v, e)) return 1.0;
    const double along = course.along(part), from_start = along, from_end = course.length() - along;
    const double inside = std::min(from_start, from_end);
    const int tip = from_start < from_end ? e : system_.next(e), neighbour = from_start < from_end ? system_.previous(e) : system_.next(e);
    const bool in_notch = system_.is_reflex(tip);
    // What has gone through a tip is in no block at the end of the step, and nothing would find it however deep it is behind the edge.
    if (is_behind_at_once && inside > flush_m && !in_notch && depth_at_end(corner, into, neighbour) < -flush_m)
      return before_leaving(course, corner, into, neighbour, late);
    const double near_tip = may_end_too_deep() ? behind * tolerated_ : flush_m, beside_tip = may_end_too_deep() ? tolerated_ : flush_m;
    if (inside > near_tip) return is_behind_at_once ? 1.0 : part;
    // In a notch one wall leads the corner on to the other one, and nothing slides on over that: what is behind one wall beyond its end is behind
    // both.
    if (inside < -(in_notch ? reach_ : beside_tip + bow_)) return 1.0;
    if (in_notch) return is_behind_at_once ? 1.0 : part;
    // At its end a corner slides on over a neighbour that is flush with the block, unless it ends as deep behind that side of the block, which has
    // not held it, or its own block is behind that side, too: the feet of two blocks that meet on one floor. Detection takes corners for flush until
    // they are deeper than rounding leaves them, so that one that was behind by less at the end of the last step counts again.
    if (stands_on(v, neighbour)) {
      const bool is_in = !is_held(v, neighbour) && depth_at_end(corner, into, neighbour) > behind * tolerated_;
      return is_in && !is_behind_at_once ? part : 1.0;
    }
    // Corners that lie on each other have one contact, that of either.
    const bool is_held_by_tip = is_held(tip, v) || is_held(tip, system_.previous(v));
    return is_held_by_tip ? 1.0 : is_within_step(late) ? late : is_behind_at_once ? 1.0 : early;
  }
  /// [-] When a corner that has come through an edge and leaves through the next one within the step is half-way to where it is as near to that as to
  /// the edge. Detection finds it there, and all others that have come by then and have not left: a cut at each one's moment would be one for each
  /// place where four blocks of a slope meet. By then it is no deeper than a corner is met, for rigid ones hardly more than flush.
  double before_leaving(const Course& course, const Way& corner, int into, int next, double come) const {
    const Way start = ways_(into, next), end = ways_(into, system_.next(next));
    const Course to_next(corner, start, end);
    const auto nearer = [&](double part) { return to_next.depth(part) - course.depth(part); };
    const double at_first = nearer(come), at_last = nearer(1.0);
    return at_first > 0.0 ? std::min(come + 0.5 * (1.0 - come) * at_first / (at_first - at_last), course.part(met_depth(), met_depth())) : come;
  }
  /// [m] Of a corner behind the line of an edge at the end of the step.
  double depth_at_end(const Way& corner, int into, int e) const {
    const Way start = ways_(into, e), end = ways_(into, system_.next(e));
    const Vec2 edge = end.at(1.0) - start.at(1.0);
    return cross(edge, corner.at(1.0) - start.at(1.0)) / edge.norm();
  }
  static bool is_within_step(double part) { return part >= shortest_part && part < 1.0; }
  /// Both sides of a corner leave the half-plane behind an edge.
  bool stands_on(int v, int e) const {
    const Vec2 along = (system_.arm(system_.next(e)) - system_.arm(e)).normalized(), outward(along.y(), -along.x());
    const auto leaves = [&](int other) {
      return outward.dot((system_.arm(other) - system_.arm(v)).normalized()) >= -std::sin(tolerance::flush_tilt_rad);
    };
    return leaves(system_.next(v)) && leaves(system_.previous(v));
  }

  const BlockSystem& system_;
  const Ways ways_;
  const EntryTolerance tolerance_;
  HeldCorners held_;
  /// [m] Of the present two blocks: what is tolerated, by how much they come nearer at most, and how far their corners pass beside straight ways.
  double tolerated_ = 0.0, reach_ = 0.0, bow_ = 0.0;
};

}  // namespace

double first_entry(const BlockSystem& system, const StepSolution& solution, const std::vector<std::pair<int, int>>& pairs,
                   const EntryTolerance& tolerance, std::span<const Contact> held) {
  Entries entries(system, solution, tolerance, held);
  double first = 1.0;
  for (const auto& [a, b] : pairs) {
    if (entries.may_be(a, b)) first = std::min({first, entries.first(a, b), entries.first(b, a)});
  }
  return first;
}

bool pass_into_each_other(const BlockSystem& system, const StepSolution& solution, const std::vector<std::pair<int, int>>& pairs, double allowed) {
  const Ways ways(system, solution);
  const auto outline = [&](int b, double part) {
    const auto& block = system.block(b);
    Outline of{{}, true};
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) {
      of.corners.push_back(ways(b, v).at(part));
      of.is_convex = of.is_convex && !system.is_reflex(v);
    }
    return of;
  };
  const auto depth = [&](int a, int b, double part) { return overlap_depth_beyond(allowed, outline(a, part), outline(b, part)); };
  return std::ranges::any_of(pairs, [&](const std::pair<int, int>& pair) {
    const auto [a, b] = pair;
    const double nearer = ways.approach(a, b);
    if (nearer <= allowed || (system.centroid(a) - system.centroid(b)).norm() > system.block(a).radius + system.block(b).radius + nearer)
      return false;
    return depth(a, b, 1.0) > allowed && depth(a, b, 0.0) <= allowed;
  });
}

}  // namespace openclose
