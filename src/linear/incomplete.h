// Incomplete LU factorisation of a block matrix as a preconditioner: fill is kept up to a level (Y. Saad, Iterative methods for sparse linear
// systems, 2003, section 10.3.3), in single precision, rows in reverse Cuthill-McKee order (A. George, J. W. H. Liu, Computer solution of large
// sparse positive definite systems, 1981, chapter 4), which makes what is dropped small.
#pragma once

#include <vector>

#include "openclose/core/archive.h"
#include "openclose/linear/weak_couplings.h"

namespace openclose {

template <int N>
class IncompleteLu {
 public:
  explicit IncompleteLu(Factoring factoring = Factoring::whole) : factoring_(factoring) {}

  /// Order and pattern; nothing is done where it is the one already known. True if it was new.
  bool analyse(const BlockMatrix<N>& matrix);
  /// Of the analysed pattern. False if a pivot is singular or not finite in single precision; there is no factor then.
  bool factor(const BlockMatrix<N>& matrix);
  /// About the inverse of the matrix times `right_side`, of which seven digits are read.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;

  /// Which couplings it has, which decides what solve() gives: the numbers are those of the next factor().
  void exchange(Archive& archive, const BlockMatrix<N>& matrix);

  /// Gives back the memory of the factor until the next one.
  void let_go() { std::vector<PaddedBlock>().swap(value_); }

  std::size_t stored_blocks() const { return column_.size(); }

 private:
  static constexpr int lanes = 4;
  typedef float Lanes __attribute__((vector_size(lanes * sizeof(float))));
  /// Columns, padded with zeros to a register of four that every processor has.
  struct PaddedBlock {
    static_assert(N <= lanes);
    Lanes column[N];
  };

  static void subtract_product(const PaddedBlock& left, const PaddedBlock& right, PaddedBlock& target);
  static PaddedBlock product(const PaddedBlock& left, const PaddedBlock& right);
  static PaddedBlock padded(const typename BlockMatrix<N>::Block& block);
  static bool invert(PaddedBlock& pivot);
  void subtract_rows_above(int i);
  /// What the slots times the solution so far leave of `sum`.
  Lanes reduced(Lanes sum, int begin, int end) const;

  int rows() const { return static_cast<int>(diagonal_.size()); }

  void plan(const BlockMatrix<N>& matrix, std::vector<char> slots);

  Factoring factoring_;
  long version_ = -1;
  std::vector<char> slots_;  ///< of the matrix: whether the factor has them
  std::vector<int> order_;   ///< row of the matrix at a place in the factor
  std::vector<int> row_start_, diagonal_, column_;
  /// In the matrix and in the factor.
  struct Entry {
    int slot, target;
  };
  std::vector<Entry> entries_;  ///< in the order in which elimination meets them
  std::vector<int> entries_start_;
  std::vector<PaddedBlock> value_;
  std::vector<int> working_slot_;        ///< of a column in the row under work; -1 where it has none
  mutable std::vector<Lanes> solution_;  ///< a block row each, in the factor's order
};

extern template class IncompleteLu<3>;

}  // namespace openclose
