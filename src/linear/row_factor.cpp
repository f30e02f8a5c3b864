#include "openclose/linear/row_factor.h"

#include <cmath>

#include "openclose/core/lane_memory.h"

namespace openclose {
namespace {

/// [-] A diagonal block whose norm has shrunk by more than this, or whose determinant is smaller than this times the product of its columns' norms,
/// has lost more digits than a Newton step can do without.
constexpr double smallest_pivot = 1e-11;

/// The entries of a block one by one, as they multiply the rows of another.
struct Multipliers {
  double entry[dofs][dofs];
  OPENCLOSE_KERNEL explicit Multipliers(const PaddedBlock& block) {
    for (int r = 0; r < dofs; ++r) {
      for (int c = 0; c < dofs; ++c) entry[r][c] = block.row[r][c];
    }
  }
  OPENCLOSE_KERNEL void subtract_row_of_product(int r, const PaddedBlock& right, Lanes& target) const {
    Lanes sum = entry[r][0] * right.row[0];
    for (int c = 1; c < dofs; ++c) sum += entry[r][c] * right.row[c];
    target -= sum;
  }
  OPENCLOSE_KERNEL void replace_by_product(PaddedBlock& right) const {
    PaddedBlock result;
    for (int r = 0; r < dofs; ++r) {
      result.row[r] = entry[r][0] * right.row[0];
      for (int c = 1; c < dofs; ++c) result.row[r] += entry[r][c] * right.row[c];
    }
    right = result;
  }
};

OPENCLOSE_KERNEL void subtract_row(RowFactor& f, int s, int k, const int* place) {
  const Multipliers left(f.value[s]);
  for (int u = f.diagonal[k] + 1; u < f.row_start[k + 1]; ++u) {
    const PaddedBlock& right = f.value[u];
    PaddedBlock& target = f.value[place[f.column[u]]];
    for (int r = 0; r < dofs; ++r) left.subtract_row_of_product(r, right, target.row[r]);
  }
}

/// Subtracts from row i what the rows of a panel above it contribute.
/// \param place  room for the slot of each column in the row
OPENCLOSE_KERNEL void subtract_panel(RowFactor& f, int i, int panel, int* place) {
  for (int s = f.row_start[i]; s < f.row_start[i + 1]; ++s) place[f.column[s]] = s;
  for (int s = f.row_start[i]; s < f.diagonal[i]; ++s) {
    const int k = f.column[s];
    if (f.panel[k] != panel) continue;
    subtract_row(f, s, k, place);
  }
}

/// A block of the matrix, column by column. The padding repeats the last column.
OPENCLOSE_KERNEL void pad(const double* block, PaddedBlock& padded) {
  const Lanes first = lanes::load(block), next = lanes::load(block + 3), last = lanes::load(block + 5);  // of this the numbers from one on
  const Lanes even = __builtin_shufflevector(first, next, 0, 4, 2, 6), odd = __builtin_shufflevector(first, next, 1, 5, 3, 7);
  padded.row[0] = __builtin_shufflevector(even, last, 0, 1, 5, 5);
  padded.row[1] = __builtin_shufflevector(odd, last, 0, 1, 6, 6);
  padded.row[2] = __builtin_shufflevector(even, last, 2, 3, 7, 7);
}

/// Three rows of a block by columns.
struct Columns {
  Lanes first, next, last;

  OPENCLOSE_KERNEL explicit Columns(const Lanes (&rows)[3]) {
    const Lanes even = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6), odd = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
    first = __builtin_shufflevector(even, rows[2], 0, 1, 4, 5);
    next = __builtin_shufflevector(odd, rows[2], 0, 1, 5, 6);
    last = __builtin_shufflevector(even, rows[2], 2, 3, 6, 6);
  }
};

OPENCLOSE_KERNEL double sum_of_three(const Lanes& x) {
  return x[0] + x[1] + x[2];
}

OPENCLOSE_KERNEL Lanes squares_of_columns(const PaddedBlock& block) {
  Lanes sum = block.row[0] * block.row[0];
  for (int r = 1; r < dofs; ++r) sum += block.row[r] * block.row[r];
  return sum;
}

OPENCLOSE_KERNEL Lanes cross_product(const Lanes& a, const Lanes& b) {
  return __builtin_shufflevector(a, a, 1, 2, 0, 3) * __builtin_shufflevector(b, b, 2, 0, 1, 3) -
         __builtin_shufflevector(a, a, 2, 0, 1, 3) * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}

/// Replaces the pivot by its inverse; false if it has none worth the name.
/// \param original_size  square of the block's norm before the elimination
OPENCLOSE_KERNEL bool invert(PaddedBlock& pivot, double original_size) {
  const Lanes squares = squares_of_columns(pivot);
  const Lanes cofactors[dofs] = {cross_product(pivot.row[1], pivot.row[2]), cross_product(pivot.row[2], pivot.row[0]),
                                 cross_product(pivot.row[0], pivot.row[1])};
  const double determinant = sum_of_three(pivot.row[0] * cofactors[0]), columns = squares[0] * squares[1] * squares[2];
  if (!(sum_of_three(squares) > smallest_pivot * smallest_pivot * original_size)) return false;
  if (!(determinant * determinant > smallest_pivot * smallest_pivot * columns)) return false;
  const Columns rows(cofactors);
  const double factor = 1.0 / determinant;
  pivot.row[0] = rows.first * factor;
  pivot.row[1] = rows.next * factor;
  pivot.row[2] = rows.last * factor;
  return std::isfinite(sum_of_three(squares_of_columns(pivot)));
}

/// The nine entries of a block, column by column, as two registers and one number.
struct Entries {
  Lanes first, next;
  double last;

  OPENCLOSE_KERNEL explicit Entries(const double* block)
      : first(lanes::load(block)), next(lanes::load(block + batch_size)), last(block[2 * batch_size]) {}
  OPENCLOSE_KERNEL Entries(const Lanes& rows, const Lanes& columns)
      : first(__builtin_shufflevector(rows, rows, 0, 1, 2, 0) * __builtin_shufflevector(columns, columns, 0, 0, 0, 1)),
        next(__builtin_shufflevector(rows, rows, 1, 2, 0, 1) * __builtin_shufflevector(columns, columns, 1, 1, 2, 2)),
        last(rows[2] * columns[2]) {}
  OPENCLOSE_KERNEL Entries& operator-=(const Entries& other) {
    first -= other.first, next -= other.next, last -= other.last;
    return *this;
  }
};

/// Whether no entry of row i has changed by more than `change` times the root of the diagonal entries of its row and column.
OPENCLOSE_KERNEL bool is_as_taken(const BlockMatrix& matrix, const RowFactor& f, int i, double change) {
  const Lanes s = change * change * f.scale[i].entries;
  auto within = s <= s;
  bool last_within = true;
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) {
    Entries difference(matrix.value(f.entries[e].slot).data());
    difference -= Entries(f.taken[e].data());
    const Entries allowed(s, f.scale[f.entries[e].column].entries);
    within &= (difference.first * difference.first <= allowed.first) & (difference.next * difference.next <= allowed.next);
    last_within = last_within && difference.last * difference.last <= allowed.last;
  }
  return last_within && (within[0] & within[1] & within[2] & within[3]) != 0;
}

OPENCLOSE_KERNEL void take_row(const BlockMatrix& matrix, RowFactor& f, int i) {
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) f.taken[e] = matrix.value(f.entries[e].slot);
  note_scale(f, i);
}

/// Lays row i of the matrix into its slots.
OPENCLOSE_KERNEL void lay_row(RowFactor& f, int i) {
  for (int s = f.row_start[i]; s < f.row_start[i + 1]; ++s) {
    for (Lanes& row : f.value[s].row) row = Lanes{};
  }
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) pad(f.taken[e].data(), f.value[f.entries[e].target]);
  f.size[i] = sum_of_three(squares_of_columns(f.value[f.diagonal[i]]));
}

/// `sum` less the sum over the slots of value times solution. The solution that is found last, on which everything waits, comes last.
/// \tparam direction  1 or -1: from slot to slot
template <int direction>
OPENCLOSE_KERNEL Lanes less_product(const RowFactor& f, int first, int end, const Lanes& sum) {
  Lanes products[dofs]{};
  for (int s = first; s != end; s += direction) {
    const Lanes& x = f.solution[f.column[s]].entries;
    for (int r = 0; r < dofs; ++r) products[r] += f.value[s].row[r] * x;
  }
  const Columns columns(products);
  return sum - columns.first - columns.next - columns.last;
}

}  // namespace

void note_scale(RowFactor& f, int i) {
  for (int e = f.entries_start[i]; e < f.entries_start[i + 1]; ++e) {
    if (f.entries[e].column != i) continue;
    for (int r = 0; r < dofs; ++r) f.scale[i].entries[r] = std::abs(f.taken[e](r, r));
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO int take_changes(const BlockMatrix& matrix, RowFactor& f, double change) {
  int kept = 0;
  for (int i = 0; i < f.rows(); ++i) {
    if (!f.stale[i] && is_as_taken(matrix, f, i, change)) {
      ++kept;
      continue;
    }
    f.stale[i] = true;
    take_row(matrix, f, i);
    const int parent = f.parent(i);
    if (parent >= 0) f.stale[parent] = true;
  }
  return kept;
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void advance(RowFactor& f, const std::vector<int>& rows, int panel, int* place) {
  for (int i : rows) {
    if (!f.stale[i]) continue;
    if (panel == 0) lay_row(f, i);
    subtract_panel(f, i, panel, place);
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO bool eliminate_rows(RowFactor& f, const std::vector<int>& rows, int panel, int* place) {
  for (int i : rows) {
    if (!f.stale[i]) continue;
    if (panel == 0) lay_row(f, i);
    subtract_panel(f, i, panel, place);
    if (!invert(f.value[f.diagonal[i]], f.size[i])) return false;
    const Multipliers inverse(f.value[f.diagonal[i]]);
    for (int s = f.diagonal[i] + 1; s < f.row_start[i + 1]; ++s) inverse.replace_by_product(f.value[s]);
  }
  return true;
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void substitute_forward(RowFactor& f, const std::vector<int>& rows, const double* right_side) {
  for (int i : rows) {
    const double* const b = right_side + dofs * f.order[i];
    const Lanes sum = less_product<1>(f, f.row_start[i], f.diagonal[i], Lanes{b[0], b[1], b[2], 0.0});
    Lanes products[dofs];
    for (int r = 0; r < dofs; ++r) products[r] = f.value[f.diagonal[i]].row[r] * sum;
    const Columns columns(products);
    f.solution[i].entries = columns.first + columns.next + columns.last;
  }
}

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void substitute_back(RowFactor& f, const std::vector<int>& rows, double* x) {
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    const int i = *row;
    const Lanes entries = less_product<-1>(f, f.row_start[i + 1] - 1, f.diagonal[i], f.solution[i].entries);
    f.solution[i].entries = entries;
    for (int k = 0; k < dofs; ++k) x[dofs * f.order[i] + k] = entries[k];
  }
}

}  // namespace openclose
