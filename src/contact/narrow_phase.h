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
// Corners that meet corners have rules of their own: corner_meetings.h.
//
// Where it is not continuous: a lone corner within edge_end of the seam of two free blocks' collinear edges has a contact with both; it loses its
// length where it leaves the end of an edge that nothing continues; and at a corner the contact passes from one edge to the next with its gap, not
// with its direction. What becomes of the energy held there stands in history.h: it never grows.
//
// At four-block corners the diagonal blocks have facing edges without overlap and no lone corner, hence no contact: they cannot lock. Where the
// joints cross at less than parallel_none, the blocks above and below both face each other over one of the others, which keeps their contact out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "openclose/contact/block_shapes.h"
#include "openclose/contact/contact_index.h"
#include "openclose/contact/corner_meetings.h"
#include "openclose/contact/ground_outline.h"
#include "openclose/contact/kinematics.h"
#include "openclose/core/tolerance.h"

namespace openclose {

/// Between the blocks of one pair. Collects contacts; a vertex-edge pair found twice gets the sum of the lengths.
class NarrowPhase {
 public:
  using Edge = BlockShapes::Edge;

  /// \param is_drawing  the blocks are where they were drawn
  NarrowPhase(const BlockSystem& system, const BlockSystem* present, double reach, bool is_drawing, BlockShapes& shapes, const ContactIndex& previous,
              const Neighbours& neighbours, const GroundOutline& ground)
      : system_(system),
        present_(present),
        reach_(reach),
        shapes_(shapes),
        previous_(previous),
        meetings_(system, is_drawing, shapes, previous, neighbours, ground),
        ground_(ground) {}

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
        if (cosine <= CornerMeetings::cosine_none || !(a_is_near || has_near_end(near_[1], b))) continue;
        facing_edges(block_a, first_a + static_cast<int>(a), block_b, first_b + static_cast<int>(b), CornerMeetings::parallel_weight(cosine));
      }
    }
    lone_corners(block_a, block_b, near_[0], room);
    lone_corners(block_b, block_a, near_[1], room);
  }

  /// [m] By how much the blocks of a contact that was found may move before its corner comes off an end of its edge, where another contact takes its
  /// place: beyond the end the line along the edge, from which the gap is measured, holds nothing. Infinite of a corner that is beyond the end now,
  /// in front of a notch.
  double room_before_end(const Contact& contact) const {
    const Edge& edge = shapes_.edge(contact.edge);
    const double along = edge.along(shapes_.edge(contact.vertex).start);
    const double inside = std::min(along, edge.length - along) + meetings_.end_margin(contact.vertex, edge);
    return inside < 0.0 ? std::numeric_limits<double>::infinity() : std::max(inside, tolerance::edge_end_m);
  }

 private:
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
      const double room = room_of_corners * reach_ + tolerance::seam_closures * meetings_.closure(first + static_cast<int>(v));
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
    const auto [before_a, after_a] = ground_.straight_on(a);
    const auto [before_b, after_b] = ground_.straight_on(b);
    const double a_low = along(a_end) - after_a, a_high = along(a) + before_a;
    const double b_low = along(b) - before_b, b_high = along(b_end) + after_b;
    const double overlap = std::min(a_high, b_high) - std::max(a_low, b_low);
    if (overlap < tolerance::shortest_overlap_m) return;
    const FacingEdges facing{block_a, a, block_b, b, overlap, 0.5 * weight * overlap, std::abs(cross(edge_a.direction, edge_b.direction))};
    const bool a_is_low = a_low >= b_low, a_is_high = a_high <= b_high, pass_by = a_is_low != a_is_high;
    add_end(facing, a_end, b, a_is_low, std::abs(a_low - b_low), pass_by, u);
    add_end(facing, a, b_end, a_is_high, std::abs(a_high - b_high), pass_by, -u);
  }

  struct FacingEdges {
    int block_a, a, block_b, b;
    double overlap, length;  ///< [m] the latter at each end
    double sine;             ///< of the angle between them
  };

  /// One end of an overlap: vertex va of edge a on edge b, or vertex vb of edge b on edge a; `beyond` [m] is how far the other one lies outside the
  /// overlap. A reflex vertex has material all around and touches nothing: the other block's vertex stands in, if it leans into that notch's wall and
  /// is not far off.
  /// \param pass_by  whether the overlap lies between an end of the one and an end of the other
  /// \param inwards  direction of the overlap from here
  void add_end(const FacingEdges& facing, int va, int vb, bool a_is_inside, double beyond, bool pass_by, const Vec2& inwards) {
    const auto& [block_a, a, block_b, b, overlap, length, sine] = facing;
    const bool inside_is_reflex = meetings_.is_notch(a_is_inside ? va : vb);
    if (inside_is_reflex && beyond > tolerance::seam_height_m + tolerance::seam_closures * std::max(meetings_.closure(va), meetings_.closure(vb)))
      return;
    const bool is_vertex_of_a = a_is_inside != inside_is_reflex;
    const int vertex_block = is_vertex_of_a ? block_a : block_b, v = is_vertex_of_a ? va : vb;
    const int edge_block = is_vertex_of_a ? block_b : block_a, e = is_vertex_of_a ? b : a;
    if (is_inside_ground(a, v) || is_inside_ground(b, v) || goes_on(is_vertex_of_a ? a : b, v) || !ground_.is_in_front(e, shapes_.edge(v).start))
      return;
    // Edges that are not parallel seem to overlap by a part of what is between them; when they come together they pass each other by their ends.
    const auto apart = [&] { return std::max(0.0, shapes_.edge(e).gap(shapes_.edge(v).start)); };
    if (pass_by && overlap <= tolerance::seam_height_m + sine * apart() && meetings_.passes_over(vertex_block, v, edge_block, e)) return;
    if (!goes_on(a, va) && !goes_on(b, vb) && meetings_.meet_in_a_point(block_a, va, block_b, vb, inwards, sine * overlap)) return;
    if (meetings_.is_over_third_block(vertex_block, v, edge_block, shapes_.edge(e), inwards, sine * overlap)) return;
    // The two corners take turns: a joint that has closed under one of them is closed for the other.
    add(vertex_block, v, edge_block, e, length, ContactRule::facing_edges,
        [&, a = facing.a, b = facing.b] { return previous_.was_closed(va, b) || previous_.was_closed(vb, a); });
  }

  /// \param near  of the corners of the first block
  void lone_corners(int vertex_block, int edge_block, const std::vector<char>& near, const Box& room) {
    const std::span<const Edge> edges = shapes_.edges(edge_block);
    const int first = system_.block(vertex_block).first_vertex, first_edge = system_.block(edge_block).first_vertex;
    for (std::size_t k = 0; k < near.size(); ++k) {
      const int v = first + static_cast<int>(k);
      if (!near[k] || !sticks_out(v)) continue;
      const Vec2& p = shapes_.edge(v).start;
      if (!room.contains(p)) continue;
      const CornerMeetings::Sides sides = meetings_.sides_of(v);
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const Edge& edge = edges[i];
        if (edge.gap(p) > reach_ || !sides.leave(edge, CornerMeetings::sine_flush)) continue;
        const int e = first_edge + static_cast<int>(i);
        const double along = edge.along(p);
        const double beyond = std::max(-along, along - edge.length);
        if (is_inside_ground(e, v) || !ground_.is_in_front(e, p)) continue;
        if (beyond > 0.0 && beyond > meetings_.end_margin(v, edge) && !(beyond <= reach_ && meetings_.ends_in_notch(v, e, along < 0.0))) continue;
        const double weight = sides.lone_weight(edge);
        if (weight == 0.0 || meetings_.passes_over(vertex_block, v, edge_block, e)) continue;
        if (weight < 1.0 && is_over_another_block(vertex_block, v, edge_block, e)) continue;
        const auto [ahead, back] = ground_.spans(system_, v);
        const auto projection = [&](const Vec2& side) { return std::min(std::abs(side.dot(edge.direction)), line_length(e)); };
        add(vertex_block, v, edge_block, e, 0.5 * weight * (projection(ahead) + projection(back)), ContactRule::lone_corner,
            [&] { return previous_.was_closed(v, e); });
      }
    }
  }

  /// Whether a vertex is a corner that may stand alone, of its block or of the ground: of this only the first of the vertices that make it together.
  bool sticks_out(int v) const {
    const GroundOutline::Corner* corner = ground_.corner(v);
    return meetings_.is_corner(v) && (!corner || corner->first == v);
  }
  /// Whether the straight line of which an edge is a part goes on at this vertex of it.
  bool goes_on(int e, int v) const {
    const auto [before, after] = ground_.straight_on(e);
    return v == e ? before > 0.0 : after > 0.0;
  }
  double line_length(int e) const {
    const auto [before, after] = ground_.straight_on(e);
    return before + shapes_.edge(e).length + after;
  }
  /// Whether a corner is at a part of an edge of the ground that is inside of it. Where the outline makes a notch with this edge, a corner that leans
  /// on the other wall may be behind that.
  bool is_inside_ground(int e, int v) const {
    const Edge& edge = shapes_.edge(e);
    return meetings_.is_inside_ground(edge, e, shapes_.edge(v).start, meetings_.end_margin(v, edge));
  }

  /// Whether a corner comes near to facing an edge with another block between the edge and its side.
  bool is_over_another_block(int vertex_block, int v, int edge_block, int e) const {
    const Edge& edge = shapes_.edge(e);
    const CornerMeetings::Sides sides = meetings_.sides_of(v);
    const bool near_start = edge.along(shapes_.edge(v).start) < 0.5 * edge.length;
    const int end = near_start ? e : system_.next(e);
    const auto towards = [&](const Vec2& inwards) -> const Vec2& {
      return sides.ahead.dot(inwards) > sides.back.dot(inwards) ? sides.ahead : sides.back;
    };
    const auto bisector = [](const Vec2& inwards, const Vec2& side) -> Vec2 { return (inwards + side).normalized(); };
    const auto spread = [&](const Vec2& side) { return std::abs(cross(edge.direction, side)) * line_length(e); };
    const Vec2 from_end = near_start ? edge.direction : Vec2(-edge.direction), side = towards(from_end);
    if (!goes_on(e, end) && meetings_.meet_in_a_point(vertex_block, v, edge_block, end, bisector(from_end, side), spread(side))) return true;
    return std::ranges::any_of(std::array<Vec2, 2>{edge.direction, -edge.direction}, [&](const Vec2& way) {
      const Vec2& faced = towards(way);
      return faced.dot(way) > CornerMeetings::cosine_none &&
             meetings_.is_over_third_block(vertex_block, v, edge_block, edge, bisector(way, faced), spread(faced));
    });
  }

  /// \param closed  tells whether this place was in contact already
  template <class Closed>
  void add(int vertex_block, int v, int edge_block, int e, double length, ContactRule rule, const Closed& closed) {
    if (meetings_.is_notch(v)) return;
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
    if (gap > reach_ || !meetings_.outside(v, edge)) return;
    Contact contact;
    contact.vertex_block = vertex_block;
    contact.vertex = v;
    contact.edge_block = edge_block;
    contact.edge = e;
    contact.length = length;
    contact.gap = present_ ? present_gap(contact) : gap;
    if (gap < 0.0 && (!present_ || contact.gap < 0.0) && !meetings_.entered_through(vertex_block, v, edge_block, e, gap, rule, closed)) return;
    found_->push_back(contact);
  }

  double present_gap(const Contact& contact) const {
    const ContactStart at(*present_, contact);
    return at.normal.dot(at.lever);
  }
  static constexpr double room_of_corners = 1.5;  ///< [-] over the reach

  const BlockSystem& system_;
  const BlockSystem* present_;
  double reach_;
  BlockShapes& shapes_;
  const ContactIndex& previous_;
  CornerMeetings meetings_;
  const GroundOutline& ground_;
  std::vector<Contact>* found_ = nullptr;
  std::size_t first_ = 0;
  std::vector<char> near_[2];  ///< of the corners of both blocks
};

}  // namespace openclose
