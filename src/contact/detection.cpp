#include "openclose/contact/detection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

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

/// The contacts as they were, by pair and by corner.
class ContactIndex {
 public:
  template <int N>
  ContactIndex(const BlockSystem<N>& system, const std::vector<Contact>& contacts) : contacts_(contacts) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (contacts[i].status == ContactStatus::open) continue;
      const int edge = contacts[i].edge;
      for (const int corner : {contacts[i].vertex, edge, system.next(edge)}) closed_.emplace_back(corner, i);
    }
    std::sort(closed_.begin(), closed_.end());
  }

  /// Looks at the contacts [begin, end) of one pair of blocks.
  void select(std::size_t begin, std::size_t end) {
    begin_ = begin;
    end_ = end;
  }
  /// Position in the list, or -1; of the selected pair.
  std::ptrdiff_t find(int vertex, int edge) const {
    for (std::size_t i = begin_; i < end_; ++i) {
      if (contacts_[i].vertex == vertex && contacts_[i].edge == edge) return static_cast<std::ptrdiff_t>(i);
    }
    return -1;
  }
  bool was_closed(int vertex, int edge) const {
    const std::ptrdiff_t i = find(vertex, edge);
    return i >= 0 && contacts_[i].status != ContactStatus::open;
  }
  /// [m] length over which the contact is closed.
  double closed_length(int vertex, int edge) const { return was_closed(vertex, edge) ? contacts_[find(vertex, edge)].length : 0.0; }
  /// Whether this vertex or one of its two edges is in contact, with any block.
  bool closed(int vertex) const {
    const auto it = first_of(vertex);
    return it != closed_.end() && it->first == vertex;
  }
  /// Closed contacts of this vertex and those on its two edges.
  template <class F>
  void for_closed(int vertex, F f) const {
    for (auto it = first_of(vertex); it != closed_.end() && it->first == vertex; ++it) f(contacts_[it->second]);
  }

 private:
  using Entry = std::pair<int, std::size_t>;
  std::vector<Entry>::const_iterator first_of(int vertex) const { return std::lower_bound(closed_.begin(), closed_.end(), Entry(vertex, 0)); }

  const std::vector<Contact>& contacts_;
  std::size_t begin_ = 0, end_ = 0;
  std::vector<Entry> closed_;  ///< closed contacts by their vertex and by the ends of their edge, sorted
};

/// Narrow phase between the blocks of one pair. Collects contacts; a vertex-edge pair found twice gets the sum of the lengths.
template <int N>
class NarrowPhase {
 public:
  NarrowPhase(const BlockSystem<N>& system, double reach, const ContactIndex& previous) : system_(system), reach_(reach), previous_(previous) {}

  void run(int block_a, int block_b, std::vector<Contact>& found) {
    found_ = &found;
    first_ = found.size();
    sides_[0].fill(*this, block_a);
    sides_[1].fill(*this, block_b);
    // Only what lies in the box of both blocks, with the reach, can touch.
    const Box room = sides_[0].box.inflated(reach_).common(sides_[1].box.inflated(reach_));
    if (room.empty()) return;
    for_each_vertex(block_a, [&](int a) {
      if (!box_of(edge_at(block_a, a)).overlaps(room)) return;
      for_each_vertex(block_b, [&](int b) { facing_edges(block_a, a, block_b, b); });
    });
    lone_corners(block_a, block_b, room);
    lone_corners(block_b, block_a, room);
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

  /// The edges of one of the two blocks.
  struct Sides {
    int block = -1, first = 0;
    std::vector<Edge> edges;
    Box box;

    void fill(const NarrowPhase& phase, int of_block) {
      block = of_block;
      first = phase.system_.block(block).first_vertex;
      edges.clear();
      phase.for_each_vertex(block, [&](int v) {
        edges.push_back(phase.measured_edge(block, v));
        const Box own = box_of(edges.back());
        box = v == first ? own : Box{box.low.cwiseMin(own.low), box.high.cwiseMax(own.high)};
      });
    }
  };

  static Box box_of(const Edge& edge) { return Box::around(edge.start, edge.start + edge.length * edge.direction); }

  Edge edge_at(int block, int e) const {
    for (const Sides& side : sides_) {
      if (side.block == block) return side.edges[e - side.first];
    }
    return measured_edge(block, e);
  }

  Edge measured_edge(int block, int e) const {
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

  void lone_corners(int vertex_block, int edge_block, const Box& room) {
    for_each_vertex(vertex_block, [&](int v) {
      if (system_.is_reflex(v)) return;
      const Vec2 p = system_.position(vertex_block, v);
      if (!room.contains(p)) return;
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

  /// Whether a corner, or one of its two edges, is in contact with something parallel to `edge`.
  bool slides_along(int v, const Edge& edge) const {
    bool parallel = false;
    previous_.for_closed(v, [&](const Contact& c) { parallel |= !turns_away(edge_at(c.edge_block, c.edge), edge); });
    return parallel;
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
    const auto separates = [&](int corner, const Vec2& position, const Edge& other) {
      if (!turns_away(edge, other) || !stands_on(corner, other)) return false;
      const double step = in_front && (slides_along(v, other) || slides_along(end, other)) ? tolerance::seam_height_m : tolerance::edge_end_m;
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
  std::array<Sides, 2> sides_;
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
bool Detector<N>::moved_beyond_search_skin(const BlockSystem<N>& system) const {
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
  searched_at_.assign(system.block_count(), Unknowns::Zero());
  const double room = reach_ + skips_.contact_skin + tolerance::search_skin_m;
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    searched_at_[b] = system.displacement(b);
    positions.clear();
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) positions.push_back(system.position(b, v));
    boxes.push_back(Box::around(positions).inflated(0.5 * room));
  }
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) { return std::pair(boxes[i].low.x(), i) < std::pair(boxes[j].low.x(), j); });
  const std::vector<std::pair<int, int>> old_pairs = std::move(pairs_);
  const std::vector<PairState> old_states = std::move(states_);
  pairs_.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].low.x() <= boxes[order[i]].high.x(); ++j) {
      const int a = std::min(order[i], order[j]), b = std::max(order[i], order[j]);
      const bool someone_moves = system.block(a).equation >= 0 || system.block(b).equation >= 0;
      if (someone_moves && boxes[a].overlaps(boxes[b])) pairs_.emplace_back(a, b);
    }
  }
  std::sort(pairs_.begin(), pairs_.end());
  states_.assign(pairs_.size(), PairState());
  for (std::size_t i = 0, old = 0; i < pairs_.size(); ++i) {
    while (old < old_pairs.size() && old_pairs[old] < pairs_[i]) ++old;
    if (old < old_pairs.size() && old_pairs[old] == pairs_[i]) states_[i] = old_states[old];
  }
}

/// [m] Bound of how far points where two blocks can touch have moved against each other since the pair's contacts were found. With u the
/// displacements of the centroids and R the rotations since then, c the way between the centroids then and r the arm of the point from the centroid
/// of block 1, u_1 - u_2 - (R_2 - 1) c + (R_1 - R_2) r; r is not longer than the radius of block 1, the smaller one, and the reach.
template <int N>
double Detector<N>::moved(const BlockSystem<N>& system, std::size_t pair) const {
  auto [one, two] = pairs_[pair];
  Unknowns d_1 = system.displacement(one) - states_[pair].first, d_2 = system.displacement(two) - states_[pair].second;
  if (system.block(one).radius > system.block(two).radius) {
    std::swap(one, two);
    std::swap(d_1, d_2);
  }
  const double turn_1 = Motion<N>::rotation(d_1), turn_2 = Motion<N>::rotation(d_2);
  Vec2 shift = Motion<N>::translation(d_1) - Motion<N>::translation(d_2);
  if (turn_2 != 0.0) {
    const Vec2 way = system.centroid(one) - system.centroid(two) - shift;
    shift -= Motion<N>::turned_by(turn_2, way, RotationKind::exact);
  }
  return shift.norm() + (system.block(one).radius + reach_ + skips_.contact_skin) * std::abs(turn_1 - turn_2);
}

template <int N>
bool Detector<N>::mark_due_pairs(const BlockSystem<N>& system, bool all) {
  constexpr double companion_part = 0.1;  // of the skin
  due_.assign(pairs_.size(), all ? Due::yes : Due::no);
  if (all) return true;
  in_due_pair_.assign(system.block_count(), 0);
  bool any = false;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const double way = states_[i].known ? moved(system, i) : 2.0 * skips_.contact_skin + 1.0;
    if (way > companion_part * skips_.contact_skin) due_[i] = Due::moved;
    if (way <= skips_.contact_skin) continue;
    due_[i] = Due::yes;
    in_due_pair_[pairs_[i].first] = in_due_pair_[pairs_[i].second] = any = true;
  }
  if (!any) return false;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto [a, b] = pairs_[i];
    if (due_[i] == Due::moved && (in_due_pair_[a] || in_due_pair_[b])) due_[i] = Due::yes;
  }
  return true;
}

/// Contacts that are new inherit from those of the same corner that are gone.
template <int N>
void Detector<N>::pass_on_history(const BlockSystem<N>& system, std::vector<Contact>& before) {
  if (born_.empty() || gone_.empty()) return;
  gone_by_vertex_.clear();
  gone_by_edge_.clear();
  for (const std::size_t k : gone_) {
    gone_by_vertex_.emplace_back(before[k].vertex, k);
    gone_by_edge_.emplace_back(before[k].edge, k);
  }
  std::sort(gone_by_vertex_.begin(), gone_by_vertex_.end());
  std::sort(gone_by_edge_.begin(), gone_by_edge_.end());
  // Longest first: where a corner lies on the seam of two edges the one that carries it inherits.
  std::sort(born_.begin(), born_.end(),
            [&](std::size_t i, std::size_t j) { return found_[i].length != found_[j].length ? found_[i].length > found_[j].length : i < j; });
  constexpr double taken = -1.0;  // in place of a length
  for (const std::size_t i : born_) {
    std::ptrdiff_t ancestor = -1;
    const auto consider = [&](const std::vector<std::pair<int, std::size_t>>& gone, int key) {
      for (auto it = std::lower_bound(gone.begin(), gone.end(), std::pair<int, std::size_t>(key, 0)); it != gone.end() && it->first == key; ++it) {
        const std::size_t k = it->second;
        if (before[k].length == taken || !continues(system, before[k], found_[i])) continue;
        const auto rank = [&](std::size_t m) { return std::pair(-before[m].length, m); };
        if (ancestor < 0 || rank(k) < rank(ancestor)) ancestor = static_cast<std::ptrdiff_t>(k);
      }
    };
    consider(gone_by_vertex_, found_[i].vertex);
    consider(gone_by_edge_, found_[i].vertex);
    consider(gone_by_edge_, system.previous(found_[i].vertex));
    if (ancestor < 0) continue;
    inherit(before[ancestor], found_[i]);
    before[ancestor].length = taken;
    ++counters_.transfers;
  }
}

template <int N>
bool Detector<N>::update(const BlockSystem<N>& system, const JointTable& joints, std::vector<Contact>& contacts) {
  const bool all = forgotten_ || !skips_.search || !skips_.narrow_phase;
  const bool searches = forgotten_ || !skips_.search || moved_beyond_search_skin(system);
  forgotten_ = false;
  if (searches) {
    search(system);
  } else {
    ++counters_.searches_skipped;
  }
  if (!mark_due_pairs(system, all) && !searches) {
    counters_.narrow_phases_skipped += static_cast<long>(pairs_.size());
    return false;
  }
  found_.clear();
  born_.clear();
  gone_.clear();
  ContactIndex previous(system, contacts);
  NarrowPhase<N> narrow(system, reach_ + skips_.contact_skin, previous);
  const auto pair_of = [](const Contact& c) { return std::pair<int, int>(std::minmax(c.vertex_block, c.edge_block)); };
  std::size_t old = 0;  // contacts are in the order of their pairs
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto [a, b] = pairs_[i];
    for (; old < contacts.size() && pair_of(contacts[old]) < pairs_[i]; ++old) gone_.push_back(old);
    const std::size_t old_begin = old, begin = found_.size();
    while (old < contacts.size() && pair_of(contacts[old]) == pairs_[i]) ++old;
    if (due_[i] != Due::yes) {
      ++counters_.narrow_phases_skipped;
      found_.insert(found_.end(), contacts.begin() + old_begin, contacts.begin() + old);
      continue;
    }
    ++counters_.narrow_phases;
    states_[i] = {system.displacement(a), system.displacement(b), true};
    previous.select(old_begin, old);
    narrow.run(a, b, found_);
    const int joint = joints.index(system.block(a).material, system.block(b).material);
    lives_on_.assign(old - old_begin, 0);
    for (std::size_t k = begin; k < found_.size(); ++k) {
      Contact& c = found_[k];
      c.joint = joint;
      const std::ptrdiff_t known = previous.find(c.vertex, c.edge);
      if (known >= 0) {
        inherit(contacts[known], c);
        lives_on_[known - old_begin] = 1;
      } else {
        c.bonded = first_ && c.gap <= tolerance::deepest_initial_overlap_m;
        born_.push_back(k);
      }
    }
    for (std::size_t k = old_begin; k < old; ++k) {
      if (!lives_on_[k - old_begin]) gone_.push_back(k);
    }
  }
  for (; old < contacts.size(); ++old) gone_.push_back(old);
  if (!first_) pass_on_history(system, contacts);
  contacts.swap(found_);
  first_ = false;
  return true;
}

template class Detector<3>;

}  // namespace openclose
