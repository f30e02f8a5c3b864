// How far forces would move blocks if every spring stuck: an estimate that costs in proportion to the number of blocks.
//
// The blocks are divided into groups of neighbours. Two estimates are added: that of every group for itself while all others stay in their places,
// and that of all groups together, each moving as one rigid body (a coarse space of R. A. Nicolaides, 1987). The first knows what is near, the second
// carries loads through the whole system, so that the number of iterations hardly grows with it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>
#include <vector>

#include "openclose/core/vector.h"
#include "openclose/linear/solver.h"

namespace openclose {

class TwoLevelFlexibility {
 public:
  using Unknowns = Eigen::Vector3d;
  using Stiffness = Eigen::Matrix3d;

  /// [-] No eigenvalue of this estimate times the stiffness is larger: springs between groups store at most twice what the groups' own parts of them
  /// do, (a - b)^2 <= 2 a^2 + 2 b^2, and the rigid bodies add a projection.
  static constexpr double largest_eigenvalue = 3.0;

  /// Blocks of a group: so many that the equations of the groups are few, and so few that a group is solved in the time that its forces take.
  /// Slopes of 10,208 and 20,100 blocks settle with groups of 16 in 33 and 87, of 24 in 31 and 78, of 64 in 31 and 70 thousand million instructions.
  static constexpr int usual_group = 64;

  /// \param centroids  [m] of the blocks, by rows
  /// \param couplings  pairs of rows that springs will join; repetitions allowed
  /// \param largest_group  blocks
  TwoLevelFlexibility(const std::vector<Vec2>& centroids, const std::vector<std::pair<int, int>>& couplings, int largest_group = usual_group);

  /// A block that does not turn: forces on it have no moment, springs do not turn it, and where its group turns it only goes along. To be said before
  /// anything is added.
  void lock_rotation(int row) { turns_[row] = 0.0; }
  /// What holds a block in its place.
  void add_own(int row, const Stiffness& stiffness);
  /// A spring [N/m] whose length grows by first * u_i + second * u_j; a row is -1 where the block is fixed.
  void add_spring(double stiffness, int i, Unknowns first, int j, Unknowns second);
  /// After everything was added. False if a block is held by nothing.
  bool factor();
  /// [m, rad] by forces [N, N m].
  Eigen::VectorXd displacement(const Eigen::VectorXd& force);
  Memory memory() const;

 private:
  void divide(std::vector<int>::iterator first, std::vector<int>::iterator last, const std::vector<Vec2>& centroids);
  /// The force on a block as one on its group, and the motion of the group as one of the block.
  Unknowns on_group(int row, const Unknowns& force) const;
  Unknowns of_block(int row, const Unknowns& motion) const;

  int largest_group_;
  int groups_ = 0;
  std::vector<int> group_;     ///< by rows
  std::vector<Vec2> arm_;      ///< [m] from the centre of the group
  std::vector<double> turns_;  ///< 1, or 0 where the rotation is locked
  BlockMatrix within_, between_;
  std::unique_ptr<LinearSolver> within_solver_, between_solver_;
};

}  // namespace openclose
