#include "openclose/linear/weak_couplings.h"

namespace openclose {
namespace {

/// [-] Entries of a weak coupling are smaller than this times the root of the product of the diagonal entries of their row and column. In a failing
/// slope couplings over edges have more than 3e-2, those over corners less than 1e-3.
constexpr double weak_coupling = 1e-3;

bool is_weak(const BlockMatrix& matrix, int row, int slot) {
  const auto rows = matrix.value(matrix.diagonal(row)).diagonal().cwiseAbs();
  const auto columns = matrix.value(matrix.diagonal(matrix.column(slot))).diagonal().cwiseAbs();
  const auto& value = matrix.value(slot);
  return (value.cwiseAbs2().array() <= weak_coupling * weak_coupling * (rows * columns.transpose()).array()).all() && !value.isZero(0.0);
}

}  // namespace

std::vector<char> factored_slots(const BlockMatrix& matrix, Factoring factoring) {
  std::vector<char> slots(matrix.row_start(matrix.rows()), factoring == Factoring::whole);
  if (factoring == Factoring::whole) return slots;
  for (int i = 0; i < matrix.rows(); ++i) {
    slots[matrix.diagonal(i)] = true;
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) {
      if (!slots[s] && !is_weak(matrix, i, s)) slots[s] = slots[matrix.find(matrix.column(s), i)] = true;
    }
  }
  return slots;
}

RowGraph graph_of(const BlockMatrix& matrix, const std::vector<char>& slots) {
  RowGraph graph;
  graph.start.reserve(matrix.rows() + 1);
  graph.neighbour.reserve(slots.size());
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) {
      if (slots[s] && matrix.column(s) != i) graph.neighbour.push_back(matrix.column(s));
    }
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace openclose
