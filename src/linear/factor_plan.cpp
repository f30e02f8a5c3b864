#include "openclose/linear/factor_plan.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <span>
#include <utility>

#include "openclose/core/parallel.h"
#include "openclose/linear/row_factor.h"

namespace openclose {
namespace {

/// [-] Rows from which on the work is cut into parts. Below, a part takes less than the few microseconds it takes to hand it over.
constexpr int smallest_shared_system = 1000;
/// As many parts there are of the subtrees, the work of each of which is at most the whole over this: that leaves parts to choose from for as many
/// threads as there may be.
constexpr int subtree_parts = 2 * most_threads;
/// [-] Rows of the top that are eliminated one after the other before the others go on: a part of the work small against the rest, and large against
/// a call upon the threads.
constexpr int panel_rows = 32;
/// [-] Entries of a weak coupling are smaller than this times the root of the product of the diagonal entries of their row and column. In a failing
/// slope couplings over edges have more than 3e-2, those over corners less than 1e-3.
constexpr double weak_coupling = 1e-3;

bool is_weak(const BlockMatrix& matrix, int row, int slot) {
  const auto rows = matrix.value(matrix.diagonal(row)).diagonal().cwiseAbs();
  const auto columns = matrix.value(matrix.diagonal(matrix.column(slot))).diagonal().cwiseAbs();
  const auto& value = matrix.value(slot);
  return (value.cwiseAbs2().array() <= weak_coupling * weak_coupling * (rows * columns.transpose()).array()).all() && !value.isZero(0.0);
}

class Planner {
 public:
  explicit Planner(RowFactor& factor) : factor_(factor) {}

  void plan(const BlockMatrix& matrix, const std::vector<char>& slots, std::vector<LeftOut>& left_out) {
    const RowGraph graph = graph_of(matrix, slots);
    order_rows(graph);
    lay_out(find_upper_pattern(graph));
    cut_into_subtrees();
    find_entries(matrix, slots, left_out);
  }

 private:
  /// The connected parts of the graph one after another, each ordered for itself: in what is not cut into subtrees none of its numbers depends on
  /// what else is in the system.
  void order_rows(const RowGraph& graph) {
    const int rows = graph.rows();
    factor_.order.clear();
    place_.assign(rows, -1);  // without a place yet
    for (int first = 0; first < rows; ++first) {
      if (place_[first] < 0) order_part(graph, connected_rows(graph, first));
    }
    place_ = places_in(factor_.order);
  }

  /// In ascending order; their places become those in the list.
  std::vector<int> connected_rows(const RowGraph& graph, int first) {
    std::vector<int> part = {first};
    place_[first] = 0;
    for (std::size_t next = 0; next < part.size(); ++next) {
      for (int k = graph.start[part[next]]; k < graph.start[part[next] + 1]; ++k) {
        const int neighbour = graph.neighbour[k];
        if (place_[neighbour] >= 0) continue;
        place_[neighbour] = 0;
        part.push_back(neighbour);
      }
    }
    std::sort(part.begin(), part.end());
    for (std::size_t i = 0; i < part.size(); ++i) place_[part[i]] = static_cast<int>(i);
    return part;
  }

  void order_part(const RowGraph& graph, const std::vector<int>& part) {
    const int rows = static_cast<int>(part.size());
    if (rows <= 2) {  // no order fills more than another
      factor_.order.insert(factor_.order.end(), part.begin(), part.end());
      return;
    }
    // One half, from the diagonal on.
    Eigen::SparseMatrix<float> pattern(rows, rows);
    const auto after = [&](int i) {
      const int *const begin = graph.neighbour.data() + graph.start[part[i]], *const end = graph.neighbour.data() + graph.start[part[i] + 1];
      return std::span(std::upper_bound(begin, end, part[i]), end);
    };
    for (int i = 0; i < rows; ++i) pattern.outerIndexPtr()[i + 1] = pattern.outerIndexPtr()[i] + 1 + static_cast<int>(after(i).size());
    pattern.resizeNonZeros(pattern.outerIndexPtr()[rows]);
    std::fill(pattern.valuePtr(), pattern.valuePtr() + pattern.nonZeros(), 1.0F);
    for (int i = 0; i < rows; ++i) {
      int* column = pattern.innerIndexPtr() + pattern.outerIndexPtr()[i];
      *column++ = i;
      for (const int j : after(i)) *column++ = place_[j];
    }
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
    Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), permutation);
    for (int i = 0; i < rows; ++i) factor_.order.push_back(part[permutation.indices()[i]]);
  }

  /// Of rows one after another: what each has above the diagonal, in any order.
  struct UpperPattern {
    std::vector<int> start, column;
    std::span<const int> row(int i) const { return {column.data() + start[i], column.data() + start[i + 1]}; }
  };

  /// In the new order. Each row hands its pattern down to the first row it meets.
  UpperPattern find_upper_pattern(const RowGraph& graph) const {
    const int rows = graph.rows();
    UpperPattern upper;
    upper.start.assign(1, 0);
    std::vector<int> first_child(rows, -1), next_child(rows, -1), seen(rows, -1);
    for (int i = 0; i < rows; ++i) {
      seen[i] = i;
      const auto take = [&](int j) {
        if (j <= i || seen[j] == i) return;
        seen[j] = i;
        upper.column.push_back(j);
      };
      for (int k = graph.start[factor_.order[i]]; k < graph.start[factor_.order[i] + 1]; ++k) take(place_[graph.neighbour[k]]);
      for (int child = first_child[i]; child >= 0; child = next_child[child]) {
        for (int k = upper.start[child]; k < upper.start[child + 1]; ++k) take(upper.column[k]);
      }
      upper.start.push_back(static_cast<int>(upper.column.size()));
      if (upper.row(i).empty()) continue;
      const int parent = *std::ranges::min_element(upper.row(i));
      next_child[i] = std::exchange(first_child[parent], i);
    }
    return upper;
  }

  /// Rows of L, diagonal and U one after another in one array.
  void lay_out(const UpperPattern& upper) {
    const int rows = static_cast<int>(upper.start.size()) - 1;
    std::vector<int> below(rows, 0), place(rows);  // of L: numbers in a row; of L, then of U: where the next one goes
    for (const int j : upper.column) ++below[j];
    factor_.row_start.resize(rows + 1);
    factor_.diagonal.resize(rows);
    factor_.column.resize(rows + 2 * upper.column.size());
    int end = 0;
    for (int i = 0; i < rows; ++i) {
      factor_.row_start[i] = place[i] = end;
      factor_.diagonal[i] = end + below[i];
      factor_.column[factor_.diagonal[i]] = i;
      end = factor_.diagonal[i] + 1 + static_cast<int>(upper.row(i).size());
    }
    factor_.row_start[rows] = end;
    // Row by row, so that each list is in ascending order.
    for (int i = 0; i < rows; ++i) {
      for (const int j : upper.row(i)) factor_.column[place[j]++] = i;
    }
    for (int i = 0; i < rows; ++i) ++place[i];  // over the diagonal
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.diagonal[i]; ++s) factor_.column[place[factor_.column[s]]++] = i;
    }
    factor_.solution.resize(rows);
    factor_.size.resize(rows);
  }

  /// Products of blocks in the elimination of row i and all below it in the tree.
  std::vector<double> work_of_subtrees() const {
    const int rows = factor_.rows();
    std::vector<double> work(rows, 0.0);
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.diagonal[i]; ++s)
        work[i] += factor_.row_start[factor_.column[s] + 1] - factor_.diagonal[factor_.column[s]];
      work[i] += 1.0;
      if (factor_.parent(i) >= 0) work[factor_.parent(i)] += work[i];
    }
    return work;
  }

  void cut_into_subtrees() {
    const int rows = factor_.rows();
    factor_.panel.assign(rows, 0);
    factor_.panels.clear();
    factor_.subtrees.assign(1, {});
    std::vector<int> part_of(rows, 0);
    if (rows >= smallest_shared_system) part_of = share_out_subtrees();
    for (int i = 0, top = 0; i < rows; ++i) {
      if (part_of[i] >= 0) {
        factor_.subtrees[part_of[i]].push_back(i);
        continue;
      }
      if (top % panel_rows == 0) factor_.panels.emplace_back();
      factor_.panels.back().push_back(i);
      factor_.panel[i] = 1 + top++ / panel_rows;
    }
  }

  /// The part of each row, -1 in the top; large subtrees are dealt out first, each to the part with the least work.
  std::vector<int> share_out_subtrees() {
    const int rows = factor_.rows();
    const std::vector<double> work = work_of_subtrees();
    double whole = 0.0;
    for (int i = 0; i < rows; ++i) whole += factor_.parent(i) < 0 ? work[i] : 0.0;
    const double most = whole / subtree_parts;
    std::vector<int> part_of(rows, -1), roots;
    for (int i = 0; i < rows; ++i) {
      if (work[i] <= most && (factor_.parent(i) < 0 || work[factor_.parent(i)] > most)) roots.push_back(i);
    }
    std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return work[a] > work[b]; });
    factor_.subtrees.assign(subtree_parts, {});
    std::vector<double> given(subtree_parts, 0.0);
    for (int root : roots) {
      const auto least = std::min_element(given.begin(), given.end());
      *least += work[root];
      part_of[root] = static_cast<int>(least - given.begin());
    }
    for (int i = rows - 1; i >= 0; --i) {
      if (work[i] <= most && factor_.parent(i) >= 0 && work[factor_.parent(i)] <= most) part_of[i] = part_of[factor_.parent(i)];
    }
    return part_of;
  }

  /// Which blocks of the matrix go where.
  /// \param slots  of the matrix: whether the factor gets them
  void find_entries(const BlockMatrix& matrix, const std::vector<char>& slots, std::vector<LeftOut>& left_out) {
    const int rows = matrix.rows();
    factor_.entries.clear();
    factor_.entries_start.assign(1, 0);
    left_out.clear();
    std::vector<int> place(rows);
    for (int i = 0; i < rows; ++i) {
      for (int s = factor_.row_start[i]; s < factor_.row_start[i + 1]; ++s) place[factor_.column[s]] = s;
      const int row = factor_.order[i];
      for (int s = matrix.row_start(row); s < matrix.row_start(row + 1); ++s) {
        if (slots[s]) {
          factor_.entries.push_back({s, place[place_[matrix.column(s)]], place_[matrix.column(s)]});
        } else {
          left_out.push_back({s, row, matrix.column(s)});
        }
      }
      factor_.entries_start.push_back(static_cast<int>(factor_.entries.size()));
    }
  }

  RowFactor& factor_;
  std::vector<int> place_;  ///< in the factor, of a row of the matrix
};

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

std::vector<int> places_in(const std::vector<int>& order) {
  std::vector<int> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<int>(i);
  return place;
}

std::optional<std::vector<char>> exchange_slots(Archive& archive, const BlockMatrix& matrix, bool known, std::vector<char> slots) {
  archive(known);
  if (!known) return std::nullopt;
  archive(slots);
  archive.require(slots.size() == static_cast<std::size_t>(matrix.row_start(matrix.rows())), "the saved state has a factor of another matrix");
  return slots;
}

void plan_factor(const BlockMatrix& matrix, const std::vector<char>& slots, RowFactor& factor, std::vector<LeftOut>& left_out) {
  Planner(factor).plan(matrix, slots, left_out);
}

}  // namespace openclose
