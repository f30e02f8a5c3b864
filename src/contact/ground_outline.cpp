#include "openclose/contact/ground_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "openclose/contact/block_shapes.h"
#include "openclose/contact/near_blocks.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"

namespace openclose {
namespace {

using Edge = BlockShapes::Edge;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// [m] Two fixed edges lie against each other if they are no farther apart: a corner over the slit is within edge_end of one of its sides.
constexpr double widest_slit = 2.0 * tolerance::edge_end_m;

/// Edges that lie against each other are parallel but for the rounding of coordinates, which turns the shortest ones most.
const double cosine_flush = std::cos(tolerance::parallel_full_rad);

/// [m] and [-] of the length along which two edges lie against each other: this far beyond the slit in front of the middle of it there is the other
/// block, at the smaller of the two. Near a sharp tip an edge also runs along the back of a block, which is no more than a slit away.
constexpr double probe_depth = 0.1 * tolerance::thinnest_block_m, probe_of_length = 0.002;

/// [rad] from one direction to the other, counter-clockwise.
double angle_between(const Vec2& from, const Vec2& to) {
  const double angle = std::atan2(cross(from, to), from.dot(to));
  return angle < 0.0 ? angle + 2.0 * std::numbers::pi : angle;
}

GroundOutline::Kind kind_of(double angle) {
  using enum GroundOutline::Kind;
  if (angle >= 2.0 * std::numbers::pi - tolerance::flush_tilt_rad) return inside;
  if (angle > std::numbers::pi + tolerance::flush_tilt_rad) return notch;
  return angle < std::numbers::pi - tolerance::flush_tilt_rad ? corner : straight;
}

/// [m] Of a point, from the start of an edge.
double along_edge(const BlockSystem& system, const GroundOutline::BlockEdge& edge, const Vec2& point) {
  const auto [block, e] = edge;
  return (system.arm(system.next(e)) - system.arm(e)).normalized().dot(point - system.position(block, e));
}

Polygon polygon_of(std::span<const Edge> edges) {
  Polygon polygon;
  for (const Edge& edge : edges) polygon.push_back(edge.start);
  return polygon;
}

}  // namespace

/// Finds what lies against what, then goes around each vertex from block to block.
class GroundOutline::Survey {
 public:
  Survey(const BlockSystem& system, GroundOutline& outline) : system_(system), outline_(outline) { shapes_.begin(system); }

  void run() {
    for (int b = 0; b < system_.block_count(); ++b) boxes_.push_back(shapes_.box(b).inflated(widest_slit));
    outline_.body_.resize(system_.block_count());
    std::iota(outline_.body_.begin(), outline_.body_.end(), 0);
    for (const auto& [a, b] : near_blocks(system_, boxes_, shapes_, widest_slit, PairsOf::fixed_blocks)) find_covers(a, b);
    if (covers_.empty()) return;
    outline_.is_marked_.assign(system_.state().arm.size(), false);
    outline_.has_seam_.assign(system_.block_count(), false);
    for (int b = 0; b < system_.block_count(); ++b) {
      if (system_.block(b).equation != BlockSystem::fixed) continue;
      for_vertices(b, [&](int v) {
        unite_covers(v);
        find_corner(b, v);
      });
    }
    measure_lines();
  }

 private:
  /// A part of an edge, and the edge that lies against it.
  struct Cover {
    double from, to;  ///< [m] along the edge
    double across;    ///< [m] from one to the other, or by which they overlap
    int block, edge;
  };
  /// A place on an edge, from which the outline goes on along it or up to which it has come.
  struct Place {
    int block, edge;
    double along;  ///< [m]
  };
  enum class Way { ahead, back };

  template <class F>
  void for_vertices(int block, F f) const {
    const auto& b = system_.block(block);
    for (int v = b.first_vertex; v < b.first_vertex + b.vertex_count; ++v) f(v);
  }
  /// [rad] of the block at its vertex.
  double interior_angle(int vertex) const { return angle_between(shapes_.edge(vertex).direction, -shapes_.edge(system_.previous(vertex)).direction); }

  void find_covers(int a, int b) {
    bool touch = false;
    for_vertices(a, [&](int e) { for_vertices(b, [&](int f) { touch |= find_cover(a, e, b, f); }); });
    if (!touch) return;
    outline_.beside_[a].push_back(b);
    outline_.beside_[b].push_back(a);
    if (system_.block(a).material != system_.block(b).material) return;
    // Copies: these numbers change in the list.
    const std::pair<int, int> both = std::minmax(outline_.body_[a], outline_.body_[b]);
    for (int& body : outline_.body_) body = body == both.second ? both.first : body;
  }

  /// Whether edges of two blocks lie against each other. Drawings are rounded to millimetres: the blocks may overlap by that.
  bool find_cover(int a, int e, int b, int f) {
    const Edge &edge = shapes_.edge(e), &other = shapes_.edge(f);
    if (-edge.direction.dot(other.direction) < cosine_flush) return false;
    const double from = std::max(0.0, edge.along(other.end())), to = std::min(edge.length, edge.along(other.start));
    if (to - from < tolerance::shortest_edge_m) return false;
    const auto point = [&](double along) -> Vec2 { return edge.start + along * edge.direction; };
    const double gap_from = other.gap(point(from)), gap_to = other.gap(point(to));
    if (std::max(gap_from, gap_to) > widest_slit || std::min(gap_from, gap_to) < -tolerance::deepest_initial_overlap_m) return false;
    const double apart = std::max(std::abs(gap_from), std::abs(gap_to));
    const Vec2 middle = point(0.5 * (from + to)), across = other.start + other.along(middle) * other.direction;
    const double probe = std::max(0.0, other.gap(middle)) + std::min(probe_depth, probe_of_length * (to - from));
    if (!contains(polygon_of(shapes_.edges(b)), middle + probe * edge.normal()) ||
        !contains(polygon_of(shapes_.edges(a)), across + probe * other.normal()))
      return false;
    const auto on_other = [&](double along) { return std::clamp(other.along(point(along)), 0.0, other.length); };
    covers_[e].push_back({from, to, apart, b, f});
    covers_[f].push_back({on_other(to), on_other(from), apart, a, e});
    return true;
  }

  /// [m] How far from a vertex, along an edge that ends there, the other block may end as well: where the two are apart, or overlap, a line that both
  /// of them end on cuts their edges so far from each other.
  double slack(const Cover& cover, int vertex) const {
    return widest_slit + std::min(tolerance::deepest_initial_overlap_m, cover.across / std::abs(std::tan(interior_angle(vertex))));
  }

  void unite_covers(int edge) {
    const auto covers = covers_.find(edge);
    if (covers == covers_.end()) return;
    outline_.is_marked_[edge] = true;
    std::vector<Part>& inside = outline_.inside_[edge];
    const int end = system_.next(edge);
    const double length = shapes_.edge(edge).length;
    std::ranges::sort(covers->second, {}, &Cover::from);
    for (const Cover& cover : covers->second) {
      const Part part{cover.from <= slack(cover, edge) ? -infinite : cover.from,
                      cover.to >= length - slack(cover, end) ? infinite : cover.to,
                      {cover.block, system_.next(cover.edge)},
                      {cover.block, cover.edge}};
      if (inside.empty() || part.from > inside.back().to + widest_slit) {
        inside.push_back(part);
      } else if (part.to > inside.back().to) {
        inside.back().to = part.to;
        inside.back().at_to = part.at_to;
      }
    }
  }

  /// What lies against an edge right beyond a place, on the outline's way.
  /// \param room  [m] from the place at which that may begin, of a cover
  template <class Room>
  const Cover* cover_beyond(const Place& place, Way way, const Room& room) const {
    const std::vector<Cover>* covers = find(covers_, place.edge);
    if (!covers) return nullptr;
    const Cover* farthest = nullptr;
    for (const Cover& c : *covers) {
      const bool is_here = c.from <= place.along + room(c) && c.to >= place.along - room(c);
      const bool goes_beyond =
          way == Way::ahead ? c.to > place.along + tolerance::shortest_edge_m : c.from < place.along - tolerance::shortest_edge_m;
      if (!is_here || !goes_beyond) continue;
      if (!farthest || (way == Way::ahead ? c.to > farthest->to : c.from < farthest->from)) farthest = &c;
    }
    return farthest;
  }

  void find_corner(int block, int vertex) {
    const int arriving = system_.previous(vertex);
    around_ = interior_angle(vertex);
    first_ = vertex;
    Place ahead{block, vertex, 0.0}, back{block, arriving, shapes_.edge(arriving).length};
    const bool goes_on_ahead = go_around(shapes_.edge(vertex).start, ahead, Way::ahead);
    if (!go_around(shapes_.edge(vertex).start, back, Way::back) && !goes_on_ahead) return;
    const Edge &leaving = shapes_.edge(ahead.edge), &coming = shapes_.edge(back.edge);
    const Kind kind = kind_of(around_);
    // Where a joint comes out in a notch, what slides on it passes over the ground in front of the notch, see corner_meetings.h.
    if (kind == Kind::notch && ahead.along == 0.0 && back.along == coming.length) return;
    outline_.is_marked_[vertex] = true;
    outline_.corners_[vertex] = {kind,
                                 {ahead.block, ahead.edge, (leaving.length - ahead.along) * leaving.direction},
                                 {back.block, back.edge, -back.along * coming.direction},
                                 first_};
    if (kind == Kind::straight) join(back, ahead);
  }

  /// Goes from edge to edge around a point until one is not inside, and adds up the angle; whether there was any that is.
  bool go_around(const Vec2& p, Place& place, Way way) {
    bool goes_on = false;
    while (kind_of(around_) != Kind::inside) {
      const double length = shapes_.edge(place.edge).length;
      const bool is_at_start = place.along == 0.0, is_at_end = place.along == length;
      const auto room = [&](const Cover& c) {
        return is_at_start ? slack(c, place.edge) : is_at_end ? slack(c, system_.next(place.edge)) : widest_slit;
      };
      const Cover* cover = cover_beyond(place, way, room);
      if (!cover) break;
      goes_on = true;
      const Edge& other = shapes_.edge(cover->edge);
      const double along = other.along(p);
      const int end = way == Way::ahead ? system_.next(cover->edge) : cover->edge;
      const double before_end = way == Way::ahead ? other.length - along : along;
      if (before_end > std::max(room(*cover), slack(*cover, end))) {  // the other block's edge passes the point by
        around_ += std::numbers::pi;
        place = {cover->block, cover->edge, along};
        continue;
      }
      around_ += interior_angle(end);
      first_ = std::min(first_, end);
      place =
          way == Way::ahead ? Place{cover->block, end, 0.0} : Place{cover->block, system_.previous(end), shapes_.edge(system_.previous(end)).length};
    }
    return goes_on;
  }

  /// Makes one line of two edges of which one ends where the other one begins, if what they touch is one joint and they bend by no more than
  /// rounding.
  void join(const Place& back, const Place& ahead) {
    const Edge &before = shapes_.edge(back.edge), &after = shapes_.edge(ahead.edge);
    const bool meet_by_their_ends = back.along == before.length && ahead.along == 0.0;
    const double bend = std::abs(cross(before.direction, after.direction)) * std::min(before.length, after.length);
    const bool is_one_joint =
        system_.block(back.block).material == system_.block(ahead.block).material && system_.edge_joint(back.edge) == system_.edge_joint(ahead.edge);
    if (!meet_by_their_ends || !is_one_joint || bend > widest_slit || outline_.lines_[back.edge].seam_at_end != none) return;
    outline_.lines_[back.edge].seam_at_end = outline_.lines_[ahead.edge].seam_at_start = static_cast<int>(outline_.seams_.size());
    outline_.seams_.push_back({0.5 * (before.end() + after.start), (before.direction + after.direction).normalized(), back.edge, ahead.edge});
    outline_.has_seam_[back.block] = outline_.has_seam_[ahead.block] = true;
    outline_.is_marked_[back.edge] = outline_.is_marked_[ahead.edge] = true;
  }

  void measure_lines() {
    std::vector<int> edges;
    for (const Seam& first : outline_.seams_) {
      if (outline_.lines_[first.before].seam_at_start != none) continue;
      edges.assign(1, first.before);
      for (int seam; (seam = outline_.lines_[edges.back()].seam_at_end) != none;) edges.push_back(outline_.seams_[seam].after);
      // The first one has nothing before it and the last one nothing after it, not even what rounding would leave.
      const Vec2 start = shapes_.edge(edges.front()).start, end = shapes_.edge(edges.back()).end();
      for (const int e : edges) {
        const Edge& edge = shapes_.edge(e);
        if (e != edges.front()) outline_.lines_[e].straight.before = -edge.along(start);
        if (e != edges.back()) outline_.lines_[e].straight.after = edge.along(end) - edge.length;
      }
    }
  }

  const BlockSystem& system_;
  GroundOutline& outline_;
  BlockShapes shapes_;
  std::vector<Box> boxes_;
  std::unordered_map<int, std::vector<Cover>> covers_;  ///< of edges
  double around_ = 0.0;                                 ///< [rad] of ground at the vertex
  int first_ = 0;                                       ///< of the vertices there
};

GroundOutline::GroundOutline(const BlockSystem& system) {
  if (system.block_count() - system.free_count() - static_cast<int>(system.resting_blocks().size()) > 1) Survey(system, *this).run();
}

bool GroundOutline::covers(int edge, double along, double margin) const {
  const std::vector<Part>* inside = is_marked(edge) ? find(inside_, edge) : nullptr;
  return inside && std::ranges::any_of(*inside, [&](const Part& part) { return part.from + margin < along && along < part.to - margin; });
}

GroundOutline::Straight GroundOutline::straight_on(int edge) const {
  const Line* line = is_marked(edge) ? find(lines_, edge) : nullptr;
  return line ? line->straight : Straight();
}

GroundOutline::Spans GroundOutline::spans(const BlockSystem& system, int vertex) const {
  const auto along = [](const Vec2& span, double more) -> Vec2 { return more > 0.0 ? span * (1.0 + more / span.norm()) : span; };
  const Corner* there = corner(vertex);
  if (!there) {
    const int arriving = system.previous(vertex);
    return {along(system.arm(system.next(vertex)) - system.arm(vertex), straight_on(vertex).after),
            along(system.arm(arriving) - system.arm(vertex), straight_on(arriving).before)};
  }
  return {along(there->ahead.span, straight_on(there->ahead.edge).after), along(there->back.span, straight_on(there->back.edge).before)};
}

GroundOutline::Spans GroundOutline::own_spans(const BlockSystem& system, int vertex) const {
  Spans own = spans(system, vertex);
  if (const Corner* there = corner(vertex)) {
    if (there->ahead.edge != vertex) own.ahead = Vec2::Zero();
    if (there->back.edge != system.previous(vertex)) own.back = Vec2::Zero();
  }
  return own;
}

GroundOutline::BlockEdge GroundOutline::edge_ahead(int block, int vertex) const {
  const Corner* there = corner(vertex);
  return there ? BlockEdge(there->ahead.block, there->ahead.edge) : BlockEdge(block, vertex);
}

GroundOutline::BlockEdge GroundOutline::edge_back(const BlockSystem& system, int block, int vertex) const {
  const Corner* there = corner(vertex);
  return there ? BlockEdge(there->back.block, there->back.edge) : BlockEdge(block, system.previous(vertex));
}

GroundOutline::BlockVertex GroundOutline::end_ahead(const BlockSystem& system, const BlockEdge& edge, const Vec2& from) const {
  const int end = system.next(edge.second);
  if (const std::vector<Part>* inside = is_marked(edge.second) ? find(inside_, edge.second) : nullptr) {
    const double along = along_edge(system, edge, from);
    for (const Part& part : *inside) {
      if (part.from >= along - widest_slit) return part.at_from;
    }
  }
  return {edge.first, end};
}

GroundOutline::BlockVertex GroundOutline::end_back(const BlockSystem& system, const BlockEdge& edge, const Vec2& from) const {
  if (const std::vector<Part>* inside = is_marked(edge.second) ? find(inside_, edge.second) : nullptr) {
    const double along = along_edge(system, edge, from);
    for (auto part = inside->rbegin(); part != inside->rend(); ++part) {
      if (part->to <= along + widest_slit) return part->at_to;
    }
  }
  return edge;
}

bool GroundOutline::is_in_front(int edge, const Vec2& point) const {
  const Line* line = is_marked(edge) ? find(lines_, edge) : nullptr;
  if (!line) return true;
  const auto is_beyond = [&](int seam) { return seams_[seam].onwards.dot(point - seams_[seam].point) >= 0.0; };
  return (line->seam_at_start == none || is_beyond(line->seam_at_start)) && (line->seam_at_end == none || !is_beyond(line->seam_at_end));
}

const std::vector<int>& GroundOutline::beside(int block) const {
  static const std::vector<int> nothing;
  const std::vector<int>* blocks = find(beside_, block);
  return blocks ? *blocks : nothing;
}

std::size_t GroundOutline::bytes() const {
  std::size_t bytes = bytes_of(is_marked_, has_seam_, seams_) + corners_.size() * sizeof(Corner) + lines_.size() * sizeof(Line);
  for (const auto& [edge, parts] : inside_) bytes += bytes_of(parts);
  for (const auto& [block, blocks] : beside_) bytes += bytes_of(blocks);
  return bytes;
}

}  // namespace openclose
