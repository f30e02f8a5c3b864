// Which blocks of L and U a factor has, in which order its rows are eliminated and which of them may be at the same time: what follows from the
// pattern of a matrix alone.
//
// The order is that of approximate minimum degree (P. R. Amestoy, T. A. Davis, I. S. Duff 1996; Eigen's implementation) on the graph of the blocks,
// for each connected part of it by itself.
//
// The rows above that row i subtracts lie below it in the elimination tree (J. W. H. Liu, The role of elimination trees in sparse factorization, SIAM
// J. Matrix Anal. Appl. 11 (1990)). Large systems are therefore cut into subtrees, which do not depend on each other, and the rows where these meet,
// the top. A row of the top subtracts those of the subtrees first and then, panel by panel, those of the top; with one panel done, the rows of all
// later ones can subtract it at the same time. The cut depends on the pattern alone, so that the number of threads changes no digit.
//
// Some couplings a factor can do without: blocks that touch at a corner share a contact of millimetres beside edges of metres. In a grid of joints
// they are a third of all couplings and, with the fill that they bring, half of the work of a factorisation.
#pragma once

#include <optional>
#include <vector>

#include "openclose/core/archive.h"
#include "openclose/linear/block_matrix.h"

namespace openclose {

struct RowFactor;

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

/// The place of each row in an order of the rows.
std::vector<int> places_in(const std::vector<int>& order);

/// Writes or reads the slots that a factor has; none where it is that of an earlier pattern.
/// \param slots  of a factor of this matrix's pattern, if it is `known`
std::optional<std::vector<char>> exchange_slots(Archive& archive, const BlockMatrix& matrix, bool known, std::vector<char> slots);

/// A block of the matrix that is not in the factor.
struct LeftOut {
  int slot, row, column;  ///< in the matrix
};

/// Lays the factor out for a matrix of this pattern. Its numbers are the caller's to make room for.
/// \param slots     of the matrix: whether the factor gets them
/// \param left_out  becomes those that it does not
void plan_factor(const BlockMatrix& matrix, const std::vector<char>& slots, RowFactor& factor, std::vector<LeftOut>& left_out);

}  // namespace openclose
