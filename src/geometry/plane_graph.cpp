#include "openclose/geometry/plane_graph.h"

#include <algorithm>

namespace openclose {
namespace {

/// Half-edges that leave each node: those of node n are order[begin[n]] ... order[begin[n + 1] - 1].
struct Fans {
  std::vector<int> begin;
  std::vector<int> order;
};

Fans fans_of(int node_count, const std::vector<GraphEdge>& edges) {
  Fans fans;
  fans.begin.assign(node_count + 1, 0);
  for (const auto& [a, b] : edges) {
    ++fans.begin[a + 1];
    ++fans.begin[b + 1];
  }
  for (int n = 0; n < node_count; ++n) fans.begin[n + 1] += fans.begin[n];
  fans.order.resize(2 * edges.size());
  std::vector<int> next(fans.begin.begin(), fans.begin.end() - 1);
  for (int h = 0; h < static_cast<int>(fans.order.size()); ++h) fans.order[next[half_edge_from(edges, h)]++] = h;
  return fans;
}

/// Depth-first search without recursion, which would be as deep as the graph has nodes.
class Components {
 public:
  Components(int node_count, const std::vector<GraphEdge>& edges)
      : edges_(edges), fans_(fans_of(node_count, edges)), component_(edges.size(), -1), depth_(node_count, 0), low_(node_count, 0) {
    next_.assign(fans_.begin.begin(), fans_.begin.end() - 1);
    for (int root = 0; root < node_count; ++root) {
      if (depth_[root] == 0) search(root);
    }
  }

  std::vector<int> take() { return std::move(component_); }

 private:
  struct Visit {
    int node = 0;
    int by_edge = -1;
  };

  void search(int root) {
    depth_[root] = low_[root] = 1;
    std::vector<Visit> path{{root, -1}};
    while (!path.empty()) {
      const Visit visit = path.back();
      if (next_[visit.node] < fans_.begin[visit.node + 1]) {
        follow(fans_.order[next_[visit.node]++], path);
        continue;
      }
      path.pop_back();
      if (path.empty()) break;
      const int parent = path.back().node;
      low_[parent] = std::min(low_[parent], low_[visit.node]);
      // Nothing below leads past the parent: what has been collected since the edge was taken is a component of its own.
      if (low_[visit.node] >= depth_[parent]) close_component(visit.by_edge);
    }
  }

  void follow(int half_edge, std::vector<Visit>& path) {
    const int node = path.back().node;
    const int edge = half_edge / 2;
    const int other = half_edge_from(edges_, half_edge ^ 1);
    if (edge == path.back().by_edge) return;
    if (depth_[other] == 0) {
      open_.push_back(edge);
      depth_[other] = low_[other] = depth_[node] + 1;
      path.push_back({other, edge});
    } else if (depth_[other] < depth_[node]) {
      open_.push_back(edge);
      low_[node] = std::min(low_[node], depth_[other]);
    }
  }

  void close_component(int first_edge) {
    for (bool more = true; more;) {
      more = open_.back() != first_edge;
      component_[open_.back()] = count_;
      open_.pop_back();
    }
    ++count_;
  }

  const std::vector<GraphEdge>& edges_;
  Fans fans_;
  std::vector<int> component_;
  std::vector<int> depth_;  ///< of a node on the search path, from 1; 0: not yet visited
  std::vector<int> low_;    ///< least depth that can be reached from below a node
  std::vector<int> next_;   ///< place in the fans
  std::vector<int> open_;   ///< edges not yet in a component
  int count_ = 0;
};

/// Whether direction a comes before b on the way round from the negative x-axis, counter-clockwise.
bool before(const Vec2& a, const Vec2& b) {
  const auto upper = [](const Vec2& v) { return v.y() > 0.0 || (v.y() == 0.0 && v.x() > 0.0); };
  if (upper(a) != upper(b)) return upper(b);
  return cross(a, b) > 0.0;
}

}  // namespace

std::vector<int> biconnected_components(int node_count, const std::vector<GraphEdge>& edges) {
  return Components(node_count, edges).take();
}

Faces trace_faces(const std::vector<Vec2>& nodes, const std::vector<GraphEdge>& edges) {
  Fans fans = fans_of(static_cast<int>(nodes.size()), edges);
  const int count = static_cast<int>(fans.order.size());
  const auto direction = [&](int h) -> Vec2 { return nodes[half_edge_from(edges, h ^ 1)] - nodes[half_edge_from(edges, h)]; };
  std::vector<int> next(count);
  for (std::size_t n = 0; n + 1 < fans.begin.size(); ++n) {
    const auto begin = fans.order.begin() + fans.begin[n];
    const auto end = fans.order.begin() + fans.begin[n + 1];
    std::sort(begin, end, [&](int a, int b) { return before(direction(a), direction(b)); });
    // A face that comes in along the twin of one goes out by the one before it: the sharpest turn to the left.
    for (auto out = begin; out != end; ++out) next[*out ^ 1] = out == begin ? *(end - 1) : *(out - 1);
  }

  Faces faces;
  faces.face_of.assign(count, -1);
  for (int h = 0; h < count; ++h) {
    if (faces.face_of[h] >= 0) continue;
    std::vector<int>& cycle = faces.cycles.emplace_back();
    for (int g = h; faces.face_of[g] < 0; g = next[g]) {
      faces.face_of[g] = static_cast<int>(faces.cycles.size()) - 1;
      cycle.push_back(g);
    }
  }
  return faces;
}

}  // namespace openclose
