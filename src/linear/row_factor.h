// Rows of a block LU factor: how they are laid out, and the loops over their blocks. What is in which row is factor_plan.h's, when a row is done anew
// block_lu.cpp's to say.
#pragma once

#include <vector>

#include "openclose/core/memory.h"
#include "openclose/core/packs.h"
#include "openclose/linear/block_matrix.h"

namespace openclose {

/// Three by three, row by row. Each row is padded to four numbers, one register; the padding of products is that of their right factor, and nobody
/// reads it.
struct alignas(Lanes) PaddedBlock {
  static_assert(dofs < batch_size);
  Lanes row[dofs];
  PaddedBlock() {}  // nothing: a factor is written before it is read
};

struct alignas(Lanes) PaddedVector {
  Lanes entries;
};

/// A block of the matrix that goes into the factor.
struct Entry {
  int slot;    ///< in the matrix
  int target;  ///< slot in the factor
  int column;  ///< in the factor
};

/// L, inverted diagonal and U (multiplied by it) on their pattern, and the way there from the matrix.
struct RowFactor {
  std::vector<int> order;  ///< row of the matrix at a place in the factor
  std::vector<int> row_start, diagonal, column;
  std::vector<Entry> entries;              ///< in the order in which elimination meets them
  std::vector<int> entries_start;          ///< where in `entries` a row begins
  std::vector<BlockMatrix::Block> taken;   ///< of the entries, from the matrix: the factor is that of these
  std::vector<PaddedVector> scale;         ///< of rows: sizes of the diagonal entries in `taken`
  std::vector<char> stale;                 ///< of rows: to be eliminated anew
  std::vector<double> size;                ///< of rows: square of the pivot's norm before the elimination
  std::vector<int> panel;                  ///< of rows: 0 in a subtree; of the top from 1 on
  std::vector<std::vector<int>> subtrees;  ///< rows of one or several subtrees each; all rows of a small system
  std::vector<std::vector<int>> panels;    ///< rows of the top
  std::vector<PaddedBlock> value;
  std::vector<PaddedVector> solution;  ///< a block row each, in the factor's order

  int rows() const { return static_cast<int>(diagonal.size()); }
  std::size_t bytes() const {
    std::size_t lists = bytes_of(subtrees, panels);
    for (const auto* parts : {&subtrees, &panels}) {
      for (const std::vector<int>& part : *parts) lists += bytes_of(part);
    }
    return lists + bytes_of(order, row_start, diagonal, column, entries, entries_start, taken, scale, stale, size, panel, value, solution);
  }
  /// The row that is the first to subtract row i; -1 for a root.
  int parent(int i) const {
    const int next = diagonal[i] + 1;
    return next < row_start[i + 1] ? column[next] : -1;
  }
};

/// Takes the rows that are stale, because they or rows that they subtract have changed, from the matrix. The number of those that are not.
/// \param change  [-] of the root of the diagonal entries of its row and column, by which an entry may have changed in a row that is kept
int take_changes(const BlockMatrix& matrix, RowFactor& f, double change);
/// Row i has been taken: how large its diagonal entries are.
void note_scale(RowFactor& f, int i);
/// Subtracts a panel from stale rows of later ones.
/// \param place  room for the slot of each column in the row
void advance(RowFactor& f, const std::vector<int>& rows, int panel, int* place);
/// Ends the elimination of stale rows of a panel, which have subtracted all before it. False if a pivot has lost its digits.
bool eliminate_rows(RowFactor& f, const std::vector<int>& rows, int panel, int* place);
void substitute_forward(RowFactor& f, const std::vector<int>& rows, const double* right_side);
void substitute_back(RowFactor& f, const std::vector<int>& rows, double* x);

}  // namespace openclose
