// Couplings that a factor can do without: blocks that touch at a corner share a contact of millimetres beside edges of metres. In a grid of joints
// they are a third of all couplings and, with the fill that they bring, half of the work of a factorisation.
#pragma once

#include <vector>

#include "openclose/linear/block_matrix.h"

namespace openclose {

/// What is factored of a matrix.
enum class Factoring {
  whole,   ///< everything
  needed,  ///< rows that have changed, without weak couplings, for which the solution is refined
};

/// Of every slot whether the factor gets it. Without weak couplings: the diagonal, and those of which an entry of theirs or of the transposed one is
/// large against the diagonal entries of its row and column, or which are zero, since nobody knows how strong they will be.
std::vector<char> factored_slots(const BlockMatrix& matrix, Factoring factoring);

/// The neighbours of each row of a symmetric pattern, without the row itself: those of row i are neighbour[start[i]] to neighbour[start[i + 1] - 1].
struct RowGraph {
  std::vector<int> start{0};
  std::vector<int> neighbour;
  int rows() const { return static_cast<int>(start.size()) - 1; }
};

/// The couplings of these slots.
RowGraph graph_of(const BlockMatrix& matrix, const std::vector<char>& slots);

}  // namespace openclose
