#include "openclose/geometry/block_cutting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>

#include "openclose/geometry/arrangement.h"
#include "openclose/geometry/cutting_sources.h"
#include "openclose/geometry/labelled_outline.h"
#include "openclose/geometry/plane_graph.h"
#include "openclose/geometry/trace_continuation.h"

namespace openclose {
namespace {

/// [m] Blocks at heights closer than this count as level when they are put in order.
constexpr double level = 1e-6;
/// [-] Blocks add up to the domain but for rounding; more than this is a fault of the program.
constexpr double area_rounding = 1e-7;

/// Sets of things that belong together.
class Groups {
 public:
  explicit Groups(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(int a, int b) {
    a = of(a);
    b = of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

/// The blocks as they are found: nodes and edges of the arrangement, of which fewer and fewer are left.
class Cut {
 public:
  Cut(const PolygonWithHoles& domain, Arrangement arrangement, const CuttingLimits& limits, const std::vector<int>& labels)
      : domain_(domain), limits_(limits), labels_(labels), nodes_(std::move(arrangement.nodes)) {
    result_.uses.resize(labels.size());
    collect_edges(arrangement.pieces);
  }

  Cutting blocks() {
    drop_outside();
    note_overlaps();
    count_dangling_ends();
    drop_what_bounds_nothing();
    if (!result_.loose_holes.empty()) return std::move(result_);
    note_uses();
    label_edges();
    trace();
    merge_slivers();
    if (static_cast<int>(faces_.size()) > limits_.max_blocks) {
      result_.too_many = true;
      return std::move(result_);
    }
    collect_blocks();
    return std::move(result_);
  }

 private:
  struct Edge {
    int from = 0;
    int to = 0;
    bool boundary = false;  ///< the domain is on the left only
    int label = Cutting::label_of_boundary;
    std::size_t owners = 0;  ///< the first of them
    std::size_t owners_end = 0;
  };

  void collect_edges(std::vector<Piece>& pieces) {
    const auto key = [](const Piece& p) { return std::tuple(std::min(p.from, p.to), std::max(p.from, p.to), p.source); };
    std::sort(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) { return key(a) < key(b); });
    for (const Piece& piece : pieces) {
      const auto [low, high] = std::minmax(piece.from, piece.to);
      const bool known = !edges_.empty() && std::minmax(edges_.back().from, edges_.back().to) == std::pair<const int&, const int&>(low, high);
      // Rings come first among the owners and give the edge its direction.
      if (!known) edges_.push_back({piece.from, piece.to, is_ring(piece.source), Cutting::label_of_boundary, owners_.size(), owners_.size()});
      if (owners_.size() == edges_.back().owners || owners_.back() != piece.source) owners_.push_back(piece.source);
      edges_.back().owners_end = owners_.size();
    }
  }

  template <typename Drop>
  void drop_edges(const Drop& drop) {
    std::size_t kept = 0;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (!drop(static_cast<int>(e))) edges_[kept++] = edges_[e];
    }
    edges_.resize(kept);
  }

  double length(const Edge& edge) const { return (nodes_[edge.to] - nodes_[edge.from]).norm(); }

  std::vector<bool> boundary_nodes() const {
    std::vector<bool> on_boundary(nodes_.size(), false);
    for (const Edge& edge : edges_) {
      if (edge.boundary) on_boundary[edge.from] = on_boundary[edge.to] = true;
    }
    return on_boundary;
  }

  /// Joints that hang together without passing the boundary are all inside or all outside: one of them, the longest, decides.
  void drop_outside() {
    const std::vector<bool> on_boundary = boundary_nodes();
    const int edge_count = static_cast<int>(edges_.size());
    Groups groups(edge_count);
    std::vector<int> edge_at(nodes_.size(), -1);
    for (int e = 0; e < edge_count; ++e) {
      for (const int node : {edges_[e].from, edges_[e].to}) {
        if (edges_[e].boundary || on_boundary[node]) continue;
        if (edge_at[node] >= 0) groups.unite(e, edge_at[node]);
        edge_at[node] = e;
      }
    }
    std::vector<int> longest(edge_count, -1);
    for (int e = 0; e < edge_count; ++e) {
      int& candidate = longest[groups.of(e)];
      if (candidate < 0 || length(edges_[e]) > length(edges_[candidate])) candidate = e;
    }
    std::vector<bool> inside(edge_count, true);
    for (int e = 0; e < edge_count; ++e) {
      if (longest[e] < 0 || edges_[e].boundary) continue;
      const Edge& edge = edges_[longest[e]];
      inside[e] = domain_.contains(0.5 * (nodes_[edge.from] + nodes_[edge.to]));
    }
    drop_edges([&](int e) { return !inside[groups.of(e)]; });
    note(&JointUse::in_domain);
  }

  void note(bool JointUse::*what) {
    for (const Edge& edge : edges_) {
      for (std::size_t o = edge.owners; o < edge.owners_end; ++o) {
        if (!is_ring(owners_[o])) result_.uses[owners_[o]].*what = true;
      }
    }
  }
  void note_uses() { note(&JointUse::bounds_block); }

  void note_overlaps() {
    std::set<std::pair<int, int>> pairs;
    for (const Edge& edge : edges_) {
      if (edge.boundary || length(edge) <= 2.0 * limits_.end_reach + tolerance::shortest_edge_m) continue;
      for (std::size_t a = edge.owners; a < edge.owners_end; ++a) {
        for (std::size_t b = a + 1; b < edge.owners_end; ++b) pairs.emplace(owners_[a], owners_[b]);
      }
    }
    result_.overlaps.assign(pairs.begin(), pairs.end());
  }

  struct EdgesAtNodes {
    std::vector<std::array<int, 2>> first_two;  ///< -1 where there are fewer
    std::vector<int> degree;
  };
  EdgesAtNodes edges_at_nodes() const {
    EdgesAtNodes at{std::vector<std::array<int, 2>>(nodes_.size(), {-1, -1}), std::vector<int>(nodes_.size(), 0)};
    for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
      for (const int node : {edges_[e].from, edges_[e].to}) {
        if (at.degree[node] < 2) at.first_two[node][at.degree[node]] = e;
        ++at.degree[node];
      }
    }
    return at;
  }

  /// What is left of the stub at an end that met what it was meant to is as long as the reach, or twice that if it fell short; longer ends dangle.
  void count_dangling_ends() {
    const auto [edges_at, degree] = edges_at_nodes();
    for (int end = 0; end < static_cast<int>(nodes_.size()); ++end) {
      if (degree[end] != 1) continue;
      int node = end;
      int edge = edges_at[end][0];
      double loose = 0.0;
      while (true) {
        loose += length(edges_[edge]);
        node = edges_[edge].from == node ? edges_[edge].to : edges_[edge].from;
        if (degree[node] != 2) break;
        edge = edges_at[node][0] == edge ? edges_at[node][1] : edges_at[node][0];
      }
      if (loose > 2.0 * limits_.end_reach + 2.0 * tolerance::shortest_edge_m) ++result_.dangling_ends;
    }
  }

  std::vector<GraphEdge> graph() const {
    std::vector<GraphEdge> graph;
    graph.reserve(edges_.size());
    for (const Edge& edge : edges_) graph.emplace_back(edge.from, edge.to);
    return graph;
  }

  bool has_ring(const Edge& edge, int ring) const {
    return std::find(owners_.begin() + edge.owners, owners_.begin() + edge.owners_end, source_of_ring(ring)) != owners_.begin() + edge.owners_end;
  }

  /// Only what lies on closed paths with the outer boundary is left: of such a graph every face is a simple polygon.
  void drop_what_bounds_nothing() {
    const std::vector<int> component = biconnected_components(static_cast<int>(nodes_.size()), graph());
    std::map<int, int> edges_in;
    for (const int c : component) ++edges_in[c];
    const auto outer = std::find_if(edges_.begin(), edges_.end(), [&](const Edge& edge) { return has_ring(edge, 0); });
    const int kept = component[outer - edges_.begin()];

    std::set<int> seen;
    std::set<int> loose;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (component[e] == kept || edges_in[component[e]] == 1) continue;
      if (edges_[e].boundary) {
        loose.insert(ring_of_source(owners_[edges_[e].owners]) - 1);
      } else if (seen.insert(component[e]).second) {
        result_.enclosed.emplace_back(0.5 * (nodes_[edges_[e].from] + nodes_[edges_[e].to]));
      }
    }
    result_.loose_holes.assign(loose.begin(), loose.end());
    drop_edges([&](int e) { return component[e] != kept; });
  }

  /// Where several joints run along each other the first one counts. A label that changes a little beside a meeting changes there: what lies between
  /// would be an edge so short that no drawing means it.
  void label_edges() {
    for (Edge& edge : edges_) {
      if (!edge.boundary) edge.label = labels_[owners_[edge.owners]];
    }
    const auto [edges_at, degree] = edges_at_nodes();
    for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
      Edge& edge = edges_[e];
      if (edge.boundary || length(edge) > limits_.end_reach + tolerance::shortest_edge_m) continue;
      for (const int node : {edge.from, edge.to}) {
        if (degree[node] != 2) continue;
        const Edge& other = edges_[edges_at[node][0] == e ? edges_at[node][1] : edges_at[node][0]];
        if (!other.boundary && length(other) > length(edge)) edge.label = other.label;
      }
    }
  }

  struct Face {
    std::vector<int> cycle;   ///< half-edges
    Polygon polygon;          ///< corners, and vertices where the label changes, beginning with the lowest (leftmost of several)
    std::vector<int> labels;  ///< of the edges of the polygon
    double area = 0.0;        ///< [m2]
    double width = 0.0;       ///< [m]
  };

  /// [m] Of a side from corner to corner.
  static double longest_side(const Face& face) {
    if (std::ranges::adjacent_find(face.labels, std::not_equal_to()) == face.labels.end()) return longest_edge(face.polygon);
    return longest_edge(simplified(face.polygon, std::vector<int>(face.labels.size(), 0)).polygon);
  }

  Face make_face(std::vector<int> cycle, const std::vector<GraphEdge>& graph) const {
    Face face;
    Polygon all;
    std::vector<int> labels;
    for (const int h : cycle) {
      all.push_back(nodes_[half_edge_from(graph, h)]);
      labels.push_back(edges_[h / 2].label);
    }
    LabelledOutline outline = from_lowest(simplified(all, labels));
    face.polygon = std::move(outline.polygon);
    face.labels = std::move(outline.labels);
    face.area = face.polygon.size() < 3 ? 0.0 : signed_area(face.polygon);
    face.width = face.polygon.size() < 3 ? 0.0 : 2.0 * face.area / longest_side(face);
    face.cycle = std::move(cycle);
    return face;
  }

  /// Faces inside the domain: those outside have the boundary the wrong way round.
  void trace() {
    const std::vector<GraphEdge> edges = graph();
    Faces traced = trace_faces(nodes_, edges);
    std::set<int> used;
    for (const auto& [a, b] : edges) {
      used.insert(a);
      used.insert(b);
    }
    // Euler's formula for a connected plane graph.
    if (traced.cycles.size() + used.size() != edges.size() + 2)
      throw std::logic_error("the joints cut the domain into faces that do not fit together");
    faces_.clear();
    face_of_.assign(traced.face_of.size(), -1);
    for (std::vector<int>& cycle : traced.cycles) {
      if (std::any_of(cycle.begin(), cycle.end(), [&](int h) { return h % 2 == 1 && edges_[h / 2].boundary; })) continue;
      for (const int h : cycle) face_of_[h] = static_cast<int>(faces_.size());
      faces_.push_back(make_face(std::move(cycle), edges));
    }
  }

  bool is_sliver(const Face& face) const { return face.width < limits_.sliver_width || face.area < limits_.sliver_area; }

  int node_at(int half_edge) const { return half_edge % 2 == 0 ? edges_[half_edge / 2].from : edges_[half_edge / 2].to; }

  std::vector<int> nodes_of(int face) const {
    std::vector<int> nodes;
    for (const int h : faces_[face].cycle) nodes.push_back(node_at(h));
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  }

  int common_nodes(int face, int other) const {
    const std::vector<int> nodes = nodes_of(face);
    const std::vector<int>& cycle = faces_[other].cycle;
    return static_cast<int>(
        std::count_if(cycle.begin(), cycle.end(), [&](int h) { return std::binary_search(nodes.begin(), nodes.end(), node_at(h)); }));
  }

  /// The neighbour a sliver goes to and the half-edges between them; -1 if there is none.
  int host(int sliver, std::vector<int>& common, const std::vector<bool>& taken) const {
    const std::vector<int>& cycle = faces_[sliver].cycle;
    const int n = static_cast<int>(cycle.size());
    const auto neighbour = [&](int i) { return face_of_[cycle[(i + n) % n] ^ 1]; };
    struct Contact {
      double length = 0.0;
      int edges = 0;
    };
    std::map<int, Contact> shared;
    for (int i = 0; i < n; ++i) {
      const int other = neighbour(i);
      if (other < 0 || other == sliver || taken[other]) continue;
      shared[other].length += length(edges_[cycle[i] / 2]);
      ++shared[other].edges;
    }
    int best = -1;
    for (const auto& [other, contact] : shared) {
      if (best >= 0 && contact.length <= shared[best].length) continue;
      // Edges in one row have one node more; any other node is a second place, and what lies between the two would be surrounded.
      if (common_nodes(sliver, other) == contact.edges + 1) best = other;
    }
    common.clear();
    for (int i = 0; i < n; ++i) {
      if (best >= 0 && neighbour(i) == best) common.push_back(cycle[i]);
    }
    return best;
  }

  void merge_slivers() {
    for (bool any = true; any;) {
      any = false;
      result_.slivers_left = 0;
      std::vector<bool> taken(faces_.size(), false);
      std::vector<bool> grown(faces_.size(), false);
      std::vector<bool> dropped(edges_.size(), false);
      std::vector<int> common;
      std::set<std::pair<int, int>> given;  // to a face: nodes of slivers in this pass
      for (int f = 0; f < static_cast<int>(faces_.size()); ++f) {
        if (!is_sliver(faces_[f])) continue;
        ++result_.slivers_left;
        if (grown[f]) continue;
        const int to = host(f, common, taken);
        if (to < 0) continue;
        const std::vector<int> nodes = nodes_of(f);
        // Two slivers that touch each other can surround a hole or a block together with their neighbour: the second waits for what the first makes
        // of it.
        if (std::any_of(nodes.begin(), nodes.end(), [&](int node) { return given.count({to, node}) > 0; })) {
          any = true;
          continue;
        }
        for (const int node : nodes) given.emplace(to, node);
        taken[f] = grown[to] = any = true;
        for (const int h : common) dropped[h / 2] = true;
        ++result_.slivers_merged;
        result_.slivers_area += faces_[f].area;
      }
      if (!any) return;
      drop_edges([&](int e) { return dropped[e]; });
      drop_what_bounds_nothing();
      trace();
    }
  }

  void collect_blocks() {
    double sum = 0.0;
    std::vector<std::tuple<double, double, int>> order;
    for (int f = 0; f < static_cast<int>(faces_.size()); ++f) {
      const Vec2 centroid = polygon_properties(faces_[f].polygon).centroid;
      order.emplace_back(std::round(centroid.y() / level), centroid.x(), f);
      sum += faces_[f].area;
    }
    if (std::abs(sum - domain_.area()) > area_rounding * domain_.area()) throw std::logic_error("the blocks do not add up to the domain");
    std::sort(order.begin(), order.end());
    for (const auto& [y, x, f] : order) {
      result_.blocks.push_back(std::move(faces_[f].polygon));
      result_.edge_labels.push_back(std::move(faces_[f].labels));
    }
  }

  const PolygonWithHoles& domain_;
  const CuttingLimits& limits_;
  const std::vector<int>& labels_;  ///< of the joints
  std::vector<Vec2> nodes_;
  std::vector<Edge> edges_;
  std::vector<int> owners_;  ///< sources of all edges, one edge after the other
  std::vector<Face> faces_;
  std::vector<int> face_of_;  ///< of half-edges; -1 outside the domain
  Cutting result_;
};

Cutting cut_near_origin(const PolygonWithHoles& domain, std::vector<JointTrace> traces, const std::vector<int>& labels, const CuttingLimits& limits) {
  make_canonical(traces);
  if (continue_traces(traces, rings_of(domain), limits.end_reach)) make_canonical(traces);
  // A crossing of two traces in the domain makes a block more, but for one that each trace may have in vain. Twice as many are let pass, since
  // slivers go. Crossings beside the domain and comparisons in vain make no block, hence many more of these.
  constexpr std::size_t comparisons = 32;
  const std::size_t most = static_cast<std::size_t>(limits.max_blocks);
  const ArrangementLimits growth{comparisons * (most + traces.size() + domain.outer.size() + 1000), 2 * most + traces.size(),
                                 [&](const Vec2& crossing) { return domain.contains(crossing); }};
  std::optional<Arrangement> arrangement = arrange(sources_of(domain, traces, limits.end_reach), growth);
  if (!arrangement) {
    Cutting refused;
    refused.too_many = true;
    return refused;
  }
  return Cut(domain, std::move(*arrangement), limits, labels).blocks();
}

}  // namespace

Cutting cut_blocks(const PolygonWithHoles& domain, std::vector<JointTrace> traces, const std::vector<int>& labels, const CuttingLimits& limits) {
  const Vec2 origin = local_origin(domain.outer);
  if (origin.isZero(0.0)) return cut_near_origin(domain, std::move(traces), labels, limits);
  for (JointTrace& trace : traces) trace.segment = {trace.segment.from - origin, trace.segment.to - origin};
  Cutting cutting = cut_near_origin(moved(domain, -origin), std::move(traces), labels, limits);
  // Rounding can straighten what was hardly a corner.
  for (std::size_t b = 0; b < cutting.blocks.size(); ++b) {
    LabelledOutline outline = from_lowest(simplified(moved(std::move(cutting.blocks[b]), origin), cutting.edge_labels[b]));
    cutting.blocks[b] = std::move(outline.polygon);
    cutting.edge_labels[b] = std::move(outline.labels);
  }
  for (Vec2& point : cutting.enclosed) point += origin;
  return cutting;
}

}  // namespace openclose
