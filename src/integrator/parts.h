// Parts of a system of blocks that are solved for themselves while all other blocks stay where they are.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "openclose/core/memory.h"

namespace openclose {

struct Part {
  std::vector<int> rows;      ///< of the system, ascending
  std::vector<int> contacts;  ///< all that touch one of them, ascending
};

/// Those of a vector with three numbers a row.
Eigen::VectorXd rows_of(const Eigen::VectorXd& whole, const std::vector<int>& rows);

/// Rows with more than a part of the largest residual, and those with more than that part of it, and so on as long as there are few.
/// \param largest  of the residuals; infinite: none
/// \param end      rows with less are never among them
std::vector<int> most_unbalanced(const std::vector<double>& residuals, double largest, double end, double part, int few);

/// Which contacts join which blocks.
class Neighbourhood {
 public:
  /// \param rows_of  rows of the two blocks of contact c; those of fixed blocks are `rows` or more
  template <class RowsOf>
  void build(int rows, std::size_t contacts, const RowsOf& rows_of);
  void clear() { first_.clear(); }
  /// Those it was built for, -1 for none.
  int rows() const { return static_cast<int>(first_.size()) - 1; }
  std::size_t bytes() const { return bytes_of(first_, ends_); }

  /// The seeds and all blocks that are at most so many contacts away from one of them, in as many parts as no contact joins: the small ones first.
  /// \param seeds    rows, each once
  /// \param largest  parts of more rows are left out
  std::vector<Part> parts(const std::vector<int>& seeds, int rings, int largest) const;

 private:
  struct End {
    int contact, other;  ///< row of the block on the other side
  };

  /// The seeds and the rings around them; `ring` is that of each row, -1 outside of all.
  std::vector<int> grow(const std::vector<int>& seeds, int rings, std::vector<int>& ring) const;
  /// All that hangs together with a row inside of the rings, and takes it out of them.
  Part take(int first, std::vector<int>& ring) const;

  std::vector<int> first_;  ///< of ends_, by row
  std::vector<End> ends_;
};

template <class RowsOf>
void Neighbourhood::build(int rows, std::size_t contacts, const RowsOf& rows_of) {
  first_.assign(rows + 1, 0);
  for (std::size_t c = 0; c < contacts; ++c) {
    const auto [i, j] = rows_of(c);
    if (i < rows) ++first_[i];
    if (j < rows) ++first_[j];
  }
  int end = 0;
  for (int& first : first_) first = end += first;
  resize_closely(ends_, end);
  // From the back, which leaves each row its first place.
  for (std::size_t c = contacts; c-- > 0;) {
    const auto [i, j] = rows_of(c);
    if (i < rows) ends_[--first_[i]] = {static_cast<int>(c), j};
    if (j < rows) ends_[--first_[j]] = {static_cast<int>(c), i};
  }
}

}  // namespace openclose
