// Cuts a domain into blocks along joint traces.
//
// The blocks are simple polygons, convex or not, counter-clockwise, without repeated vertices and straight corners. Where blocks meet in a corner
// they have the same vertex, bit for bit: every point is computed once (see arrangement.h). Where a joint ends on another one, the
// blocks at its end have a vertex there and the block on the other side has none: the vertex lies on the long edge of that one, to the rounding of
// its coordinates. Traces are sorted and turned into one direction first, and rings begin with their lowest vertex, so that the blocks do not depend,
// to the last bit, on the order or direction in which the joints are given, nor on how the domain's vertices and holes are numbered.
//
// The blocks' areas add up to the domain's to 1e-12 of it, plus the length of their edges times the rounding of the coordinates (far from the origin
// the cutting is done about a point near the domain, so that only the finished corners are rounded). Where joints or their ends come within 2e-8 m of
// each other without meeting, their nodes are united (arrangement.h), and a line bent by less than tolerance::straight_corner_rad there counts as
// straight: a vertex may then lie 2e-8 m beside its neighbour's edge, and areas miss that times the length of the edge.
//
// What a trace does beyond its last meeting with another trace or the boundary bounds no block; it is cut back (a dangling end), unless it has a
// bridge: then it goes on in its direction, as that, to the next trace or the boundary. Joints that enclose
// something but hang on the rest by fewer than two points would leave a block with a hole, which a simple polygon cannot be: they are dropped, and
// counted, for the caller to accept or to refuse.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/polygon.h"
#include "openclose/geometry/polygon_with_holes.h"
#include "openclose/geometry/segment.h"

namespace openclose {

/// A joint trace and the number of the joint (set or line, or the bridges of one) it belongs to.
struct JointTrace {
  static constexpr int no_bridge = -1;

  Segment segment;
  int joint = 0;  ///< from 0
  /// The joint as which it goes on at its ends that reach nothing, to the next of the given traces or the boundary; no_bridge: it is cut back.
  int bridge = no_bridge;
  bool goes_on_from = false, goes_on_to = false;  ///< another trace continues it at this end, which then neither reaches nor goes any farther
};

struct CuttingLimits {
  /// [m] A trace end this near to another trace or to the boundary reaches it.
  double end_reach = tolerance::joint_end_reach_m;
  /// [m], [m2] Blocks of less width (2 area / longest edge) or less area are slivers: each is united with the neighbour it has the longest common
  /// edge with (summed up if they meet along several straight edges in a row; a neighbour that meets it in separate places, be it a
  /// corner, is not taken).
  double sliver_width = tolerance::sliver_width_m;
  double sliver_area = 0.0;
  int max_blocks = 1'000'000;
};

/// What became of a joint.
struct JointUse {
  bool in_domain = false;     ///< some of it is inside the domain or on its boundary
  bool bounds_block = false;  ///< some of it is an edge of a block
};

struct Cutting {
  static constexpr int label_of_boundary = -1;

  std::vector<Polygon> blocks;  ///< by height of the centroid, then from left to right; each begins with its lowest vertex
  /// Of the edges of each block, from every vertex to the next: the label of the joint, of the first one where several run along each other, or
  /// label_of_boundary. Where it changes on a straight side, the block has a vertex there; a change within the reach of a meeting is put to it.
  std::vector<std::vector<int>> edge_labels;
  int slivers_merged = 0;
  double slivers_area = 0.0;                  ///< [m2] of those merged
  int slivers_left = 0;                       ///< that no neighbour could take
  int dangling_ends = 0;                      ///< trace ends inside the domain, longer than the reach, that were cut back
  std::vector<Vec2> enclosed;                 ///< [m] a point on each group of joints dropped because it lies within one block
  std::vector<int> loose_holes;               ///< holes of the domain that the joints do not connect to its outer boundary; no blocks then
  std::vector<JointUse> uses;                 ///< by joint
  std::vector<std::pair<int, int>> overlaps;  ///< pairs of joints that run along each other somewhere inside the domain
  bool too_many = false;                      ///< more than max_blocks, or crossings for twice as many; no blocks then
};

/// \param domain  without faults (first_ring_fault)
/// \param labels  of the joints, by their numbers: edges that become one straight side of a block are told apart by them
Cutting cut_blocks(const PolygonWithHoles& domain, std::vector<JointTrace> traces, const std::vector<int>& labels, const CuttingLimits& limits = {});

}  // namespace openclose
