// Places of the blocks' corners and edges, measured block by block when they are first asked for.
#pragma once

#include <algorithm>
#include <limits>
#include <ranges>
#include <span>
#include <vector>

#include "openclose/core/memory.h"
#include "openclose/geometry/box.h"
#include "openclose/model/block_system.h"

namespace openclose {

class BlockShapes {
 public:
  /// A corner and the edge that begins there.
  struct Edge {
    Vec2 start, direction;
    double length;
    Edge() {}  // nothing: memory of which nothing is measured need not be there
    Edge(const Vec2& from, const Vec2& along, double over) : start(from), direction(along), length(over) {}
    Vec2 normal() const { return {direction.y(), -direction.x()}; }  ///< outward
    double gap(const Vec2& p) const { return direction.y() * (p.x() - start.x()) - direction.x() * (p.y() - start.y()); }
    double along(const Vec2& p) const { return direction.x() * (p.x() - start.x()) + direction.y() * (p.y() - start.y()); }
    Vec2 end() const { return start + length * direction; }
    Box box() const { return Box::around(start, end()); }
  };

  std::size_t bytes() const { return bytes_of(measured_, boxes_, convex_, edges_); }
  /// Gives its memory back until the next begin().
  void let_go() {
    std::vector<Box>().swap(boxes_);
    std::vector<Edge>().swap(edges_);
  }
  void begin(const BlockSystem& system) {
    system_ = &system;
    measured_.assign(system.block_count(), 0);
    boxes_.resize(system.block_count());
    convex_.resize(system.block_count());
    edges_.resize(system.state().arm.size());
  }
  const Edge& edge(int block, int e) {
    if (!measured_[block]) measure(block);
    return edges_[e];
  }
  /// Of a block that has been measured.
  const Edge& edge(int e) const { return edges_[e]; }
  const Box& box(int block) {
    if (!measured_[block]) measure(block);
    return boxes_[block];
  }
  /// Of a block that has been measured, from its first vertex on.
  std::span<const Edge> edges(int block) const {
    const auto& b = system_->block(block);
    return {edges_.data() + b.first_vertex, static_cast<std::size_t>(b.vertex_count)};
  }
  /// Of a block that has been measured.
  bool is_convex(int block) const { return convex_[block] != 0; }
  /// [m] By which a line along an edge of one of two blocks parts them, at most: they are no nearer to each other. Zero if none does.
  double distance_at_least(int a, int b) {
    if (!measured_[a]) measure(a);
    if (!measured_[b]) measure(b);
    return std::max(beyond_edges_of(a, b), beyond_edges_of(b, a));
  }
  /// Whether two blocks lie on different sides of a line along an edge of one of them, the other one farther from it than `room` [m].
  bool apart(int a, int b, double room) {
    if (!measured_[a]) measure(a);
    if (!measured_[b]) measure(b);
    return parted_by_edge_of(a, b, room) || parted_by_edge_of(b, a, room);
  }

 private:
  bool parted_by_edge_of(int a, int b, double room) const {
    return std::ranges::any_of(edges(a), [&](const Edge& edge) {
      const auto is_beyond = [&](double distance) {
        return std::ranges::all_of(edges(b), [&](const Edge& corner) { return edge.gap(corner.start) > distance; });
      };
      if (!is_beyond(room)) return false;
      if (is_convex(a)) return true;
      double own = 0.0;  // what lies before an edge in a notch
      for (const Edge& corner : edges(a)) own = std::max(own, edge.gap(corner.start));
      return own == 0.0 || is_beyond(room + own);
    });
  }
  double beyond_edges_of(int a, int b) const {
    double farthest = 0.0;
    for (const Edge& edge : edges(a)) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Edge& corner : edges(b)) nearest = std::min(nearest, edge.gap(corner.start));
      if (nearest <= farthest) continue;
      double own = 0.0;  // what lies before an edge in a notch
      if (!is_convex(a)) {
        for (const Edge& corner : edges(a)) own = std::max(own, edge.gap(corner.start));
      }
      farthest = std::max(farthest, nearest - own);
    }
    return farthest;
  }
  void measure(int b) {
    measured_[b] = 1;
    const auto& block = system_->block(b);
    Box& box = boxes_[b];
    convex_[b] = 1;
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) {
      if (system_->is_reflex(v)) convex_[b] = 0;
      const Vec2 span = system_->arm(system_->next(v)) - system_->arm(v);
      const double length = span.norm();
      edges_[v] = Edge(system_->position(b, v), span / length, length);
      const Box own = edges_[v].box();
      box = v == block.first_vertex ? own : Box{box.low.cwiseMin(own.low), box.high.cwiseMax(own.high)};
    }
  }

  const BlockSystem* system_ = nullptr;
  std::vector<char> measured_;  ///< of the blocks
  std::vector<Box> boxes_;
  std::vector<char> convex_;
  std::vector<Edge> edges_;  ///< by the vertex they begin at
};

}  // namespace openclose
