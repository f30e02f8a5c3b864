#include "openclose/geometry/arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/near_pairs.h"
#include "openclose/geometry/polygon.h"

namespace openclose {
namespace {

/// [m] Nodes closer together than this become one, and a piece this near to a node goes through it. With the first twice the second both parts of a
/// piece that is led through a node are shorter than the whole was, so that pieces cannot take each other's places for ever.
constexpr double node_spacing = 2.0 * tolerance::shortest_edge_m;
constexpr double piece_reach = tolerance::shortest_edge_m;

/// [m] A crossing of two segments is computed this accurately, unless they are almost in one line.
constexpr double crossing_accuracy = 0.1 * tolerance::shortest_edge_m;

/// Every pass but the first has only the moves of the one before to follow up, each shorter than the shortest edge; chains of them are short.
constexpr int most_passes = 50;

/// Nodes found again by their place.
class NodeSet {
 public:
  static constexpr int none = -1;

  /// The nearest node within node_spacing, or a new one.
  int at(const Vec2& place) {
    const int nearest = nearest_to(place);
    return nearest != none ? nearest : add(place);
  }

  int add(const Vec2& place) {
    nodes_.push_back(place);
    const auto [column, row] = cell_of(place);
    cells_.emplace(key(column, row), static_cast<int>(nodes_.size()) - 1);
    return static_cast<int>(nodes_.size()) - 1;
  }

  /// Moves a node by less than piece_reach, once; it stays where it is if it would come within node_spacing of another one.
  void move(int node, const Vec2& place) {
    // It stays in the cell of its first place: cells are wide enough for it to be found from the neighbouring ones.
    if (nearest_to(place, node) == none) nodes_[node] = place;
  }

  /// The nearest node within node_spacing but this one.
  int nearest_to(const Vec2& place, int but = none) const {
    const auto [column, row] = cell_of(place);
    int nearest = none;
    double distance = node_spacing;
    for (std::int64_t x = column - 1; x <= column + 1; ++x) {
      for (std::int64_t y = row - 1; y <= row + 1; ++y) {
        const auto [first, last] = cells_.equal_range(key(x, y));
        for (auto entry = first; entry != last; ++entry) {
          const double candidate = (nodes_[entry->second] - place).norm();
          if (entry->second == but || candidate > distance || (candidate == distance && (nearest == none || entry->second > nearest))) continue;
          distance = candidate;
          nearest = entry->second;
        }
      }
    }
    return nearest;
  }

  void reserve(std::size_t count) {
    nodes_.reserve(count);
    cells_.reserve(count);
  }
  const Vec2& operator[](int node) const { return nodes_[node]; }
  std::size_t size() const { return nodes_.size(); }
  std::vector<Vec2> take() { return std::move(nodes_); }

 private:
  static constexpr double cell_size = 2.0 * node_spacing;
  static std::pair<std::int64_t, std::int64_t> cell_of(const Vec2& place) {
    return {static_cast<std::int64_t>(std::floor(place.x() / cell_size)), static_cast<std::int64_t>(std::floor(place.y() / cell_size))};
  }
  /// Cells that share a key by chance are told apart by the distance.
  static std::uint64_t key(std::int64_t column, std::int64_t row) {
    return static_cast<std::uint64_t>(column) * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(row) * 0xc2b2ae3d27d4eb4fULL;
  }

  std::vector<Vec2> nodes_;
  std::unordered_multimap<std::uint64_t, int> cells_;
};

struct Edge {
  int low = 0;   ///< node
  int high = 0;  ///< node, > low
  bool rigid = false;
};

std::pair<int, int> ends(const Piece& piece) {
  return std::minmax(piece.from, piece.to);
}

class Cutter {
 public:
  Cutter(const std::vector<SourceSegment>& segments, const ArrangementLimits& limits) : limits_(limits) {
    nodes_.reserve(2 * segments.size());
    // Rigid ones first: their ends stay where they are, and later ones give way.
    for (const bool rigid : {true, false}) {
      for (const SourceSegment& s : segments) {
        if (s.rigid != rigid) continue;
        const int from = nodes_.at(s.segment.from);
        const int to = nodes_.at(s.segment.to);
        if (from != to) pieces_.push_back({from, to, s.source, s.rigid});
      }
      if (rigid) settled_.assign(nodes_.size(), true);
    }
  }

  /// \return whether anything was cut; none beyond the limits
  std::optional<bool> pass() {
    collect_edges();
    std::vector<Segment> segments;
    segments.reserve(edges_.size());
    for (const Edge& edge : edges_) segments.push_back({nodes_[edge.low], nodes_[edge.high]});
    const auto pairs = near_pairs(segments, piece_reach, limits_.pairs);
    if (!pairs) return std::nullopt;

    cuts_.clear();
    // Meetings with rigid segments come first, so that their nodes lie on them and not beside.
    for (const bool rigid : {true, false}) {
      for (const auto& [i, j] : *pairs) {
        if ((edges_[i].rigid || edges_[j].rigid) == rigid) meet(i, j);
        if (crossings_ > limits_.crossings) return std::nullopt;
      }
    }
    if (cuts_.empty()) return false;
    apply_cuts();
    return true;
  }

  Arrangement take() { return {nodes_.take(), std::move(pieces_)}; }

 private:
  void collect_edges() {
    std::sort(pieces_.begin(), pieces_.end(),
              [](const Piece& a, const Piece& b) { return std::pair(ends(a), a.source) < std::pair(ends(b), b.source); });
    edges_.clear();
    for (const Piece& piece : pieces_) {
      const auto [low, high] = ends(piece);
      if (edges_.empty() || edges_.back().low != low || edges_.back().high != high) edges_.push_back({low, high, false});
      edges_.back().rigid = edges_.back().rigid || piece.rigid;
    }
  }

  double distance(const Vec2& point, const Edge& edge) const { return distance_to_segment(point, nodes_[edge.low], nodes_[edge.high]); }

  bool near(int node, const Edge& edge) const { return distance(nodes_[node], edge) < piece_reach; }

  void cut(int edge, int node) {
    if (ends_in(edges_[edge], node)) return;
    cuts_.emplace_back(edge, node);
    if (edges_[edge].rigid) settle(node);
  }

  void settle(int node) {
    settled_.resize(nodes_.size(), false);
    settled_[node] = true;
  }
  bool is_settled(int node) const { return node < static_cast<int>(settled_.size()) && settled_[node]; }

  static bool ends_in(const Edge& edge, int node) { return edge.low == node || edge.high == node; }

  /// Cuts the edge at an end of another one that lies on it. A loose end beside a rigid edge is first moved onto it.
  bool meet_end(int edge, int node) {
    if (ends_in(edges_[edge], node) || !near(node, edges_[edge])) return false;
    if (edges_[edge].rigid && !is_settled(node)) {
      const Vec2& from = nodes_[edges_[edge].low];
      const Vec2 along = nodes_[edges_[edge].high] - from;
      nodes_.move(node, from + (nodes_[node] - from).dot(along) / along.squaredNorm() * along);
    }
    cut(edge, node);
    return true;
  }

  void meet(int i, int j) {
    const Edge a = edges_[i];
    const Edge b = edges_[j];
    bool touching = false;
    for (const int node : {b.low, b.high}) touching = meet_end(i, node) || touching;
    for (const int node : {a.low, a.high}) touching = meet_end(j, node) || touching;
    if (touching || ends_in(a, b.low) || ends_in(a, b.high)) return;

    const Vec2& p = nodes_[a.low];
    const Vec2& q = nodes_[b.low];
    const Vec2 along = nodes_[a.high] - p;
    const Vec2 across = nodes_[b.high] - q;
    const double sine = cross(along, across);
    if (sine == 0.0) return;
    const double fraction = cross(q - p, across) / sine;
    const double fraction_across = cross(q - p, along) / sine;
    if (fraction < 0.0 || fraction > 1.0 || fraction_across < 0.0 || fraction_across > 1.0) return;
    // On the rigid one, if there is one, so that it stays straight.
    const Vec2 crossing = b.rigid && !a.rigid ? Vec2(q + fraction_across * across) : Vec2(p + fraction * along);
    if (distance(crossing, a) > crossing_accuracy || distance(crossing, b) > crossing_accuracy) return;
    int node = nodes_.nearest_to(crossing);
    if (node == NodeSet::none || !shortens(node, a) || !shortens(node, b)) {
      node = nodes_.add(crossing);
      if (limits_.counted(crossing)) ++crossings_;
    }
    cut(i, node);
    cut(j, node);
  }

  /// Whether the parts are shorter than the edge if it is led through the node, or the node is one of its ends.
  bool shortens(int node, const Edge& edge) const {
    if (ends_in(edge, node)) return true;
    const double whole = (nodes_[edge.high] - nodes_[edge.low]).norm();
    return (nodes_[node] - nodes_[edge.low]).norm() < whole && (nodes_[edge.high] - nodes_[node]).norm() < whole;
  }

  void apply_cuts() {
    std::sort(cuts_.begin(), cuts_.end());
    cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
    std::vector<Piece> cut_pieces;
    cut_pieces.reserve(pieces_.size() + cuts_.size());
    std::size_t begin = 0;
    std::size_t edge = 0;
    std::vector<int> chain;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      const Piece& piece = pieces_[p];
      if (p > 0 && ends(piece) != ends(pieces_[p - 1])) ++edge;
      while (begin < cuts_.size() && cuts_[begin].first < static_cast<int>(edge)) ++begin;
      chain.clear();
      for (std::size_t c = begin; c < cuts_.size() && cuts_[c].first == static_cast<int>(edge); ++c) chain.push_back(cuts_[c].second);
      add_chain(piece, chain, cut_pieces);
    }
    pieces_ = std::move(cut_pieces);
  }

  void add_chain(const Piece& piece, std::vector<int>& between, std::vector<Piece>& target) const {
    const Vec2& from = nodes_[piece.from];
    const Vec2 along = nodes_[piece.to] - from;
    const auto place = [&](int node) { return (nodes_[node] - from).dot(along); };
    std::sort(between.begin(), between.end(), [&](int a, int b) { return std::pair(place(a), a) < std::pair(place(b), b); });
    int last = piece.from;
    for (const int node : between) {
      target.push_back({last, node, piece.source, piece.rigid});
      last = node;
    }
    target.push_back({last, piece.to, piece.source, piece.rigid});
  }

  const ArrangementLimits& limits_;
  std::size_t crossings_ = 0;  ///< that count
  NodeSet nodes_;
  std::vector<bool> settled_;              ///< nodes of rigid pieces; may be shorter than the nodes
  std::vector<Piece> pieces_;              ///< sorted by their ends while edges_ is in use
  std::vector<Edge> edges_;                ///< the distinct pieces, in the order of pieces_
  std::vector<std::pair<int, int>> cuts_;  ///< edge, node
};

}  // namespace

std::optional<Arrangement> arrange(const std::vector<SourceSegment>& segments, const ArrangementLimits& limits) {
  Cutter cutter(segments, limits);
  for (int pass = 0; pass < most_passes; ++pass) {
    const std::optional<bool> changed = cutter.pass();
    if (!changed) return std::nullopt;
    if (!*changed) return cutter.take();
  }
  throw std::runtime_error("the joints come so close to each other that cutting them does not come to an end");
}

}  // namespace openclose
