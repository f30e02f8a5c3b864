// Longest explicit step with which corners that are in no list yet are found in time.
//
// The list has the corners that lie opposite to an edge. One that comes over the end of an edge within a step, or turns towards it, is found after
// the step, v h deep at relative speed v. With h <= p 2/w, w the frequency of that corner alone on its spring, v h is at most 2 p times the closure
// v/w of its own impact, with p = 0.5 no more than one. Pairs that move by less than the skin against each other within the step need no such bound:
// what they come by is found within the skin anyhow.
//
// w^2 <= k l (1/m_1 + r_1^2/I_1 + 1/m_2 + r_2^2/I_2), with k the larger stiffness of the joint, or of the stiffest that edges of both blocks may
// name, l the largest tributary length that a corner of one block can have on an edge of the other (no longer than the longest edge of either, see
// narrow_phase.h), r the blocks' radii.
#pragma once

#include <utility>
#include <vector>

#include "openclose/contact/joint_table.h"
#include "openclose/core/memory.h"
#include "openclose/model/block_system.h"

namespace openclose {

class ApproachBound {
 public:
  /// [s] For the pairs whose blocks are no farther apart than `room` [m], with the velocities of the system; infinite if nothing is near.
  /// \param skin      [m] see above
  /// \param fraction  [-] p
  double step(const BlockSystem& system, const JointTable& joints, const std::vector<std::pair<int, int>>& pairs, double room, double skin,
              double fraction);
  std::size_t bytes() const { return bytes_of(longest_edges_, stiffest_seams_); }

 private:
  std::vector<double> longest_edges_;   ///< [m] of the blocks
  std::vector<double> stiffest_seams_;  ///< [Pa/m] of the joints that the blocks' edges name; 0 without any
};

}  // namespace openclose
