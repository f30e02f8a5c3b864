// How deep a corner may come behind an edge before the explicit loop gives the run up.
//
// A corner belongs to the edge it came in through. Behind half of what lies behind that edge another one is nearer, through which the corner would be
// pushed out on the other side: the block has tunnelled. So the depth is watched in every step, as a list of contacts is: while blocks have moved
// less against each other than the least room that was left at the last look, no contact can have gone beyond its limit.
#pragma once

#include <algorithm>
#include <vector>

#include "openclose/core/memory.h"
#include "openclose/model/block_system.h"

namespace openclose {

class DepthLimits {
 public:
  /// [-] Of the thickness; below half of it, with room for the step in which the depth is found. An impact whose closure v sqrt(m/k) is a tenth of
  /// the thickness stays far below it, whatever part of the block's weight comes on one corner.
  static constexpr double part = 0.4;

  void begin(const BlockSystem& system);
  bool empty() const { return edges_.empty(); }
  /// [m] For a corner of one block behind an edge of another.
  double of(int vertex_block, int edge) const { return part * std::min(blocks_[vertex_block], edges_[edge]); }
  std::size_t bytes() const { return bytes_of(blocks_, edges_); }

 private:
  std::vector<double> blocks_;  ///< [m] 4 area/perimeter: the side of a square
  std::vector<double> edges_;   ///< [m] what lies behind an edge, by its first vertex: the next face that looks the other way
};

}  // namespace openclose
