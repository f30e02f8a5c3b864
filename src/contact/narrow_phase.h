// Which corners of two blocks face which edges, with which tributary length.
//
// Tributary lengths: one rule for all methods, continuous in the motion. Let theta be the angle by which an edge a of one block and an edge e of
// another miss being antiparallel, and w = 1 for theta <= parallel_full, 0 for theta >= parallel_none, linear between.
//   - Facing edges: the overlap o of a and e, projected on the bisector of their directions, makes a contact at each of its two ends, with w o/2.
//     Two blocks that slide off each other lose length, stiffness and cohesion continuously to zero.
//   - Lone corner: vertex v opposite to e, of which neither edge points into e's half-plane, gets (1 - w_v) times half the projections on e of its
//     own two edges (none counted longer than e), where w_v is the larger w of its two edges against e. It depends on the directions only, so it
//     does not change where a corner crosses from one edge to a collinear one of the next block. An edge that points in by up to parallel_full has
//     w_v = 1 anyhow, so that nothing jumps where it turns in.
// A vertex that faces e through both rules, or through both its edges, has one contact with the sum of the lengths.
//
// Corner against corner: where v comes to an end q of e, two convex blocks are apart as soon as one line separates them, which is one of up to four
// edges: the two of q with v outside, the two of v with q outside (both sides of the corner leave the edge's half-plane, to flush_tilt; else it is no
// candidate). A contact with each of them would lock the blocks. So v has no lone contact with e while another one of the four, more than
// parallel_none from e in direction, separates
//   - to within edge_end, where v and q coincide: nothing is in contact yet and the motion decides which edge it will be,
//   - to within edge_end and what the closures of contacts at v, q and their edges make of it (seam_closures), where one of them slides on something,
//   - and, while v is still in front of e and v or q slides along that line, to within seam_height: blocks that are flush in the drawing do not catch
//     on each other's faces.
// So a block whose front corner stands on a joint slides on, three blocks and air or four blocks around the corner. A contact that has closed over
// more than seam_height stays until its corner is nearer to another edge; at a reflex q both walls hold. Where nothing slides along the other line
// and v and q are farther apart than edge_end and the closures around them, the wider gap of the two keeps its contact.
//
// Where one tip has gone right through another one, so that all their sides cross and neither corner is in the other block, the contact is that of
// the line which they are least behind: two feet on one floor that lean over each other may come past each other's tips between two steps.
//
// In front of a notch a corner faces both walls from wherever it may reach them, also where it lies beyond the end of one: what is in front of both
// is in front of the whole line of either, and a corner that slides down one wall into the notch is to meet the other one there. Two feet that slide
// towards each other on one floor meet in such a notch.
//
// Where it is not continuous: a lone corner within edge_end of the seam of two collinear edges has a contact with both; it loses its length where it
// leaves the end of an edge that nothing continues; and at a corner the contact passes from one edge to the next with its gap, not with its
// direction. What becomes of the energy held there stands in history.h: it never grows.
//
// At four-block corners the diagonal blocks have facing edges without overlap and no lone corner, hence no contact: they cannot lock.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "openclose/contact/block_shapes.h"
#include "openclose/contact/contact_index.h"
#include "openclose/contact/kinematics.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"

namespace openclose {

/// Between the blocks of one pair. Collects contacts; a vertex-edge pair found twice gets the sum of the lengths.
class NarrowPhase {
 public:
  using Edge = BlockShapes::Edge;

  /// \param is_drawing  the blocks are where they were drawn
  NarrowPhase(const BlockSystem& system, const BlockSystem* present, double reach, bool is_drawing, BlockShapes& shapes, const ContactIndex& previous)
      : system_(system), present_(present), reach_(reach), is_drawing_(is_drawing), shapes_(shapes), previous_(previous) {}

  void run(int block_a, int block_b, std::vector<Contact>& found) {
    found_ = &found;
    first_ = found.size();
    // Only what lies in the box of both blocks, with the reach and what end_margin() allows, can touch.
    const double margin = reach_ + tolerance::seam_closures * previous_.deepest();
    const Box room = shapes_.box(block_a).inflated(margin).common(shapes_.box(block_b).inflated(margin));
    if (room.empty()) return;
    const bool some_of_a = find_near_corners(block_a, block_b, near_[0]), some_of_b = find_near_corners(block_b, block_a, near_[1]);
    if (!some_of_a && !some_of_b) return;
    const std::span<const Edge> edges_a = shapes_.edges(block_a), edges_b = shapes_.edges(block_b);
    const int first_a = system_.block(block_a).first_vertex, first_b = system_.block(block_b).first_vertex;
    for (std::size_t a = 0; a < edges_a.size(); ++a) {
      const bool a_is_near = has_near_end(near_[0], a);
      for (std::size_t b = 0; b < edges_b.size(); ++b) {
        const double cosine = -edges_a[a].direction.dot(edges_b[b].direction);
        if (cosine <= cosine_none || !(a_is_near || has_near_end(near_[1], b))) continue;
        facing_edges(block_a, first_a + static_cast<int>(a), block_b, first_b + static_cast<int>(b), parallel_weight(cosine));
      }
    }
    lone_corners(block_a, block_b, near_[0], room);
    lone_corners(block_b, block_a, near_[1], room);
  }

 private:
  /// By which a corner has found an edge.
  enum class Rule { facing_edges, lone_corner };

  /// Of the corners of a block, those that may touch the other one. Where two convex blocks were not in contact, a corner that touches an edge is at
  /// most as far beyond the lines along other edges as it is from this one, and by 1 % more where edges face each other that are not quite parallel,
  /// or beyond the end of this one by what end_margin() allows.
  bool find_near_corners(int block, int other, std::vector<char>& near) const {
    const std::span<const Edge> corners = shapes_.edges(block), edges = shapes_.edges(other);
    if (previous_.has_any() || !shapes_.is_convex(block) || !shapes_.is_convex(other)) {
      near.assign(corners.size(), true);
      return true;
    }
    near.resize(corners.size());
    const int first = system_.block(block).first_vertex;
    bool some = false;
    const Edge* parting = edges.data();  // the edge before which the last corner was too far
    for (std::size_t v = 0; v < corners.size(); ++v) {
      const Vec2& p = corners[v].start;
      near[v] = false;
      const double room = room_of_corners * reach_ + tolerance::seam_closures * closure(first + static_cast<int>(v));
      if (parting->gap(p) > room) continue;
      const auto edge = std::ranges::find_if(edges, [&](const Edge& e) { return e.gap(p) > room; });
      if (edge == edges.end()) {
        near[v] = true;
        some = true;
      } else {
        parting = &*edge;
      }
    }
    return some;
  }
  static bool has_near_end(const std::vector<char>& near, std::size_t edge) { return near[edge] || near[edge + 1 < near.size() ? edge + 1 : 0]; }

  void facing_edges(int block_a, int a, int block_b, int b, double weight) {
    const Edge &edge_a = shapes_.edge(a), &edge_b = shapes_.edge(b);
    // Along the bisector u edge b runs forward and edge a backward, so that the overlap is [max of starts, min of ends].
    const Vec2 u = (edge_b.direction - edge_a.direction).normalized();
    const int a_end = system_.next(a), b_end = system_.next(b);
    const auto along = [&](int v) { return u.dot(shapes_.edge(v).start - edge_b.start); };
    const double a_low = along(a_end), a_high = along(a);
    const double b_low = along(b), b_high = along(b_end);
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
    if (inside_is_reflex && beyond > tolerance::seam_height_m + tolerance::seam_closures * std::max(closure(va), closure(vb))) return;
    // The two corners take turns: a joint that has closed under one of them is closed for the other.
    const auto closed = [&] { return previous_.was_closed(va, b) || previous_.was_closed(vb, a); };
    if (a_is_inside != inside_is_reflex) {
      add(block_a, va, block_b, b, length, Rule::facing_edges, closed);
    } else {
      add(block_b, vb, block_a, a, length, Rule::facing_edges, closed);
    }
  }

  /// \param near  of the corners of the first block
  void lone_corners(int vertex_block, int edge_block, const std::vector<char>& near, const Box& room) {
    const std::span<const Edge> edges = shapes_.edges(edge_block);
    const int first = system_.block(vertex_block).first_vertex, first_edge = system_.block(edge_block).first_vertex;
    for (std::size_t k = 0; k < near.size(); ++k) {
      const int v = first + static_cast<int>(k);
      if (!near[k] || system_.is_reflex(v)) continue;
      const Vec2& p = shapes_.edge(v).start;
      if (!room.contains(p)) continue;
      const Sides sides = sides_of(v);
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const Edge& edge = edges[i];
        if (edge.gap(p) > reach_ || !sides.leave(edge, sine_flush)) continue;
        const int e = first_edge + static_cast<int>(i);
        const double along = edge.along(p);
        const double beyond = std::max(-along, along - edge.length);
        if (beyond > 0.0 && beyond > end_margin(v, edge) && !(beyond <= reach_ && ends_in_notch(v, e, along < 0.0))) continue;
        const double weight = sides.lone_weight(edge);
        if (weight == 0.0 || passes_over(vertex_block, v, edge_block, e)) continue;
        const Vec2 ahead = system_.arm(system_.next(v)) - system_.arm(v), back = system_.arm(system_.previous(v)) - system_.arm(v);
        const auto projection = [&](const Vec2& side) { return std::min(std::abs(side.dot(edge.direction)), edge.length); };
        add(vertex_block, v, edge_block, e, 0.5 * weight * (projection(ahead) + projection(back)), Rule::lone_corner,
            [&] { return previous_.was_closed(v, e); });
      }
    }
  }

  /// Directions from a corner along its two edges.
  struct Sides {
    Vec2 ahead, back;

    /// Both point out of the edge's half-plane, or into it by no more than the tilt, and the corner is not behind the edge.
    bool leave(const Edge& edge, double tilt) const {
      return edge.normal().dot(ahead) >= -tilt && edge.normal().dot(back) >= -tilt && !is_blunt_from_behind(edge);
    }
    /// A corner of nearly 180 deg has both its sides along the edge from behind, too, as where the tip of a thin wedge lies on it: what tells is
    /// where its block is.
    bool is_blunt_from_behind(const Edge& edge) const {
      const Vec2 inwards = perpendicular(ahead - back);
      return ahead.dot(back) < 0.0 && edge.normal().dot(inwards) < 0.0;
    }
    /// 1 - w_v of the header, of a corner that stands on the edge.
    double lone_weight(const Edge& edge) const {
      return 1.0 - std::max(parallel_weight(-ahead.dot(edge.direction)), parallel_weight(back.dot(edge.direction)));
    }
  };
  Sides sides_of(int v) const { return {shapes_.edge(v).direction, -shapes_.edge(system_.previous(v)).direction}; }

  /// \param closed  tells whether this place was in contact already
  template <class Closed>
  void add(int vertex_block, int v, int edge_block, int e, double length, Rule rule, const Closed& closed) {
    if (system_.is_reflex(v)) return;
    for (std::size_t i = first_; i < found_->size(); ++i) {
      Contact& known = (*found_)[i];
      if (known.vertex == v && known.edge == e) {
        known.length += length;
        return;
      }
    }
    const Edge& edge = shapes_.edge(e);
    const Vec2& p = shapes_.edge(v).start;
    const double gap = edge.gap(p);
    if (gap > reach_ || !outside(v, edge)) return;
    Contact contact;
    contact.vertex_block = vertex_block;
    contact.vertex = v;
    contact.edge_block = edge_block;
    contact.edge = e;
    contact.length = length;
    contact.gap = present_ ? present_gap(contact) : gap;
    if (gap < 0.0 && (!present_ || contact.gap < 0.0) && !entered_through(vertex_block, v, edge_block, e, gap, rule, closed)) return;
    found_->push_back(contact);
  }

  double present_gap(const Contact& contact) const {
    const ContactStart at(*present_, contact);
    return at.normal.dot(at.lever);
  }

  /// [m] What the contacts of a corner have closed.
  double closure(int v) const {
    double largest = 0.0;
    previous_.for_closed(v, [&](const Contact& c) { largest = std::max(largest, c.vertex == v ? -c.gap : 0.0); });
    return largest;
  }
  /// [m] The same with those on its two edges.
  double closure_around(int v) const {
    double largest = 0.0;
    previous_.for_closed(v, [&](const Contact& c) { largest = std::max(largest, -c.gap); });
    return largest;
  }
  /// [m] How far the closures of its contacts, those on its two edges included, have moved a corner along the normal of `edge`.
  double closure_across(int v, const Edge& edge) const {
    double largest = 0.0;
    previous_.for_closed(v, [&](const Contact& c) {
      const double cosine = edge.direction.dot(shapes_.edge(c.edge_block, c.edge).direction);
      largest = std::max(largest, -c.gap * std::abs(cosine));
    });
    return largest;
  }

  /// Whether a corner, or one of its two edges, is in contact with something parallel to `edge`.
  bool slides_along(int v, const Edge& edge) const {
    bool parallel = false;
    previous_.for_closed(v, [&](const Contact& c) { parallel |= !turns_away(shapes_.edge(c.edge_block, c.edge), edge); });
    return parallel;
  }

  /// Two corners that meet separate the blocks along any one of up to four edges, theirs at v and at the end of e: as long as one that turns away
  /// from e does, v does not run into e. Blocks that lie flush but for the closures of their contacts must not catch on the seams between them: a
  /// corner that slides on something keeps its way if what it slides on is lower than the seam's height. Where corners coincide and nothing has
  /// closed yet, the motion decides. An overlap no longer than a seam is high is no closed contact.
  bool passes_over(int vertex_block, int v, int edge_block, int e) const {
    const Edge& edge = shapes_.edge(edge_block, e);
    const Vec2& p = shapes_.edge(v).start;
    const bool near_start = edge.along(p) < 0.5 * edge.length;
    const int end = near_start ? e : system_.next(e);
    if (system_.is_reflex(end)) return false;
    const Vec2& q = shapes_.edge(end).start;
    const bool slides = previous_.closed(v) || previous_.closed(end);
    if (!slides && (p - q).norm() > tolerance::edge_end_m) return false;
    if (previous_.closed_length(v, e) > tolerance::seam_height_m) return false;
    const double gap = edge.gap(p);
    const bool in_front = gap > -tolerance::shortest_edge_m, in_notch = ends_in_notch(v, e, near_start);
    const bool coincide = (p - q).norm() <= tolerance::edge_end_m + tolerance::seam_closures * std::max(closure_around(v), closure_around(end));
    const auto separates = [&](int corner, const Vec2& position, int other_block, int line) {
      const Edge& other = shapes_.edge(other_block, line);
      if (!turns_away(edge, other) || !stands_on(corner, other) || has_come_off(corner, position, line, other)) return false;
      const bool slides_on_it = slides_along(v, other) || slides_along(end, other);
      const double step = in_front && slides_on_it ? tolerance::seam_height_m : tolerance::edge_end_m;
      const double closure = std::max(closure_across(v, other), closure_across(end, other)), height = step + tolerance::seam_closures * closure;
      const double other_gap = other.gap(position);
      // Two lines that nothing slides on must not pass the corner over to each other: of two tips that meet head-on, the wider gap keeps its contact.
      if (!slides_on_it && (in_notch || gap > height || !coincide) && other_gap <= gap) return false;
      return other_gap > -height;
    };
    return separates(v, p, edge_block, near_start ? system_.previous(e) : system_.next(e)) || separates(end, q, vertex_block, v) ||
           separates(end, q, vertex_block, system_.previous(v));
  }

  /// Whether a corner that an edge held has come off its end, while it is behind its line: nothing holds the blocks apart there any more.
  bool has_come_off(int corner, const Vec2& position, int e, const Edge& edge) const {
    return previous_.was_closed(corner, e) && edge.gap(position) < -tolerance::edge_end_m && !is_opposite(position, corner, edge);
  }

  /// Whether a corner that is at p lies between the ends of an edge, or beyond one by no more than end_margin().
  bool is_opposite(const Vec2& p, int v, const Edge& edge) const {
    const double along = edge.along(p);
    return std::max(-along, along - edge.length) <= end_margin(v, edge);
  }

  static bool turns_away(const Edge& a, const Edge& b) { return std::abs(a.direction.dot(b.direction)) < cosine_none; }

  /// [m] How far beyond an end of the edge a corner still counts as opposite to it: where the corner leans on something else there, a notch's other
  /// wall or another block, by what its contacts have closed.
  double end_margin(int v, const Edge& edge) const {
    bool leans = false;
    previous_.for_closed(v, [&](const Contact& c) { leans |= c.vertex == v && turns_away(shapes_.edge(c.edge_block, c.edge), edge); });
    return tolerance::edge_end_m + (leans ? tolerance::seam_closures * closure(v) : 0.0);
  }

  /// Whether a corner near the start or the end of an edge has a notch before it: that of the block, or one that the edge makes with what both the
  /// corner and this end slide on.
  bool ends_in_notch(int v, int e, bool at_start) const {
    const int end = at_start ? e : system_.next(e);
    if (system_.is_reflex(end)) return true;
    if (!previous_.closed(end)) return false;
    const Edge& edge = shapes_.edge(e);
    const Vec2 near_end = at_start ? edge.start : edge.end(), far_end = at_start ? edge.end() : edge.start;
    const double lift = tolerance::edge_end_m + tolerance::seam_closures * std::max(closure(v), closure(end));
    bool on_one_floor = false;
    previous_.for_closed(v, [&](const Contact& c) {
      const Edge& floor = shapes_.edge(c.edge_block, c.edge);
      on_one_floor |= c.vertex == v && turns_away(floor, edge) && floor.gap(near_end) <= lift && floor.gap(far_end) > lift;
    });
    return on_one_floor;
  }

  /// Both sides of the corner leave the edge's half-plane: only then can the corner touch the edge from outside. Overlaps of facing edges fade out
  /// until parallel_none.
  bool outside(int v, const Edge& edge) const { return sides_of(v).leave(edge, sine_none); }
  /// The same for a lone corner.
  bool stands_on(int v, const Edge& edge) const { return sides_of(v).leave(edge, sine_flush); }

  bool share_reflex_corner(int e, int f) const {
    return (system_.next(e) == f && system_.is_reflex(f)) || (system_.next(f) == e && system_.is_reflex(e));
  }

  /// A penetrating corner touches the edge it came in through: no other edge that it could touch is nearer, and its own block reaches the edge, as
  /// long as a nearer one is passed over because the corner could not touch it. What two blocks have in common is bounded by the edges of each that
  /// lie in the other one, so that a corner in it came in through none of the rest, such as the back of a notched block behind the face that it has
  /// gone through. Only in a notch does it touch both walls. History decides nothing here: beside a four-block corner a corner is first behind the
  /// joint's face, then, as it slides on, behind the right one.
  template <class Closed>
  bool entered_through(int vertex_block, int v, int edge_block, int e, double gap, Rule rule, const Closed& closed) {
    const Vec2& p = shapes_.edge(v).start;
    const Edge& edge = shapes_.edge(e);
    // What lies behind the edge must lie in the block, except for what contacts that carry load have closed, and in a drawing for what drawings leave
    // at the ends of two edges that face each other, which may lie beside the block's corner: that is not beyond a thin block.
    const bool faces_as_drawn = is_drawing_ && rule == Rule::facing_edges;
    const double beside = faces_as_drawn ? std::min(tolerance::deepest_initial_overlap_m, depth_behind(edge_block, edge)) : 0.0;
    if (-gap > beside && !in_block(edge_block, p) && !closed() && (is_drawing_ || !is_between_tips(vertex_block, v, e))) return false;
    const auto& block = system_.block(edge_block);
    for (int f = block.first_vertex; f < block.first_vertex + block.vertex_count; ++f) {
      const Edge& other = shapes_.edge(f);
      // An edge is no nearer than the line on which it lies.
      if (f == e || std::abs(other.gap(p)) > -gap || share_reflex_corner(e, f)) continue;
      if (distance_to_segment(p, other.start, other.end()) >= -gap - tolerance::shortest_edge_m) continue;
      // At a needle's tip, closed by a little, the edge that is faced need not be the nearest one.
      const bool at_needle = std::abs(edge.direction.dot(other.direction)) > cosine_needle;
      if (at_needle ? stands_on(v, other) : outside(v, other)) return false;
      if (!reaches(vertex_block, edge) && in_block(edge_block, p)) return false;
    }
    return true;
  }

  /// Whether a corner is behind an edge, though not in its block, because the tip at the edge's end is in the block of the tip that the corner is. Of
  /// the up to four lines that could separate two tips, see passes_over(), they touch along the one that they are least behind. Either the tip of the
  /// edge has come off the ends of the corner's two sides, which hold it no more, and did not come in through another one; or it has gone right
  /// through the other tip: both sides of one cross both sides of the other, and neither corner is in the other block.
  bool is_between_tips(int vertex_block, int v, int e) {
    const Edge& edge = shapes_.edge(e);
    const Vec2& p = shapes_.edge(v).start;
    const int end = edge.along(p) < 0.5 * edge.length ? e : system_.next(e);
    if (system_.is_reflex(end)) return false;
    const Vec2& q = shapes_.edge(end).start;
    const std::array<int, 2> sides{v, system_.previous(v)}, others{end, system_.previous(end)};
    const auto is_nearer = [&](int corner, const Vec2& position, int line) {
      const Edge& other = shapes_.edge(line);
      return outside(corner, other) && other.gap(position) > edge.gap(p);
    };
    if (std::ranges::any_of(sides, [&](int s) { return is_nearer(end, q, s); }) ||
        std::ranges::any_of(others, [&](int o) { return is_nearer(v, p, o); }))
      return false;
    if (in_block(vertex_block, q)) {
      return has_come_off_sides(end, q, v) && !is_nearer_to_another_edge(vertex_block, q, sides, -edge.gap(p));
    }
    return std::ranges::all_of(
        sides, [&](int s) { return std::ranges::all_of(others, [&](int o) { return cross_each_other(shapes_.edge(s), shapes_.edge(o)); }); });
  }
  /// Whether a block has an edge, other than two of its sides, that a point in it is nearer to than a depth. Whether the point's corner could stand
  /// on that edge does not matter: with a block that is deep in another one, corners come in that lead nowhere.
  bool is_nearer_to_another_edge(int b, const Vec2& q, const std::array<int, 2>& sides, double depth) const {
    const auto& block = system_.block(b);
    for (int s = block.first_vertex; s < block.first_vertex + block.vertex_count; ++s) {
      const Edge& other = shapes_.edge(s);
      if (s != sides[0] && s != sides[1] && distance_to_segment(q, other.start, other.end()) < depth) return true;
    }
    return false;
  }
  /// Whether a tip q has come off the sides of corner v on which it stands, past v.
  bool has_come_off_sides(int q, const Vec2& position, int v) const {
    bool is_past = false;
    for (const int s : {v, system_.previous(v)}) {
      const Edge& side = shapes_.edge(s);
      if (!stands_on(q, side)) continue;
      const double along = side.along(position), past = s == v ? -along : along - side.length;
      if (past <= end_margin(q, side)) return false;
      is_past = true;
    }
    return is_past;
  }
  static bool cross_each_other(const Edge& a, const Edge& b) {
    return (a.gap(b.start) < 0.0) != (a.gap(b.end()) < 0.0) && (b.gap(a.start) < 0.0) != (b.gap(a.end()) < 0.0);
  }

  /// Whether a part of an edge lies in a block.
  bool reaches(int block, const Edge& edge) {
    for (const Edge& side : shapes_.edges(block)) {
      const double start = side.gap(edge.start), end = side.gap(edge.end()), side_start = edge.gap(side.start), side_end = edge.gap(side.end());
      if ((start < 0.0) != (end < 0.0) && (side_start < 0.0) != (side_end < 0.0)) return true;
    }
    polygon_.clear();
    for (const Edge& side : shapes_.edges(block)) polygon_.push_back(side.start);
    return contains(polygon_, edge.start);
  }

  /// [m] of a block behind one of its edges.
  double depth_behind(int block, const Edge& edge) const {
    double depth = 0.0;
    for (const Edge& corner : shapes_.edges(block)) depth = std::max(depth, -edge.gap(corner.start));
    return depth;
  }

  bool in_block(int block, const Vec2& p) {
    constexpr double margin = 2.0 * tolerance::edge_end_m;  // what is decided so is the same by the distance below
    if (!shapes_.box(block).inflated(margin).contains(p)) return false;
    if (shapes_.is_convex(block)) {
      double farthest = -std::numeric_limits<double>::infinity();  // before an edge
      for (const Edge& edge : shapes_.edges(block)) farthest = std::max(farthest, edge.gap(p));
      if (farthest > margin) return false;
      if (farthest <= 0.0) return true;
    }
    polygon_.clear();
    for (const Edge& edge : shapes_.edges(block)) polygon_.push_back(edge.start);
    return contains(polygon_, p) || distance_to_boundary(polygon_, p) <= tolerance::edge_end_m;
  }

  /// How far two edges may count as facing each other; see above.
  static double parallel_weight(double cosine) {
    if (cosine >= cosine_full) return 1.0;
    if (cosine <= cosine_none) return 0.0;
    return (tolerance::parallel_none_rad - std::acos(cosine)) / (tolerance::parallel_none_rad - tolerance::parallel_full_rad);
  }

  static constexpr double room_of_corners = 1.5;  ///< [-] over the reach
  static inline const double cosine_full = std::cos(tolerance::parallel_full_rad);
  static inline const double cosine_none = std::cos(tolerance::parallel_none_rad), sine_none = std::sin(tolerance::parallel_none_rad);
  static inline const double cosine_needle = std::cos(2.0 * tolerance::parallel_none_rad);
  static inline const double sine_flush = std::sin(tolerance::flush_tilt_rad);

  const BlockSystem& system_;
  const BlockSystem* present_;
  double reach_;
  bool is_drawing_;
  BlockShapes& shapes_;
  const ContactIndex& previous_;
  std::vector<Contact>* found_ = nullptr;
  std::size_t first_ = 0;
  std::vector<char> near_[2];  ///< of the corners of both blocks
  Polygon polygon_;
};

}  // namespace openclose
