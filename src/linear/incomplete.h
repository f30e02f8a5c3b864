// Incomplete LU factorisation of a block matrix as a preconditioner: fill is kept up to a level (Y. Saad, Iterative methods for sparse linear
// systems, 2003, section 10.3.3), in single precision, rows in reverse Cuthill-McKee order (A. George, J. W. H. Liu, Computer solution of large
// sparse positive definite systems, 1981, chapter 4), which makes what is dropped small, from both of its ends at a time.
//
// Of large systems a solve waits for the factor to come from memory. It is kept as whole numbers of 16 bits, half of the bytes, with a scale for what
// a row has on either side of the diagonal: 3e-5 of the largest entry is lost, while what is dropped are hundredths. So that this is as true for
// blocks of a centimetre as for those of a hundred metres, rows and columns are brought to diagonal entries of about one first.
//
// Within a step few rows of the matrix change by more than matters to a preconditioner. A row of the factor is kept while its row of the matrix is
// about what it was when it was taken, and the pivots of the rows that it subtracts are about what they were. The diagonal block tells: a contact
// that changes what couples two blocks changes as much in the diagonal blocks of both.
#pragma once

#include <cstdint>
#include <vector>

#include "openclose/core/archive.h"
#include "openclose/core/packs.h"
#include "openclose/linear/factor_plan.h"

namespace openclose {

/// What comes up where the matrix has nothing.
enum class Fill {
  low,  ///< is kept up to a level
  all,  ///< is kept: the factor is whole
};

class IncompleteLu {
 public:
  /// Whole numbers, column by column; the last one as a number of single precision, which fills up the row of bytes.
  struct StoredBlock {
    using Numbers = float;
    std::int16_t entry[dofs * dofs - 1];
    float last;
  };
  /// [-] What the numbers of a row are worth.
  struct RowScale {
    using Numbers = float;
    float below = 0.0f, pivot = 0.0f, above = 0.0f;  ///< the diagonal, with the inverse of the pivot on it
  };

  explicit IncompleteLu(Factoring factoring = Factoring::whole, Fill fill = Fill::low);

  /// Order and pattern; nothing is done where it is the one already known. True if it was new.
  bool analyse(const BlockMatrix& matrix);
  /// Of the analysed pattern. False if a pivot is singular or not finite in single precision; there is no factor then.
  bool factor(const BlockMatrix& matrix);
  int rows_kept() const { return rows_kept_; }  ///< by the last factor(); none of a whole factor
  long products() const { return products_; }   ///< of two blocks, in the last factor()
  /// [-] Entry of the inverse of a pivot, over that of the diagonal block that it has come from, about: of a pivot that much is lost of its digits.
  double largest_inverse() const;
  /// About the inverse of the matrix times `right_side`, of which seven digits are read.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;
  /// The same of vectors in the factor's order, see single_matrix.h.
  void solve_in_order(const Eigen::VectorXf& right_side, Eigen::VectorXf& x) const;
  const std::vector<int>& order() const { return order_; }  ///< row of the matrix at a place in the factor

  /// Which couplings it has, which decides what solve() gives, and the factor, of which the next one keeps rows.
  void exchange(Archive& archive, const BlockMatrix& matrix);

  /// Gives back the memory of the factor until the next one.
  void let_go() {
    std::vector<StoredBlock>().swap(value_);
    std::vector<PaddedBlock>().swap(taken_);
  }

  std::size_t bytes() const {
    return bytes_of(slots_, order_, row_start_, diagonal_, column_, entries_, entries_start_, value_, worth_, taken_, scale_, changed_,
                    working_place_, working_row_, solution_);
  }
  std::size_t stored_blocks() const { return column_.size(); }

 private:
  /// Columns, padded with zeros to a register of four that every processor has.
  struct PaddedBlock {
    using Numbers = float;
    FloatLanes column[dofs];
  };

  static PaddedBlock widen(const StoredBlock& block, float scale);
  /// Keeps blocks of the row under work; returns the scale.
  float store(int first, int end, int row_start);
  static PaddedBlock product(const PaddedBlock& left, const PaddedBlock& right);
  static PaddedBlock padded(const BlockMatrix::Block& block);
  static bool invert(PaddedBlock& pivot);
  /// Whether an entry has changed by more than kept_change over the root of the weights of its row and column.
  static bool has_changed(const PaddedBlock& before, const PaddedBlock& now, const FloatLanes& weight);
  /// Sizes of those of row i when it was taken.
  FloatLanes diagonal_entries(int i) const;
  /// Whether row i of the factor is that of a row of the matrix which has hardly changed since.
  bool is_as_taken(const BlockMatrix& matrix, int i) const;
  bool subtracts_changed_row(int i) const;
  void take_row(const BlockMatrix& matrix, int i);
  void subtract_rows_above(int i);
  void find_scale(const BlockMatrix& matrix);
  /// A block of the matrix that goes to these places of the factor.
  PaddedBlock scaled(const BlockMatrix::Block& block, int row, int column) const;

  int rows() const { return static_cast<int>(diagonal_.size()); }

  void plan(const BlockMatrix& matrix, std::vector<char> slots);

  Factoring factoring_;
  int most_fill_;  ///< level
  long version_ = -1;
  std::vector<char> slots_;  ///< of the matrix: whether the factor has them
  std::vector<int> order_;
  std::vector<int> row_start_, diagonal_, column_;
  /// In the matrix and in the factor.
  struct Entry {
    int slot, target;
  };
  std::vector<Entry> entries_;  ///< in the order in which elimination meets them
  std::vector<int> entries_start_;
  std::vector<StoredBlock> value_;  ///< none before the first factor() of a pattern; pivots as their inverses
  std::vector<RowScale> worth_;     ///< by places in the factor
  std::vector<PaddedBlock> taken_;  ///< by places in the factor: diagonal block of the matrix that the row was worked out from
  /// What rows and columns of the matrix are multiplied with before it is factored, four numbers at a place in the factor, the last one zero: powers
  /// of two, so that this is exact. Of the matrix at which the factor was begun.
  std::vector<float> scale_;
  std::vector<char> changed_;  ///< by places in the factor: whether the row is another one than in the factor before
  int rows_kept_ = 0;
  long products_ = 0;
  std::vector<int> working_place_;  ///< of a column in the row under work; -1 where it has none
  std::vector<PaddedBlock> working_row_;
  mutable std::vector<FloatLanes> solution_;  ///< a block row each, in the factor's order
};

}  // namespace openclose
