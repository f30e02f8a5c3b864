// Places of the blocks' corners and edges, measured block by block when they are first asked for.
#pragma once

#include <algorithm>
#include <limits>
#include <ranges>
#include <span>
#include <unordered_map>
#include <vector>

#include "openclose/core/memory.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"
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

  std::size_t bytes() const {
    std::size_t bytes = bytes_of(measured_, boxes_, convex_, edges_);
    for (const auto& [block, hull] : hulls_) bytes += bytes_of(hull);
    return bytes;
  }
  /// Gives its memory back until the next begin().
  void let_go() {
    std::vector<Box>().swap(boxes_);
    std::vector<Edge>().swap(edges_);
    hulls_.clear();
  }
  void begin(const BlockSystem& system) {
    system_ = &system;
    measured_.assign(system.block_count(), 0);
    boxes_.resize(system.block_count());
    convex_.resize(system.block_count());
    edges_.resize(system.state().arm.size());
    hulls_.clear();
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
  /// [m] By which a line along an edge of the convex hull of one of two blocks parts them, at most: they are no nearer to each other. Zero if none
  /// does.
  double distance_at_least(int a, int b) {
    if (!measured_[a]) measure(a);
    if (!measured_[b]) measure(b);
    return std::max(beyond_edges_of(a, b), beyond_edges_of(b, a));
  }
  /// Whether two blocks lie on different sides of such a line, the other one farther from it than `room` [m].
  bool apart(int a, int b, double room) {
    if (!measured_[a]) measure(a);
    if (!measured_[b]) measure(b);
    return parted_by_edge_of(a, b, room) || parted_by_edge_of(b, a, room);
  }

 private:
  /// Edges of the convex hull.
  std::span<const Edge> hull(int block) const { return is_convex(block) ? edges(block) : std::span<const Edge>(hulls_.at(block)); }
  bool parted_by_edge_of(int a, int b, double room) const {
    return std::ranges::any_of(
        hull(a), [&](const Edge& edge) { return std::ranges::all_of(hull(b), [&](const Edge& corner) { return edge.gap(corner.start) > room; }); });
  }
  double beyond_edges_of(int a, int b) const {
    double farthest = 0.0;
    for (const Edge& edge : hull(a)) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Edge& corner : hull(b)) {
        nearest = std::min(nearest, edge.gap(corner.start));
        if (nearest <= farthest) break;
      }
      farthest = std::max(farthest, nearest);
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
    if (!is_convex(b)) measure_hull(b);
  }
  void measure_hull(int b) {
    std::vector<Vec2> corners;
    for (const Edge& edge : edges(b)) corners.push_back(edge.start);
    const Polygon hull = convex_hull(std::move(corners));
    std::vector<Edge>& around = hulls_[b];
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vec2 span = hull[(i + 1) % hull.size()] - hull[i];
      const double length = span.norm();
      around.emplace_back(hull[i], span / length, length);
    }
  }

  const BlockSystem* system_ = nullptr;
  std::vector<char> measured_;  ///< of the blocks
  std::vector<Box> boxes_;
  std::vector<char> convex_;
  std::vector<Edge> edges_;                           ///< by the vertex they begin at
  std::unordered_map<int, std::vector<Edge>> hulls_;  ///< of the blocks that have been measured and are not convex
};

}  // namespace openclose
