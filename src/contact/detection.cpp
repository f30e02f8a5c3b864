#include "openclose/contact/detection.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"

namespace openclose {
namespace {

/// How far two edges may count as facing each other; see the header.
double parallel_weight(double cosine) {
  static const double full = std::cos(tolerance::parallel_full_rad);
  static const double none = std::cos(tolerance::parallel_none_rad);
  if (cosine >= full) return 1.0;
  if (cosine <= none) return 0.0;
  return (tolerance::parallel_none_rad - std::acos(cosine)) / (tolerance::parallel_none_rad - tolerance::parallel_full_rad);
}

/// Contacts by their vertex and edge.
class ContactIndex {
 public:
  template <int N>
  ContactIndex(const BlockSystem<N>& system, const std::vector<Contact>& contacts) : contacts_(contacts) {
    index_.reserve(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      index_.emplace(key(contacts[i].vertex, contacts[i].edge), i);
      if (contacts[i].status == ContactStatus::open) continue;
      const int edge = contacts[i].edge;
      for (const int corner : {contacts[i].vertex, edge, system.next(edge)}) closed_.emplace(corner, i);
    }
  }
  /// Position in the list, or -1.
  std::ptrdiff_t find(int vertex, int edge) const {
    const auto it = index_.find(key(vertex, edge));
    return it == index_.end() ? -1 : static_cast<std::ptrdiff_t>(it->second);
  }
  bool was_closed(int vertex, int edge) const {
    const std::ptrdiff_t i = find(vertex, edge);
    return i >= 0 && contacts_[i].status != ContactStatus::open;
  }
  /// [m] length over which the contact is closed.
  double closed_length(int vertex, int edge) const { return was_closed(vertex, edge) ? contacts_[find(vertex, edge)].length : 0.0; }
  /// Whether this vertex or one of its two edges is in contact.
  bool closed(int vertex) const { return closed_.contains(vertex); }
  /// Closed contacts of this vertex and those on its two edges.
  template <class F>
  void for_closed(int vertex, F f) const {
    const auto [begin, end] = closed_.equal_range(vertex);
    for (auto it = begin; it != end; ++it) f(contacts_[it->second]);
  }

 private:
  static std::uint64_t key(int vertex, int edge) { return (static_cast<std::uint64_t>(vertex) << 32) | static_cast<std::uint32_t>(edge); }
  const std::vector<Contact>& contacts_;
  std::unordered_map<std::uint64_t, std::size_t> index_;
  std::unordered_multimap<int, std::size_t> closed_;  ///< closed contacts by their vertex and by the ends of their edge
};

/// Narrow phase between the blocks of one pair. Collects contacts; a vertex-edge pair found twice gets the sum of the lengths.
template <int N>
class NarrowPhase {
 public:
  NarrowPhase(const BlockSystem<N>& system, double reach, const ContactIndex& previous) : system_(system), reach_(reach), previous_(previous) {}

  void run(int block_a, int block_b, std::vector<Contact>& found) {
    found_ = &found;
    first_ = found.size();
    for_each_vertex(block_a, [&](int a) { for_each_vertex(block_b, [&](int b) { facing_edges(block_a, a, block_b, b); }); });
    lone_corners(block_a, block_b);
    lone_corners(block_b, block_a);
  }

 private:
  struct Edge {
    Vec2 start, direction;
    double length;
    Vec2 normal() const { return {direction.y(), -direction.x()}; }  ///< outward
    double gap(const Vec2& p) const { return normal().dot(p - start); }
    double along(const Vec2& p) const { return direction.dot(p - start); }
  };

  template <class F>
  void for_each_vertex(int block, F f) const {
    const auto& b = system_.block(block);
    for (int v = b.first_vertex; v < b.first_vertex + b.vertex_count; ++v) f(v);
  }

  Edge edge_at(int block, int e) const {
    const Vec2 start = system_.position(block, e);
    const Vec2 span = system_.arm(system_.next(e)) - system_.arm(e);
    const double length = span.norm();
    return {start, span / length, length};
  }

  void facing_edges(int block_a, int a, int block_b, int b) {
    const Edge edge_a = edge_at(block_a, a), edge_b = edge_at(block_b, b);
    const double weight = parallel_weight(-edge_a.direction.dot(edge_b.direction));
    if (weight == 0.0) return;
    // Along the bisector u edge b runs forward and edge a backward, so that the overlap is [max of starts, min of ends].
    const Vec2 u = (edge_b.direction - edge_a.direction).normalized();
    const int a_end = system_.next(a), b_end = system_.next(b);
    const auto along = [&](int block, int v) { return u.dot(system_.position(block, v) - edge_b.start); };
    const double a_low = along(block_a, a_end), a_high = along(block_a, a);
    const double b_low = along(block_b, b), b_high = along(block_b, b_end);
    const double overlap = std::min(a_high, b_high) - std::max(a_low, b_low);
    if (overlap < tolerance::shortest_overlap_m) return;
    const double length = 0.5 * weight * overlap;
    add_end(block_a, a_end, a, block_b, b, b, a_low >= b_low, std::abs(a_low - b_low), length);
    add_end(block_a, a, a, block_b, b_end, b, a_high <= b_high, std::abs(a_high - b_high), length);
  }

  /// One end of an overlap: vertex va of edge a on edge b, or vertex vb of edge b on edge a; `beyond` [m] is how far the other one lies outside the
  /// overlap. A reflex vertex has material all around and touches nothing: the other block's vertex stands in, if it leans into that notch's wall and
  /// is not far off.
  void add_end(int block_a, int va, int a, int block_b, int vb, int b, bool a_is_inside, double beyond, double length) {
    const bool inside_is_reflex = system_.is_reflex(a_is_inside ? va : vb);
    const double seam = tolerance::seam_height_m + tolerance::seam_closures * std::max(closure(va), closure(vb));
    if (inside_is_reflex && beyond > seam) return;
    // The two corners take turns: a joint that has closed under one of them is closed for the other.
    const bool closed = previous_.was_closed(va, b) || previous_.was_closed(vb, a);
    if (a_is_inside != inside_is_reflex) {
      add(block_a, va, block_b, b, length, closed);
    } else {
      add(block_b, vb, block_a, a, length, closed);
    }
  }

  void lone_corners(int vertex_block, int edge_block) {
    for_each_vertex(vertex_block, [&](int v) {
      if (system_.is_reflex(v)) return;
      const Vec2 p = system_.position(vertex_block, v);
      for_each_vertex(edge_block, [&](int e) {
        const Edge edge = edge_at(edge_block, e);
        if (edge.gap(p) > reach_) return;
        const double along = edge.along(p);
        const double beyond = std::max(-along, along - edge.length);
        if (beyond > 0.0 && beyond > end_margin(v, edge)) return;
        const double weight = lone_weight(v, edge);
        if (weight == 0.0 || passes_over(vertex_block, v, edge_block, e)) return;
        const Vec2 ahead = system_.arm(system_.next(v)) - system_.arm(v), back = system_.arm(system_.previous(v)) - system_.arm(v);
        const auto projection = [&](const Vec2& side) { return std::min(std::abs(side.dot(edge.direction)), edge.length); };
        add(vertex_block, v, edge_block, e, 0.5 * weight * (projection(ahead) + projection(back)), previous_.was_closed(v, e));
      });
    });
  }

  /// 1 - w_v of the header: 0 where one side of the corner faces the edge or points into its half-plane.
  double lone_weight(int v, const Edge& edge) const {
    if (!stands_on(v, edge)) return 0.0;
    const Vec2 ahead = system_.arm(system_.next(v)) - system_.arm(v), back = system_.arm(system_.previous(v)) - system_.arm(v);
    return 1.0 - std::max(parallel_weight(-ahead.normalized().dot(edge.direction)), parallel_weight(back.normalized().dot(edge.direction)));
  }

  /// \param closed  whether this place was in contact already
  void add(int vertex_block, int v, int edge_block, int e, double length, bool closed) {
    if (system_.is_reflex(v)) return;
    for (std::size_t i = first_; i < found_->size(); ++i) {
      Contact& known = (*found_)[i];
      if (known.vertex == v && known.edge == e) {
        known.length += length;
        return;
      }
    }
    const Edge edge = edge_at(edge_block, e);
    const Vec2 p = system_.position(vertex_block, v);
    const double gap = edge.gap(p);
    if (gap > reach_ || !outside(v, edge)) return;
    if (gap < 0.0 && !entered_through(v, p, edge_block, e, gap, closed)) return;
    Contact contact;
    contact.vertex_block = vertex_block;
    contact.vertex = v;
    contact.edge_block = edge_block;
    contact.edge = e;
    contact.length = length;
    contact.gap = gap;
    found_->push_back(contact);
  }

  /// [m] What the contacts of a corner have closed.
  double closure(int v) const {
    double largest = 0.0;
    previous_.for_closed(v, [&](const Contact& c) { largest = std::max(largest, c.vertex == v ? -c.gap : 0.0); });
    return largest;
  }
  /// [m] How far the closures of its contacts, those on its two edges included, have moved a corner along the normal of `edge`.
  double closure_across(int v, const Edge& edge) const {
    double largest = 0.0;
    previous_.for_closed(v, [&](const Contact& c) {
      const double cosine = edge.direction.dot(edge_at(c.edge_block, c.edge).direction);
      largest = std::max(largest, -c.gap * std::abs(cosine));
    });
    return largest;
  }

  /// Two corners that meet separate the blocks along any one of up to four edges, theirs at v and at the end of e: as long as one that turns away
  /// from e does, v does not run into e. Blocks that lie flush but for the closures of their contacts must not catch on the seams between them: a
  /// corner that slides on something keeps its way if what it slides on is lower than the seam's height. Where corners coincide and nothing has
  /// closed yet, the motion decides. An overlap no longer than a seam is high is no closed contact.
  bool passes_over(int vertex_block, int v, int edge_block, int e) const {
    const Edge edge = edge_at(edge_block, e);
    const Vec2 p = system_.position(vertex_block, v);
    const bool near_start = edge.along(p) < 0.5 * edge.length;
    const int end = near_start ? e : system_.next(e);
    if (previous_.closed_length(v, e) > tolerance::seam_height_m || system_.is_reflex(end)) return false;
    const Vec2 q = system_.position(edge_block, end);
    const bool slides = previous_.closed(v) || previous_.closed(end);
    if (!slides && (p - q).norm() > tolerance::edge_end_m) return false;
    const bool in_front = edge.gap(p) > -tolerance::shortest_edge_m;
    const double step = slides && in_front ? tolerance::seam_height_m : tolerance::edge_end_m;
    const auto separates = [&](int corner, const Vec2& position, const Edge& other) {
      if (!turns_away(edge, other) || !stands_on(corner, other)) return false;
      const double closure = std::max(closure_across(v, other), closure_across(end, other));
      return other.gap(position) > -step - tolerance::seam_closures * closure;
    };
    return separates(v, p, edge_at(edge_block, near_start ? system_.previous(e) : system_.next(e))) || separates(end, q, edge_at(vertex_block, v)) ||
           separates(end, q, edge_at(vertex_block, system_.previous(v)));
  }

  static bool turns_away(const Edge& a, const Edge& b) {
    static const double bend = std::cos(tolerance::parallel_none_rad);
    return std::abs(a.direction.dot(b.direction)) < bend;
  }

  /// [m] How far beyond an end of the edge a corner still counts as opposite to it: where the corner leans on something else there, a notch's other
  /// wall or another block, by what its contacts have closed.
  double end_margin(int v, const Edge& edge) const {
    bool leans = false;
    previous_.for_closed(v, [&](const Contact& c) { leans |= c.vertex == v && turns_away(edge_at(c.edge_block, c.edge), edge); });
    return tolerance::edge_end_m + (leans ? tolerance::seam_closures * closure(v) : 0.0);
  }

  /// Both sides of the corner leave the edge's half-plane: only then can the corner touch the edge from outside. Overlaps of facing edges fade out
  /// until parallel_none.
  bool outside(int v, const Edge& edge) const { return leaves(v, edge, std::sin(tolerance::parallel_none_rad)); }
  /// The same for a lone corner.
  bool stands_on(int v, const Edge& edge) const { return leaves(v, edge, std::sin(tolerance::flush_tilt_rad)); }
  bool leaves(int v, const Edge& edge, double tilt) const {
    const Vec2 ahead = system_.arm(system_.next(v)) - system_.arm(v), back = system_.arm(system_.previous(v)) - system_.arm(v);
    return edge.normal().dot(ahead.normalized()) >= -tilt && edge.normal().dot(back.normalized()) >= -tilt;
  }

  bool share_reflex_corner(int e, int f) const {
    return (system_.next(e) == f && system_.is_reflex(f)) || (system_.next(f) == e && system_.is_reflex(e));
  }

  /// A penetrating corner touches the edge it came in through: no other edge that it could touch is nearer. Only in a notch does it touch both walls.
  /// History decides nothing here: beside a four-block corner a corner is first behind the joint's face, then, as it slides on, behind the right one.
  bool entered_through(int v, const Vec2& p, int edge_block, int e, double gap, bool closed) {
    // What lies behind the edge must lie in the block, except for what drawings leave and what contacts that carry load have closed.
    if (-gap > tolerance::deepest_initial_overlap_m && !closed && !in_block(edge_block, p)) return false;
    const Edge edge = edge_at(edge_block, e);
    bool nearest = true;
    for_each_vertex(edge_block, [&](int f) {
      if (f == e || share_reflex_corner(e, f)) return;
      const Edge other = edge_at(edge_block, f);
      const double distance = distance_to_segment(p, other.start, other.start + other.length * other.direction);
      // At a needle's tip, closed by a little, the edge that is faced need not be the nearest one.
      static const double needle = std::cos(2.0 * tolerance::parallel_none_rad);
      const bool at_needle = std::abs(edge.direction.dot(other.direction)) > needle;
      const bool could_touch = at_needle ? stands_on(v, other) : outside(v, other);
      if (could_touch && distance < -gap - tolerance::shortest_edge_m) nearest = false;
    });
    return nearest;
  }

  bool in_block(int block, const Vec2& p) {
    polygon_.clear();
    for_each_vertex(block, [&](int v) { polygon_.push_back(system_.position(block, v)); });
    return contains(polygon_, p) || distance_to_boundary(polygon_, p) <= tolerance::edge_end_m;
  }

  const BlockSystem<N>& system_;
  double reach_;
  const ContactIndex& previous_;
  std::vector<Contact>* found_ = nullptr;
  std::size_t first_ = 0;
  Polygon polygon_;
};

void inherit(const Contact& from, Contact& to) {
  to.status = from.status;
  to.bonded = from.bonded;
  to.elastic_slip = from.elastic_slip;
  to.normal_force = from.normal_force;
  to.shear_force = from.shear_force;
  to.stored_energy = from.stored_energy;
}

/// Whether `now` continues `before` under another name: the same corner has gone on to a nearly collinear edge, or, at the end of an overlap, the
/// corner that lay on the edge has passed its end and the edge's own corner lies on the other block's edge instead.
template <int N>
bool continues(const BlockSystem<N>& system, const Contact& before, const Contact& now) {
  static const double aligned = std::cos(tolerance::parallel_none_rad);
  const auto direction = [&](int e) { return (system.arm(system.next(e)) - system.arm(e)).normalized(); };
  const double cosine = direction(now.edge).dot(direction(before.edge));
  if (now.vertex == before.vertex) return cosine > aligned;
  const bool edge_end_took_over = now.vertex == before.edge || now.vertex == system.next(before.edge);
  const bool edge_belongs_to_corner = now.edge == before.vertex || system.next(now.edge) == before.vertex;
  return edge_end_took_over && edge_belongs_to_corner && cosine < -aligned;
}

}  // namespace

template <int N>
bool Detector<N>::moved_beyond_skin(const BlockSystem<N>& system) const {
  for (int b : system.free_blocks()) {
    const double moved = Motion<N>::displacement_bound(system.displacement(b) - searched_at_[b], system.block(b).radius);
    if (moved > 0.5 * tolerance::search_skin_m) return true;
  }
  return false;
}

template <int N>
void Detector<N>::search(const BlockSystem<N>& system) {
  ++counters_.searches;
  std::vector<Box> boxes;
  std::vector<Vec2> positions;
  searched_at_.assign(system.block_count(), BlockSystem<N>::Unknowns::Zero());
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    searched_at_[b] = system.displacement(b);
    positions.clear();
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) positions.push_back(system.position(b, v));
    boxes.push_back(Box::around(positions).inflated(0.5 * (reach_ + tolerance::search_skin_m)));
  }
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) { return std::pair(boxes[i].low.x(), i) < std::pair(boxes[j].low.x(), j); });
  pairs_.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].low.x() <= boxes[order[i]].high.x(); ++j) {
      const int a = std::min(order[i], order[j]), b = std::max(order[i], order[j]);
      const bool someone_moves = system.block(a).equation >= 0 || system.block(b).equation >= 0;
      if (someone_moves && boxes[a].overlaps(boxes[b])) pairs_.emplace_back(a, b);
    }
  }
  std::sort(pairs_.begin(), pairs_.end());
}

template <int N>
void Detector<N>::update(const BlockSystem<N>& system, const JointTable& joints, std::vector<Contact>& contacts) {
  if (first_ || !skip_search_ || moved_beyond_skin(system)) {
    search(system);
  } else {
    ++counters_.searches_skipped;
  }
  ++counters_.narrow_phases;
  std::vector<Contact> found;
  found.reserve(contacts.size() + 8);
  const ContactIndex previous(system, contacts);
  NarrowPhase<N> narrow(system, reach_, previous);
  for (const auto& [a, b] : pairs_) {
    const std::size_t begin = found.size();
    narrow.run(a, b, found);
    const int joint = joints.index(system.block(a).material, system.block(b).material);
    for (std::size_t i = begin; i < found.size(); ++i) found[i].joint = joint;
  }

  std::vector<char> taken(contacts.size(), 0);
  std::vector<std::size_t> born;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::ptrdiff_t old = previous.find(found[i].vertex, found[i].edge);
    if (old >= 0) {
      inherit(contacts[old], found[i]);
      taken[old] = 1;
    } else {
      found[i].bonded = first_ && found[i].gap <= tolerance::deepest_initial_overlap_m;
      born.push_back(i);
    }
  }
  if (!first_) {
    // Longest first: where a corner lies on the seam of two edges the one that carries it inherits.
    std::sort(born.begin(), born.end(), [&](std::size_t i, std::size_t j) { return found[i].length > found[j].length; });
    for (const std::size_t i : born) {
      std::ptrdiff_t ancestor = -1;
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        if (taken[k] || !continues(system, contacts[k], found[i])) continue;
        if (ancestor < 0 || contacts[k].length > contacts[ancestor].length) ancestor = static_cast<std::ptrdiff_t>(k);
      }
      if (ancestor < 0) continue;
      inherit(contacts[ancestor], found[i]);
      taken[ancestor] = 1;
      ++counters_.transfers;
    }
  }
  contacts = std::move(found);
  first_ = false;
}

template class Detector<3>;

}  // namespace openclose
