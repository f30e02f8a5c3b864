// Incomplete LU factorisation of a block matrix as a preconditioner: fill is kept up to a level (Y. Saad, Iterative methods for sparse linear
// systems, 2003, section 10.3.3), in single precision, rows in reverse Cuthill-McKee order (A. George, J. W. H. Liu, Computer solution of large
// sparse positive definite systems, 1981, chapter 4), which makes what is dropped small.
//
// Within a step few rows of the matrix change by more than matters to a preconditioner. A row of the factor is kept while its row of the matrix is
// about what it was when it was taken, and the pivots of the rows that it subtracts are about what they were. The diagonal block tells: a contact
// that changes what couples two blocks changes as much in the diagonal blocks of both.
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
  int rows_kept() const { return rows_kept_; }  ///< by the last factor(); none of a whole factor
  /// About the inverse of the matrix times `right_side`, of which seven digits are read.
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;

  /// Which couplings it has, which decides what solve() gives, and the factor, of which the next one keeps rows.
  void exchange(Archive& archive, const BlockMatrix<N>& matrix);

  /// Gives back the memory of the factor until the next one.
  void let_go() {
    std::vector<PaddedBlock>().swap(value_);
    std::vector<PaddedBlock>().swap(taken_);
  }

  std::size_t bytes() const {
    return bytes_of(slots_, order_, row_start_, diagonal_, column_, entries_, entries_start_, value_, taken_, changed_, working_slot_, solution_);
  }
  std::size_t stored_blocks() const { return column_.size(); }

 private:
  static constexpr int lanes = 4;
  typedef float Lanes __attribute__((vector_size(lanes * sizeof(float))));
  /// Columns, padded with zeros to a register of four that every processor has.
  struct PaddedBlock {
    static_assert(N <= lanes);
    Lanes column[N];

    void exchange(Archive& archive) {
      for (Lanes& lane : column) {
        for (int k = 0; k < N; ++k) {
          float entry = lane[k];
          archive(entry);
          lane[k] = entry;
        }
      }
    }
  };

  static void subtract_product(const PaddedBlock& left, const PaddedBlock& right, PaddedBlock& target);
  static PaddedBlock product(const PaddedBlock& left, const PaddedBlock& right);
  static PaddedBlock padded(const typename BlockMatrix<N>::Block& block);
  static bool invert(PaddedBlock& pivot);
  /// Whether an entry has changed by more than kept_change over the root of the weights of its row and column.
  static bool has_changed(const PaddedBlock& before, const PaddedBlock& now, const Lanes& weight);
  /// Sizes of those of row i when it was taken.
  Lanes diagonal_entries(int i) const;
  /// Whether row i of the factor is that of a row of the matrix which has hardly changed since.
  bool is_as_taken(const BlockMatrix<N>& matrix, int i) const;
  bool subtracts_changed_row(int i) const;
  void take_row(const BlockMatrix<N>& matrix, int i);
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
  std::vector<PaddedBlock> value_;  ///< none before the first factor() of a pattern
  std::vector<PaddedBlock> taken_;  ///< by places in the factor: diagonal block of the matrix that the row was worked out from
  std::vector<char> changed_;       ///< by places in the factor: whether the row is another one than in the factor before
  int rows_kept_ = 0;
  std::vector<int> working_slot_;        ///< of a column in the row under work; -1 where it has none
  mutable std::vector<Lanes> solution_;  ///< a block row each, in the factor's order
};

extern template class IncompleteLu<3>;

}  // namespace openclose
