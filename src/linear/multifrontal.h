// LU factorisation of a block matrix by fronts: each supernode gathers what its children have left behind in one dense matrix, eliminates its own
// rows there and hands the rest on (I. S. Duff, J. K. Reid, The multifrontal solution of unsymmetric sets of linear equations, SIAM J. Sci. Stat.
// Comput. 5 (1984)). All arithmetic of large systems is then that of dense kernels (Eigen's). Rows are exchanged within a supernode only.
#pragma once

#include <vector>

#include "openclose/linear/block_matrix.h"
#include "openclose/linear/elimination.h"

namespace openclose {

template <int N>
class MultifrontalLu {
 public:
  /// Order and layout for a pattern; nothing is done where it is the one already known. True if it was new.
  bool analyse(const BlockMatrix<N>& matrix);
  /// Of the analysed pattern. False if a pivot is zero or not finite; there is no factor then.
  bool factor(const BlockMatrix<N>& matrix);
  /// With the last matrix that was factored, whatever the pattern of later ones is.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;

  /// Gives back the memory of the factor until the next one; order and layout stay.
  void let_go() { std::vector<double>().swap(value_); }

  /// What solve() needs; the next analyse() starts anew.
  void exchange(Archive& archive) { archive(plan_, value_at_, value_, exchange_, factor_work_); }

  std::size_t bytes() const {
    return plan_.bytes() + bytes_of(source_start_, source_, in_parent_, children_, value_at_, value_, exchange_, front_, left_);
  }
  double factor_work() const { return factor_work_; }                       ///< multiplications of a factorisation
  double solve_work() const { return static_cast<double>(value_.size()); }  ///< and of a solve

 private:
  using Block = typename BlockMatrix<N>::Block;

  /// Where a block of the matrix goes in the front of its supernode.
  struct Source {
    int slot, row, column;
  };

  void plan_sources(const BlockMatrix<N>& matrix);
  void plan_children();
  void gather(const BlockMatrix<N>& matrix, int s, double* front) const;
  bool eliminate(int s, double* front);

  Eigen::Index own(int s) const { return N * static_cast<Eigen::Index>(plan_.own(s)); }
  Eigen::Index rest(int s) const { return N * static_cast<Eigen::Index>(plan_.rest_size(s)); }

  long version_ = -1;
  Elimination plan_;
  std::vector<int> source_start_;
  std::vector<Source> source_;
  std::vector<int> in_parent_;         ///< for each entry of plan_.rest: its block row in the parent's front
  std::vector<int> children_;          ///< number of each supernode
  std::vector<std::size_t> value_at_;  ///< where a supernode's factor begins: its own columns (L and U of its own rows, L of the rest), then U
  std::vector<double> value_;
  std::vector<int> exchange_;  ///< row exchanges within the supernodes, per unknown
  double factor_work_ = 0.0;
  // While factoring: the front at work, and what the children of the fronts to come have left, one upon the other.
  std::vector<double> front_, left_;
};

extern template class MultifrontalLu<3>;

}  // namespace openclose
