// A plane graph of straight edges: which of its edges enclose anything, and the faces between them.
#pragma once

#include <utility>
#include <vector>

#include "openclose/core/vector.h"

namespace openclose {

/// An edge between two nodes. Its half-edges are 2 i, from first to second, and 2 i + 1, back.
using GraphEdge = std::pair<int, int>;

/// The biconnected component of every edge (J. Hopcroft, R. Tarjan, Efficient algorithms for graph manipulation, Comm. ACM 16, 1973): two edges have
/// the same number exactly when there is a closed path, without repeated nodes, through both. An edge that is alone in its component leads to
/// nothing (a dangling end) or to a part that hangs on it. Components are numbered from 0.
std::vector<int> biconnected_components(int node_count, const std::vector<GraphEdge>& edges);

struct Faces {
  std::vector<std::vector<int>> cycles;  ///< half-edges around each face that lies on their left; inner faces counter-clockwise
  std::vector<int> face_of;              ///< of each half-edge
};

/// The faces of a graph whose edges meet in common nodes only. Each begins with its half-edge of lowest number, and the faces are in the order of
/// these. The unbounded face is among them (one for each connected part of the graph).
Faces trace_faces(const std::vector<Vec2>& nodes, const std::vector<GraphEdge>& edges);

inline int half_edge_from(const std::vector<GraphEdge>& edges, int half_edge) {
  return half_edge % 2 == 0 ? edges[half_edge / 2].first : edges[half_edge / 2].second;
}

}  // namespace openclose
