// How a corner of one block meets an edge of another one near corners: what it passes over, and what it came in through.
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
// Two tips that meet in a point, with the tip of a third block between the edges that go out from there, touch along none of these edges: each is
// held from that block. Where joints cross at less than parallel_none the edges face each other over it, and a contact of the two tips, with the
// normal of one of the two joints, would hold what slides on the other. So do the outer edges of two wedges side by side, which turn their backs to
// each other.
//
// In front of a notch a corner faces both walls from wherever it may reach them, also where it lies beyond the end of one: what is in front of both
// is in front of the whole line of either, and a corner that slides down one wall into the notch is to meet the other one there. Two feet that slide
// towards each other on one floor meet in such a notch.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "openclose/contact/block_shapes.h"
#include "openclose/contact/contact_index.h"
#include "openclose/contact/ground_outline.h"
#include "openclose/contact/neighbours.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"

namespace openclose {

/// By which a corner has found an edge.
enum class ContactRule { facing_edges, lone_corner };

/// What shapes and the contacts of before say of corners and edges of two blocks.
class CornerMeetings {
 public:
  using Edge = BlockShapes::Edge;

  /// \param is_drawing  the blocks are where they were drawn
  CornerMeetings(const BlockSystem& system, bool is_drawing, BlockShapes& shapes, const ContactIndex& previous, const Neighbours& neighbours,
                 const GroundOutline& ground)
      : system_(system), is_drawing_(is_drawing), shapes_(shapes), previous_(previous), neighbours_(neighbours), ground_(ground) {}

  static inline const double cosine_none = std::cos(tolerance::parallel_none_rad), sine_flush = std::sin(tolerance::flush_tilt_rad);

  /// Directions from a corner along its two edges.
  struct Sides {
    Vec2 ahead, back;

    /// Both point out of the edge's half-plane, or into it by no more than the tilt, and the corner is not behind the edge.
    bool leave(const Edge& edge, double tilt) const {
      return edge.normal().dot(ahead) >= -tilt && edge.normal().dot(back) >= -tilt && !is_blunt_from_behind(edge);
    }
    /// Whether a direction from a corner that is not reflex goes into its block, or along one of its sides.
    bool enclose(const Vec2& direction) const {
      return cross(ahead, direction) >= -tolerance::straight_corner_rad && cross(direction, back) >= -tolerance::straight_corner_rad;
    }
    /// A corner of nearly 180 deg has both its sides along the edge from behind, too, as where the tip of a thin wedge lies on it: what tells is
    /// where its block is.
    bool is_blunt_from_behind(const Edge& edge) const {
      const Vec2 inwards = perpendicular(ahead - back);
      return ahead.dot(back) < 0.0 && edge.normal().dot(inwards) < 0.0;
    }
    /// 1 - w_v of narrow_phase.h, of a corner that stands on the edge.
    double lone_weight(const Edge& edge) const {
      return 1.0 - std::max(parallel_weight(-ahead.dot(edge.direction)), parallel_weight(back.dot(edge.direction)));
    }
  };
  Sides sides_of(int v) const {
    if (const GroundOutline::Corner* corner = ground_.corner(v)) return {corner->ahead.span.normalized(), corner->back.span.normalized()};
    return {shapes_.edge(v).direction, -shapes_.edge(system_.previous(v)).direction};
  }
  /// Whether a vertex sticks out, of its block or of the ground.
  bool is_corner(int v) const {
    const GroundOutline::Corner* corner = ground_.corner(v);
    return corner ? corner->kind == GroundOutline::Kind::corner : !system_.is_reflex(v);
  }
  /// Whether a vertex is where two walls of its block, or of the ground, make a notch.
  bool is_notch(int v) const {
    const GroundOutline::Corner* corner = ground_.corner(v);
    return corner ? corner->kind == GroundOutline::Kind::notch : system_.is_reflex(v);
  }
  /// Whether an edge is inside the ground where it is nearest to a point.
  bool is_inside_ground(const Edge& edge, int e, const Vec2& p, double margin) const {
    return ground_.covers(e, std::clamp(edge.along(p), 0.0, edge.length), margin);
  }

  /// [m] What the contacts of a corner have closed.
  double closure(int v) const {
    double largest = 0.0;
    previous_.for_closed(v, [&](const Contact& c) { largest = std::max(largest, c.vertex == v ? -c.gap : 0.0); });
    return largest;
  }

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
    if (is_notch(end)) return true;
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

  /// Two corners that meet separate the blocks along any one of up to four edges, theirs at v and at the end of e: as long as one that turns away
  /// from e does, v does not run into e. Blocks that lie flush but for the closures of their contacts must not catch on the seams between them: a
  /// corner that slides on something keeps its way if what it slides on is lower than the seam's height. Where corners coincide and nothing has
  /// closed yet, the motion decides. An overlap no longer than a seam is high is no closed contact.
  bool passes_over(int vertex_block, int v, int edge_block, int e) const {
    const Edge& edge = shapes_.edge(edge_block, e);
    const Vec2& p = shapes_.edge(v).start;
    const bool near_start = edge.along(p) < 0.5 * edge.length;
    const int end = near_start ? e : system_.next(e);
    if (!is_corner(end)) return false;
    const Vec2& q = shapes_.edge(end).start;
    const bool slides = previous_.closed(v) || previous_.closed(end);
    if (!slides && (p - q).norm() > tolerance::edge_end_m) return false;
    if (previous_.closed_length(v, e) > tolerance::seam_height_m) return false;
    const double gap = edge.gap(p);
    const bool in_front = gap > -tolerance::shortest_edge_m, in_notch = ends_in_notch(v, e, near_start);
    const bool coincide = (p - q).norm() <= tolerance::edge_end_m + tolerance::seam_closures * std::max(closure_around(v), closure_around(end));
    const auto separates = [&](int corner, const Vec2& position, int line_block, int line) {
      const Edge& other = shapes_.edge(line_block, line);
      if (!turns_away(edge, other) || !stands_on(corner, other) || has_come_off(corner, position, line, other)) return false;
      const bool slides_on_it = slides_along(v, other) || slides_along(end, other);
      const double step = in_front && slides_on_it ? tolerance::seam_height_m : tolerance::edge_end_m;
      const double closure = std::max(closure_across(v, other), closure_across(end, other)), height = step + tolerance::seam_closures * closure;
      const double other_gap = other.gap(position);
      // Two lines that nothing slides on must not pass the corner over to each other: of two tips that meet head-on, the wider gap keeps its contact.
      if (!slides_on_it && (in_notch || gap > height || !coincide) && other_gap <= gap) return false;
      return other_gap > -height;
    };
    const auto [other_block, other] = other_side(edge_block, end, e);
    return separates(v, p, other_block, other) ||
           std::ranges::any_of(sides(vertex_block, v), [&](const BlockEdge& side) { return separates(end, q, side.first, side.second); });
  }

  /// Whether two corners coincide and rock fills what is between two edges that go out from there, in this direction: that of a third block, or, of
  /// edges that turn their backs to each other as those of two wedges side by side do, that of the blocks themselves.
  /// \param spread  [m] by which the edges part as far as they overlap
  bool meet_in_a_point(int block_a, int va, int block_b, int vb, const Vec2& direction, double spread) const {
    if (spread <= tolerance::edge_end_m) return false;
    const Vec2& p = shapes_.edge(va).start;
    const double room = room_at(std::max(closure(va), closure(vb)));
    if ((shapes_.edge(vb).start - p).squaredNorm() > room * room) return false;
    if (!is_closure(spread) && (sides_of(va).enclose(direction) || sides_of(vb).enclose(direction))) return true;
    return is_third_block_between(block_a, block_b, p, room, direction);
  }

  /// The same of a corner that touches another block's edge away from its ends: whether a third block fills what is between.
  bool is_over_third_block(int vertex_block, int v, int edge_block, const Edge& edge, const Vec2& direction, double spread) const {
    const Vec2& p = shapes_.edge(v).start;
    const double room = room_at(closure(v));
    return !is_closure(spread) && std::abs(edge.gap(p)) <= room && is_third_block_between(vertex_block, edge_block, p, room, direction);
  }

  /// A penetrating corner touches the edge it came in through: no other edge that it could touch is nearer, and its own block reaches the edge, as
  /// long as a nearer one is passed over because the corner could not touch it. What two blocks have in common is bounded by the edges of each that
  /// lie in the other one, so that a corner in it came in through none of the rest, such as the back of a notched block behind the face that it has
  /// gone through. Only in a notch does it touch both walls. History decides nothing here: beside a four-block corner a corner is first behind the
  /// joint's face, then, as it slides on, behind the right one.
  template <class Closed>
  bool entered_through(int vertex_block, int v, int edge_block, int e, double gap, ContactRule rule, const Closed& closed) {
    const Vec2& p = shapes_.edge(v).start;
    const Edge& edge = shapes_.edge(e);
    // What lies behind the edge must lie in the block, except for what contacts that carry load have closed, and in a drawing for what drawings leave
    // at the ends of two edges that face each other, which may lie beside the block's corner: that is not beyond a thin block.
    const bool faces_as_drawn = is_drawing_ && rule == ContactRule::facing_edges;
    const double beside = faces_as_drawn ? std::min(tolerance::deepest_initial_overlap_m, depth_behind(edge_block, edge)) : 0.0;
    if (-gap > beside && !in_block(edge_block, p) && !closed() && (is_drawing_ || !is_between_tips(vertex_block, v, edge_block, e))) return false;
    const auto is_nearer = [&](int f) {
      const Edge& other = shapes_.edge(f);
      // An edge is no nearer than the line on which it lies.
      if (f == e || std::abs(other.gap(p)) > -gap || share_notch(e, f) || is_inside_ground(other, f, p, 0.0)) return false;
      if (distance_to_segment(p, other.start, other.end()) >= -gap - tolerance::shortest_edge_m) return false;
      // At a needle's tip, closed by a little, the edge that is faced need not be the nearest one.
      const bool at_needle = std::abs(edge.direction.dot(other.direction)) > cosine_needle;
      if (at_needle ? stands_on(v, other) : outside(v, other)) return true;
      return !reaches(vertex_block, edge) && in_block(edge_block, p);
    };
    return !any_edge_around(edge_block, p, -gap, is_nearer);
  }

  /// w of narrow_phase.h: how far two edges may count as facing each other.
  static double parallel_weight(double cosine) {
    if (cosine >= cosine_full) return 1.0;
    if (cosine <= cosine_none) return 0.0;
    return (tolerance::parallel_none_rad - std::acos(cosine)) / (tolerance::parallel_none_rad - tolerance::parallel_full_rad);
  }

 private:
  /// [m] How far corners that coincide in the drawing may be from each other where their contacts have closed by this.
  static double room_at(double closure) { return tolerance::edge_end_m + tolerance::seam_closures * closure; }
  /// Whether edges part by no more than blocks that have closed are in each other.
  bool is_closure(double spread) const { return spread <= tolerance::seam_height_m + tolerance::seam_closures * previous_.deepest(); }

  bool is_third_block_between(int block_a, int block_b, const Vec2& p, double room, const Vec2& direction) const {
    const auto is_between = [&](int block) {
      if (block == block_a || block == block_b) return false;
      const int first = system_.block(block).first_vertex;
      for (int r = first; r < first + system_.block(block).vertex_count; ++r) {
        if ((shapes_.edge(block, r).start - p).squaredNorm() <= room * room && sides_of(r).enclose(direction)) return true;
      }
      return false;
    };
    return neighbours_.any_of(block_a, is_between) || neighbours_.any_of(block_b, is_between);
  }

  using BlockEdge = GroundOutline::BlockEdge;
  std::array<BlockEdge, 2> sides(int block, int v) const { return {ground_.edge_ahead(block, v), ground_.edge_back(system_, block, v)}; }
  /// The edge beside e at one of its ends.
  BlockEdge other_side(int block, int end, int e) const {
    const auto [ahead, back] = sides(block, end);
    return ahead.second == e ? back : ahead;
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

  /// Whether two edges are the walls of a notch of a block, or of the ground.
  bool share_notch(int e, int f) const {
    if ((system_.next(e) == f && is_notch(f)) || (system_.next(f) == e && is_notch(e))) return true;
    return std::ranges::any_of(std::array<int, 4>{e, system_.next(e), f, system_.next(f)}, [&](int v) {
      const GroundOutline::Corner* corner = ground_.corner(v);
      return corner && corner->kind == GroundOutline::Kind::notch && std::minmax(corner->ahead.edge, corner->back.edge) == std::minmax(e, f);
    });
  }

  /// Asks of the edges of a block until one of them is; of the ground all those that may be within `room` [m] of a point.
  template <class F>
  bool any_edge_around(int block, const Vec2& p, double room, F f) {
    pieces_.assign(1, block);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const auto& piece = system_.block(pieces_[i]);
      for (int e = piece.first_vertex; e < piece.first_vertex + piece.vertex_count; ++e) {
        if (f(e)) return true;
      }
      for (const int other : ground_.beside(pieces_[i])) {
        if (std::ranges::find(pieces_, other) == pieces_.end() && shapes_.box(other).inflated(room).contains(p)) pieces_.push_back(other);
      }
    }
    return false;
  }

  /// Whether a corner is behind an edge, though not in its block, because the tip at the edge's end is in the block of the tip that the corner is. Of
  /// the up to four lines that could separate two tips, see passes_over(), they touch along the one that they are least behind. Either the tip of the
  /// edge has come off the ends of the corner's two sides, which hold it no more, and did not come in through another one; or it has gone right
  /// through the other tip: both sides of one cross both sides of the other, and neither corner is in the other block.
  bool is_between_tips(int vertex_block, int v, int edge_block, int e) {
    const Edge& edge = shapes_.edge(e);
    const Vec2& p = shapes_.edge(v).start;
    const int end = edge.along(p) < 0.5 * edge.length ? e : system_.next(e);
    if (!is_corner(end)) return false;
    const Vec2& q = shapes_.edge(end).start;
    const std::array<BlockEdge, 2> own = sides(vertex_block, v), others = sides(edge_block, end);
    const auto is_nearer = [&](int corner, const Vec2& position, const BlockEdge& line) {
      const Edge& other = shapes_.edge(line.first, line.second);
      return outside(corner, other) && other.gap(position) > edge.gap(p);
    };
    if (std::ranges::any_of(own, [&](const BlockEdge& s) { return is_nearer(end, q, s); }) ||
        std::ranges::any_of(others, [&](const BlockEdge& o) { return is_nearer(v, p, o); }))
      return false;
    if (in_block(vertex_block, q)) {
      return has_come_off_sides(end, q, v) && !is_nearer_to_another_edge(vertex_block, q, own, -edge.gap(p));
    }
    return std::ranges::all_of(own, [&](const BlockEdge& s) {
      return std::ranges::all_of(others, [&](const BlockEdge& o) { return cross_each_other(shapes_.edge(s.second), shapes_.edge(o.second)); });
    });
  }

  /// Whether a block has an edge, other than two of its sides, that a point in it is nearer to than a depth. Whether the point's corner could stand
  /// on that edge does not matter: with a block that is deep in another one, corners come in that lead nowhere.
  bool is_nearer_to_another_edge(int block, const Vec2& q, const std::array<BlockEdge, 2>& sides, double depth) {
    return any_edge_around(block, q, depth, [&](int s) {
      const Edge& other = shapes_.edge(s);
      return s != sides[0].second && s != sides[1].second && !is_inside_ground(other, s, q, 0.0) &&
             distance_to_segment(q, other.start, other.end()) < depth;
    });
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

  /// In a block, or in the ground of which it is a part.
  bool in_block(int block, const Vec2& p) {
    return is_in(block, p) || std::ranges::any_of(ground_.beside(block), [&](int other) { return is_in(other, p); });
  }

  bool is_in(int block, const Vec2& p) {
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

  static inline const double cosine_full = std::cos(tolerance::parallel_full_rad), sine_none = std::sin(tolerance::parallel_none_rad);
  static inline const double cosine_needle = std::cos(2.0 * tolerance::parallel_none_rad);

  const BlockSystem& system_;
  bool is_drawing_;
  BlockShapes& shapes_;
  const ContactIndex& previous_;
  const Neighbours& neighbours_;
  const GroundOutline& ground_;
  Polygon polygon_;
  std::vector<int> pieces_;  ///< of the ground
};

}  // namespace openclose
