// What a factorisation of a sparse matrix with symmetric pattern knows before it has seen a number: the order of the rows, the supernodes (rows that
// are eliminated together, as one dense matrix, because what they leave behind couples the same rows) and the tree that they form.
//
// Elimination tree: J. W. H. Liu, The role of elimination trees in sparse factorization, SIAM J. Matrix Anal. Appl. 11 (1990). Supernodes are united
// with their parent where this costs few zeros: C. Ashcraft, R. Grimes, The influence of relaxed supernode partitions, ACM TOMS 15 (1989).
#pragma once

#include <vector>

#include "openclose/core/archive.h"
#include "openclose/core/memory.h"

namespace openclose {

/// The neighbours of each row of a symmetric pattern, without the row itself: those of row i are neighbour[start[i]] to neighbour[start[i + 1] - 1].
struct RowGraph {
  std::vector<int> start{0};
  std::vector<int> neighbour;
  int rows() const { return static_cast<int>(start.size()) - 1; }
};

/// Supernodes are numbered so that children come before their parents, in postorder. Rows are named by their places in the elimination.
struct Elimination {
  std::vector<int> row_at;      ///< row of the matrix that is eliminated at a place
  std::vector<int> place_of;    ///< and back
  std::vector<int> first;       ///< first place of each supernode; one entry more than there are supernodes
  std::vector<int> parent;      ///< -1 for a root
  std::vector<int> rest_start;  ///< where in `rest` the list of a supernode begins; one entry more
  std::vector<int> rest;        ///< places after the supernode's own that it couples, ascending

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f] = *this;
    archive(a, b, c, d, e, f);
  }

  std::size_t bytes() const { return bytes_of(row_at, place_of, first, parent, rest_start, rest); }
  int supernodes() const { return static_cast<int>(parent.size()); }
  int own(int s) const { return first[s + 1] - first[s]; }
  int rest_size(int s) const { return rest_start[s + 1] - rest_start[s]; }
};

/// \param order  the rows in the order in which they should be eliminated; children may change places with their siblings
Elimination plan_elimination(const RowGraph& graph, const std::vector<int>& order);

}  // namespace openclose
