// The fixed blocks as one body: what they touch among themselves is inside of it, and nothing else can touch anything there.
//
// Joints between fixed blocks never open, so that ground in one piece and the same ground cut by joints are the same to what stands on it:
//   - An edge of a fixed block is inside along the parts where another one lies against it.
//   - At a vertex with such an edge the outline goes on along an edge of another block. The angle of the ground there is the sum of the blocks', and
//     where it comes to 180 deg or more nothing sticks out, however sharp the tip of a single block is that ends there.
//   - Where the outline goes straight on from an edge to the next one, both are parts of one line, and a corner in front of it is in front of one of
//     them: contacts are those of the line.
#pragma once

#include <cstddef>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "openclose/model/block_system.h"

namespace openclose {

class GroundOutline {
 public:
  enum class Kind : unsigned char {
    corner,    ///< sticks out
    straight,  ///< to flush_tilt
    notch,     ///< has more than 180 deg of ground around it
    inside,    ///< has nothing but ground around it
  };
  /// An edge that begins or ends at a vertex of the outline.
  struct Side {
    int block, edge;
    Vec2 span;  ///< [m] from the vertex along the edge as far as it goes
  };
  /// The outline at a vertex of a fixed block.
  struct Corner {
    Kind kind;
    Side ahead, back;  ///< where there is nothing but ground they mean nothing
    int first;         ///< the least of the vertices that are this corner together
  };
  /// [m] How far the outline goes straight on beyond the start and the end of an edge.
  struct Straight {
    double before = 0.0, after = 0.0;
  };

  /// Of the blocks as they are now; fixed ones never move.
  explicit GroundOutline(const BlockSystem& system);

  /// Of a vertex with another fixed block along one of its edges; null for all others, which are what they are in their own block.
  const Corner* corner(int vertex) const { return is_marked(vertex) ? find(corners_, vertex) : nullptr; }
  /// Whether another fixed block lies against an edge at this distance along it [m], and does so for more than `margin` [m] on both sides, or up to
  /// the edge's end.
  bool covers(int edge, double along, double margin) const;
  Straight straight_on(int edge) const;
  /// [m] From a vertex along the two edges that meet there, of the outline if it is one of the ground, as far as they go straight on.
  struct Spans {
    Vec2 ahead, back;
  };
  Spans spans(const BlockSystem& system, int vertex) const;
  /// The same with zero for an edge that begins or ends at another block's vertex: together the vertices of a corner have each of its edges once.
  Spans own_spans(const BlockSystem& system, int vertex) const;
  /// A block and an edge of it.
  using BlockEdge = std::pair<int, int>;
  /// The edge that begins at a vertex of a block, and the one that ends there: of the outline if it is one of the ground.
  BlockEdge edge_ahead(int block, int vertex) const;
  BlockEdge edge_back(const BlockSystem& system, int block, int vertex) const;
  /// A block and a vertex of it.
  using BlockVertex = std::pair<int, int>;
  /// To which vertex the outline goes from a point of it along an edge, and from which one it has come: the edge's end, or that of another block that
  /// lies against the edge from there on.
  BlockVertex end_ahead(const BlockSystem& system, const BlockEdge& edge, const Vec2& from) const;
  BlockVertex end_back(const BlockSystem& system, const BlockEdge& edge, const Vec2& from) const;
  /// Whether a point is in front of this one of the edges that make a line. In front of the line it is in front of exactly one of them.
  bool is_in_front(int edge, const Vec2& point) const;
  /// The least number of the blocks that are one body with this one, of one rock and against each other; its own if nothing lies against it.
  int body(int block) const { return body_.empty() ? block : body_[block]; }
  /// Whether an edge of this block is a part of such a line.
  bool has_seam(int block) const { return !has_seam_.empty() && has_seam_[block]; }
  /// The fixed blocks that lie against this one.
  const std::vector<int>& beside(int block) const;

  std::size_t bytes() const;

 private:
  class Survey;

  /// Where a line goes on from one edge to the next.
  struct Seam {
    Vec2 point, onwards;  ///< [m], [-]
    int before, after;    ///< edges
  };
  struct Line {
    int seam_at_start = none, seam_at_end = none;
    Straight straight;
  };
  /// A part of an edge that others lie against.
  struct Part {
    double from, to;             ///< [m]; infinite where it reaches the edge's end
    BlockVertex at_from, at_to;  ///< of the others
  };
  static constexpr int none = -1;

  template <class Value>
  static const Value* find(const std::unordered_map<int, Value>& of, int key) {
    const auto found = of.find(key);
    return found == of.end() ? nullptr : &found->second;
  }
  bool is_marked(int vertex) const { return !is_marked_.empty() && is_marked_[vertex]; }

  std::vector<char> is_marked_, has_seam_;             ///< vertices and edges of which there is something below; blocks; or empty
  std::vector<int> body_;                              ///< of the blocks; or empty
  std::unordered_map<int, Corner> corners_;            ///< of vertices
  std::unordered_map<int, std::vector<Part>> inside_;  ///< of edges, in order
  std::vector<Seam> seams_;
  std::unordered_map<int, Line> lines_;               ///< of edges
  std::unordered_map<int, std::vector<int>> beside_;  ///< of blocks
};

}  // namespace openclose
