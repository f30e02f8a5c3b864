#include "openclose/linear/incomplete.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "openclose/core/lane_memory.h"
#include "openclose/linear/packed_block.h"
#include "openclose/linear/single_matrix.h"
#include "openclose_traps.h"

namespace openclose {
namespace {

/// Entries of the matrix have level 0, fill from two of levels a and b has a + b + 1. Iterations to 1e-6 and milliseconds in all, slopes in motion at
/// 10 ms, in this order of the rows, when factor and GMRES were in double precision:
///
///     level                0         1         2         3
///      4,568 blocks    24  7.2   17  5.6   10  5.3    8  6.1
///      9,745 blocks    34 24.5   25 21.5   14 15.4   11 13.1
///     49,066 blocks    47  253   38  202   18  101   15  114
constexpr int level_of_low_fill = 2;

/// [-] Entries of the diagonal block of a row, and of the inverse of its pivot, may have changed by this part of the root of the diagonal entries of
/// their row and column before the row is done again. 20 to 60 steps of a failing slope of 9,745 blocks do 0.34 of the rows again with 1e-3, 0.32
/// with 1e-2, 0.27 with 5e-2, 0.18 with 0.2; iterations grow by 0.0, 0.0, 0.4 and 9 %.
constexpr float kept_change = 1e-2f;

/// [-] What has no larger entries, beside diagonal entries of one, is kept as zero: its scale would have no digits.
constexpr float negligible_entry = 1e-30f;

/// Four consecutive entries of a block in single precision.
OPENCLOSE_KERNEL FloatLanes four(const double* entry) {
  return __builtin_convertvector(lanes::load(entry), FloatLanes);
}

/// Places of the rows by reverse Cuthill-McKee: by distance from a row at the rim, the neighbours of each row by their number of neighbours.
std::vector<int> reverse_cuthill_mckee(const RowGraph& graph) {
  const int rows = graph.rows();
  const auto degree = [&](int row) { return graph.start[row + 1] - graph.start[row]; };
  std::vector<int> order, mark(rows, 0);
  int round = 0;
  /// Everything that hangs together with `first`, from there on; a row that is marked with this round is not taken.
  const auto walk = [&](int first, std::vector<int>& list) {
    ++round;
    mark[first] = round;
    std::size_t next = list.size();
    list.push_back(first);
    for (; next < list.size(); ++next) {
      const auto begin = static_cast<std::ptrdiff_t>(list.size());
      for (int k = graph.start[list[next]], end = graph.start[list[next] + 1]; k < end; ++k) {
        const int neighbour = graph.neighbour[k];
        if (mark[neighbour] == round) continue;
        mark[neighbour] = round;
        list.push_back(neighbour);
      }
      std::stable_sort(list.begin() + begin, list.end(), [&](int a, int b) { return degree(a) < degree(b); });
    }
  };
  std::vector<int> part;
  for (int first = 0; first < rows; ++first) {
    if (mark[first] != 0) continue;
    part.clear();
    walk(first, part);
    walk(part.back(), order);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// The rows of an order from both ends at a time, one of each half in turn, and what joins the halves at last: neither of two consecutive rows waits
/// for the other where the factor is solved with, which takes 0.7 of the time then, and elimination from the ends on drops no more than from one.
/// (With as many parts from one end on iterations grow by a fifth, with four of them by a half.)
std::vector<int> from_both_ends(const RowGraph& graph, const std::vector<int>& order) {
  const int rows = graph.rows(), middle = rows / 2;
  std::vector<char> is_in_first_half(rows, 0);
  for (int i = 0; i < middle; ++i) is_in_first_half[order[i]] = 1;
  const auto joins = [&](int row) {
    const auto begin = graph.neighbour.begin() + graph.start[row], end = graph.neighbour.begin() + graph.start[row + 1];
    return std::any_of(begin, end, [&](int neighbour) { return is_in_first_half[neighbour] != 0; });
  };
  std::vector<int> result, joining;
  for (int i = 0; i < rows - middle; ++i) {
    if (i < middle) result.push_back(order[i]);
    const int row = order[rows - 1 - i];
    (joins(row) ? joining : result).push_back(row);
  }
  result.insert(result.end(), joining.begin(), joining.end());
  return result;
}

/// An entry of the factor to the right of the diagonal.
struct FillEntry {
  int column, level;
};

/// The columns of one row with their levels, in ascending order, while fill comes in from the rows above.
class RowPattern {
 public:
  RowPattern(int rows, int most_fill) : most_fill_(most_fill), level_(rows, most_fill + 1) {}

  void put(int column, int level) {
    if (level > most_fill_) return;
    if (level_[column] > most_fill_) {
      waiting_.push_back(column);
      std::push_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    }
    level_[column] = std::min(level_[column], level);
  }
  bool empty() const { return waiting_.empty(); }
  FillEntry take_first() {
    std::pop_heap(waiting_.begin(), waiting_.end(), std::greater<>());
    taken_.push_back(waiting_.back());
    waiting_.pop_back();
    return {taken_.back(), level_[taken_.back()]};
  }
  void clear() {
    for (int column : taken_) level_[column] = most_fill_ + 1;
    taken_.clear();
  }

 private:
  int most_fill_;
  std::vector<int> level_;  ///< beyond the most where there is nothing
  std::vector<int> waiting_, taken_;
};

}  // namespace

IncompleteLu::IncompleteLu(Factoring factoring, Fill fill)
    : factoring_(factoring), most_fill_(fill == Fill::low ? level_of_low_fill : std::numeric_limits<int>::max() / 4) {}

bool IncompleteLu::analyse(const BlockMatrix& matrix) {
  if (version_ == matrix.pattern_version()) return false;
  plan(matrix, factored_slots(matrix, factoring_));
  return true;
}

void IncompleteLu::exchange(Archive& archive, const BlockMatrix& matrix) {
  auto slots = exchange_slots(archive, matrix, version_ == matrix.pattern_version(), slots_);
  if (!slots) return;
  if (archive.reading()) plan(matrix, std::move(*slots));
  archive(value_, worth_, taken_, scale_);
  const auto fits = [](const auto& list, std::size_t size) { return list.empty() || list.size() == size; };
  const std::size_t rows = order_.size();
  const bool is_whole = value_.empty() || (worth_.size() == rows && taken_.size() == rows && scale_.size() == batch_size * rows);
  archive.require(is_whole && fits(value_, column_.size()) && fits(worth_, rows) && fits(taken_, rows) && fits(scale_, batch_size * rows),
                  "the saved state has a factor of another matrix");
}

void IncompleteLu::plan(const BlockMatrix& matrix, std::vector<char> slots) {
  slots_ = std::move(slots);
  const int rows = matrix.rows();
  const RowGraph graph = graph_of(matrix, slots_);
  order_ = from_both_ends(graph, reverse_cuthill_mckee(graph));
  const std::vector<int> place = places_in(order_);
  row_start_.assign(1, 0);
  diagonal_.clear();
  column_.clear();
  entries_.clear();
  entries_start_.assign(1, 0);
  working_place_.assign(rows, -1);
  RowPattern pattern(rows, most_fill_);
  std::vector<std::vector<FillEntry>> right_of(rows);
  for (int i = 0; i < rows; ++i) {
    for (int s = matrix.row_start(order_[i]); s < matrix.row_start(order_[i] + 1); ++s) {
      if (slots_[s]) pattern.put(place[matrix.column(s)], 0);
    }
    while (!pattern.empty()) {
      const FillEntry entry = pattern.take_first();
      if (entry.column == i) diagonal_.push_back(static_cast<int>(column_.size()));
      if (entry.column > i) right_of[i].push_back(entry);
      if (entry.column < i) {
        for (const FillEntry& above : right_of[entry.column]) pattern.put(above.column, entry.level + above.level + 1);
      }
      working_place_[entry.column] = static_cast<int>(column_.size()) - row_start_[i];
      column_.push_back(entry.column);
    }
    pattern.clear();
    for (int s = matrix.row_start(order_[i]); s < matrix.row_start(order_[i] + 1); ++s) {
      if (slots_[s]) entries_.push_back({s, working_place_[place[matrix.column(s)]]});
    }
    entries_start_.push_back(static_cast<int>(entries_.size()));
    row_start_.push_back(static_cast<int>(column_.size()));
  }
  solution_.resize(rows);
  working_place_.assign(rows, -1);
  let_go();
  version_ = matrix.pattern_version();
}

inline IncompleteLu::PaddedBlock IncompleteLu::product(const PaddedBlock& left, const PaddedBlock& right) {
  PaddedBlock result;
  for (int c = 0; c < dofs; ++c) {
    result.column[c] = left.column[0] * right.column[c][0];
    for (int k = 1; k < dofs; ++k) result.column[c] += left.column[k] * right.column[c][k];
  }
  return result;
}

inline IncompleteLu::PaddedBlock IncompleteLu::padded(const BlockMatrix::Block& block) {
  const FloatLanes first = four(block.data()), second = four(block.data() + dofs), last = four(block.data() + 2 * dofs - 1), zero{};
  return {{__builtin_shufflevector(first, zero, 0, 1, 2, 4), __builtin_shufflevector(second, zero, 0, 1, 2, 4),
           __builtin_shufflevector(last, zero, 1, 2, 3, 4)}};
}

bool IncompleteLu::invert(PaddedBlock& pivot) {
  BlockMatrix::Block block;
  for (int c = 0; c < dofs; ++c) {
    for (int r = 0; r < dofs; ++r) block(r, c) = pivot.column[c][r];
  }
  block = block.inverse().eval();
  pivot = padded(block);
  return block.cast<float>().allFinite();
}

inline IncompleteLu::PaddedBlock IncompleteLu::widen(const StoredBlock& block, float scale) {
  const packed::Eight numbers = packed::eight(block.entry);
  const FloatLanes last{block.last};
  // The fourth of each counts for nothing.
  return {{scale * __builtin_shufflevector(numbers, numbers, 0, 1, 2, 3), scale * __builtin_shufflevector(numbers, numbers, 3, 4, 5, 6),
           scale * __builtin_shufflevector(__builtin_shufflevector(numbers, numbers, 6, 7, 6, 7), last, 0, 1, 4, 4)}};
}

float IncompleteLu::store(int first, int end, int row_start) {
  const auto entry = [&](int slot, int k) { return working_row_[slot - row_start].column[k / dofs][k % dofs]; };
  float largest = 0.0f, sum = 0.0f;
  for (int s = first; s < end; ++s) {
    for (int k = 0; k < dofs * dofs; ++k) {
      largest = std::max(largest, std::abs(entry(s, k)));
      sum += std::abs(entry(s, k));
    }
  }
  if (!std::isfinite(sum)) return sum;  // no whole number stands for what single precision has none for
  const float numbers = largest > negligible_entry ? std::numeric_limits<std::int16_t>::max() / largest : 0.0f;
  for (int s = first; s < end; ++s) {
    for (int k = 0; k < dofs * dofs - 1; ++k) {
      const float number = numbers * entry(s, k);
      value_[s].entry[k] = static_cast<std::int16_t>(number + (number < 0.0f ? -0.5f : 0.5f));  // what is cut off the same way everywhere adds up
    }
    value_[s].last = numbers * entry(s, dofs * dofs - 1);
  }
  return largest / std::numeric_limits<std::int16_t>::max();
}

double IncompleteLu::largest_inverse() const {
  float largest = 0.0f;
  for (const RowScale& row : worth_) largest = std::max(largest, row.pivot);
  return static_cast<double>(largest * std::numeric_limits<std::int16_t>::max());
}

void IncompleteLu::find_scale(const BlockMatrix& matrix) {
  scale_.assign(static_cast<std::size_t>(batch_size) * order_.size(), 0.0f);
  for (int i = 0; i < rows(); ++i) {
    const auto& diagonal = matrix.value(matrix.diagonal(order_[i]));
    for (int k = 0; k < dofs; ++k) {
      const double entry = diagonal(k, k);
      scale_[batch_size * i + k] = std::isnormal(entry) ? std::ldexp(1.0f, -std::ilogb(entry) / 2) : 1.0f;
    }
  }
}

IncompleteLu::PaddedBlock IncompleteLu::scaled(const BlockMatrix::Block& block, int row, int column) const {
  PaddedBlock result = padded(block);
  const FloatLanes of_row = packed::four(&scale_[batch_size * row]);
  for (int c = 0; c < dofs; ++c) result.column[c] *= of_row * scale_[batch_size * column + c];
  return result;
}

void IncompleteLu::subtract_rows_above(int i) {
  const int start = row_start_[i];
  for (int s = start; s < row_start_[i + 1]; ++s) working_place_[column_[s]] = s - start;
  for (int s = start; s < diagonal_[i]; ++s) {
    const int k = column_[s];
    const PaddedBlock left = working_row_[s - start] = product(working_row_[s - start], widen(value_[diagonal_[k]], worth_[k].pivot));
    ++products_;
    for (int u = diagonal_[k] + 1; u < row_start_[k + 1]; ++u) {
      const int t = working_place_[column_[u]];
      if (t < 0) continue;
      ++products_;
      const PaddedBlock part = product(left, widen(value_[u], worth_[k].above));
      for (int c = 0; c < dofs; ++c) working_row_[t].column[c] -= part.column[c];
    }
  }
  for (int s = start; s < row_start_[i + 1]; ++s) working_place_[column_[s]] = -1;
}

bool IncompleteLu::has_changed(const PaddedBlock& before, const PaddedBlock& now, const FloatLanes& weight) {
  FloatLanes largest{};
  for (int c = 0; c < dofs; ++c) {
    const FloatLanes difference = now.column[c] - before.column[c], change = difference * difference * weight * weight[c];
    largest = change <= largest ? largest : change;  // what is no number is a change
  }
  return !(largest[0] <= kept_change * kept_change && largest[1] <= kept_change * kept_change && largest[2] <= kept_change * kept_change);
}

FloatLanes IncompleteLu::diagonal_entries(int i) const {
  FloatLanes entries{};
  for (int k = 0; k < dofs; ++k) entries[k] = std::abs(taken_[i].column[k][k]);
  return entries;
}

bool IncompleteLu::is_as_taken(const BlockMatrix& matrix, int i) const {
  return !has_changed(taken_[i], scaled(matrix.value(matrix.diagonal(order_[i])), i, i), 1.0f / diagonal_entries(i));
}

bool IncompleteLu::subtracts_changed_row(int i) const {
  return std::any_of(column_.begin() + row_start_[i], column_.begin() + diagonal_[i], [&](int k) { return changed_[k] != 0; });
}

void IncompleteLu::take_row(const BlockMatrix& matrix, int i) {
  working_row_.assign(row_start_[i + 1] - row_start_[i], PaddedBlock{});
  for (int e = entries_start_[i]; e < entries_start_[i + 1]; ++e) {
    const auto& [slot, target] = entries_[e];
    working_row_[target] = scaled(matrix.value(slot), i, column_[row_start_[i] + target]);
  }
  taken_[i] = working_row_[diagonal_[i] - row_start_[i]];
}

bool IncompleteLu::factor(const BlockMatrix& matrix) {
  const NonStop non_stop;  // whether numbers have come out is asked for row by row
  const bool anew = factoring_ == Factoring::whole || value_.empty();
  if (anew) {
    value_.assign(column_.size(), StoredBlock{});
    worth_.assign(rows(), RowScale());
    taken_.resize(rows());
    find_scale(matrix);
  }
  changed_.assign(rows(), anew ? 1 : 0);
  rows_kept_ = 0;
  products_ = 0;
  for (int i = 0; i < rows(); ++i) {
    if (!anew && !subtracts_changed_row(i) && is_as_taken(matrix, i)) {
      ++rows_kept_;
      continue;
    }
    const PaddedBlock inverse_before = widen(value_[diagonal_[i]], worth_[i].pivot);
    take_row(matrix, i);
    subtract_rows_above(i);
    const int start = row_start_[i], diagonal = diagonal_[i];
    PaddedBlock& pivot = working_row_[diagonal - start];
    if (!invert(pivot)) {
      value_.clear();
      return false;
    }
    worth_[i] = {store(start, diagonal, start), store(diagonal, diagonal + 1, start), store(diagonal + 1, row_start_[i + 1], start)};
    if (!std::isfinite(worth_[i].below + worth_[i].pivot + worth_[i].above)) {
      value_.clear();
      return false;
    }
    changed_[i] = anew || has_changed(inverse_before, pivot, diagonal_entries(i));
  }
  return true;
}

namespace {

OPENCLOSE_KERNEL FloatLanes row_times(const IncompleteLu::StoredBlock* blocks, const int* columns, int count, const FloatLanes* x) {
  packed::RowProduct product;
  for (int s = 0; s < count; ++s) product.add(packed::eight(blocks[s].entry), blocks[s].last, x[columns[s]]);
  return product.sum();
}

}  // namespace

OPENCLOSE_FOR_WIDE_REGISTERS_TOO void IncompleteLu::solve_in_order(const Eigen::VectorXf& right_side, Eigen::VectorXf& x) const {
  const int* const column = column_.data();
  const StoredBlock* const value = value_.data();
  FloatLanes* const solution = solution_.data();
  const auto scale = [&](int i) { return packed::four(scale_.data() + batch_size * i); };
  for (int i = 0; i < rows(); ++i) {
    const int begin = row_start_[i];
    const FloatLanes above = row_times(value + begin, column + begin, diagonal_[i] - begin, solution);
    solution[i] = scale(i) * packed::four(right_side.data() + batch_size * i) - worth_[i].below * above;
  }
  for (int i = rows() - 1; i >= 0; --i) {
    const int begin = diagonal_[i] + 1;
    const FloatLanes left = solution[i] - worth_[i].above * row_times(value + begin, column + begin, row_start_[i + 1] - begin, solution);
    packed::RowProduct entry;
    entry.add(packed::eight(value[diagonal_[i]].entry), value[diagonal_[i]].last, left);
    solution[i] = worth_[i].pivot * entry.sum();
    packed::store(x.data() + batch_size * i, scale(i) * solution[i]);
  }
}

Eigen::VectorXd IncompleteLu::solve(const Eigen::VectorXd& right_side) const {
  // Of size one, since single precision ends at 1e38.
  const double size = right_side.size() == 0 ? 0.0 : right_side.cwiseAbs().maxCoeff();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right_side.size());
  if (!(size > 0.0)) return x;
  const Eigen::VectorXf ordered = in_order(right_side, size, order_);
  Eigen::VectorXf solution(ordered.size());
  solve_in_order(ordered, solution);
  add_in_order(solution, size, order_, x);
  return x;
}

}  // namespace openclose
