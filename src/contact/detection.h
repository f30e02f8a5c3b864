// Which vertices face which edges, with which tributary length.
//
// Tributary lengths: one rule for all methods, continuous in the motion. Let theta be the angle by which an edge a of one block and an edge e of
// another miss being antiparallel, and w = 1 for theta <= parallel_full, 0 for theta >= parallel_none, linear between.
//   - Facing edges: the overlap o of a and e, projected on the bisector of their directions, makes a contact at each of its two ends, with w o/2.
//     Two blocks that slide off each other lose length, stiffness and cohesion continuously to zero.
//   - Lone corner: vertex v opposite to e gets (1 - w_v) times half the projections on e of its own two edges (none counted longer than e), where
//     w_v is the larger w of its two edges against e. It depends on the directions only, so it does not change where a corner crosses from one
//     edge to a collinear one of the next block.
// A vertex that faces e through both rules, or through both its edges, has one contact with the sum of the lengths.
//
// Where it is not continuous: a lone corner within edge_end of the seam of two collinear edges has a contact with both; it loses its length where it
// leaves the end of an edge that nothing continues; and a raised, open corner loses its length at parallel_none. Energy held there goes into the
// ledger's redefinition.
//
// A lone corner that slides over the seam of two blocks is not stopped by the face of the next one (see tolerance::seam_height_m).
//
// At four-block corners the diagonal blocks have facing edges without overlap and no lone corner, hence no contact: they cannot lock.
#pragma once

#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/contact/joint_table.h"
#include "openclose/model/block_system.h"

namespace openclose {

struct DetectionCounters {
  long searches = 0;          ///< broad-phase searches made
  long searches_skipped = 0;  ///< steps that reused the candidates
  long narrow_phases = 0;
  long transfers = 0;  ///< contacts that inherited their history from another vertex-edge pair
};

template <int N>
class Detector {
 public:
  /// \param reach [m] open contacts are kept up to this gap: at least what two vertices can approach each other within a step
  Detector(double reach, bool skip_search) : reach_(reach), skip_search_(skip_search) {}

  /// Contacts of the present positions. `contacts` brings the history of the last step and is replaced. Only what touches in the very first call is
  /// bonded: those joints exist in the rock; surfaces that meet later have no cohesion unless it is ductile.
  void update(const BlockSystem<N>& system, const JointTable& joints, std::vector<Contact>& contacts);

  /// Pairs of blocks whose boxes, with reach and skin, overlap, at least one of them free; renewed only when something moved beyond the skin.
  const std::vector<std::pair<int, int>>& candidate_pairs() const { return pairs_; }
  const DetectionCounters& counters() const { return counters_; }

  /// Renews the candidate pairs.
  void search(const BlockSystem<N>& system);

 private:
  bool moved_beyond_skin(const BlockSystem<N>& system) const;

  double reach_;
  bool skip_search_;
  bool first_ = true;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<typename BlockSystem<N>::Unknowns> searched_at_;
  DetectionCounters counters_;
};

extern template class Detector<3>;

}  // namespace openclose
