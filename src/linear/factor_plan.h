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
#pragma once

#include <vector>

#include "openclose/linear/row_factor.h"
#include "openclose/linear/weak_couplings.h"

namespace openclose {

/// A block of the matrix that is not in the factor.
struct LeftOut {
  int slot, row, column;  ///< in the matrix
};

/// Lays the factor out for a matrix of this pattern. Its numbers are the caller's to make room for.
/// \param slots     of the matrix: whether the factor gets them
/// \param left_out  becomes those that it does not
void plan_factor(const BlockMatrix& matrix, const std::vector<char>& slots, RowFactor& factor, std::vector<LeftOut>& left_out);

}  // namespace openclose
