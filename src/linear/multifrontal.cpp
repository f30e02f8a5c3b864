#include "openclose/linear/multifrontal.h"

#include <Eigen/LU>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

#include "openclose/linear/weak_couplings.h"

namespace openclose {
namespace {

using Dense = Eigen::Map<Eigen::MatrixXd>;
using ConstDense = Eigen::Map<const Eigen::MatrixXd>;
using Stride = Eigen::OuterStride<>;
using Panel = Eigen::Map<Eigen::MatrixXd, 0, Stride>;

std::vector<int> minimum_degree(const RowGraph& graph) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < graph.rows(); ++i) {
    entries.emplace_back(i, i, 1.0);
    for (int k = graph.start[i]; k < graph.start[i + 1]; ++k) entries.emplace_back(i, graph.neighbour[k], 1.0);
  }
  Eigen::SparseMatrix<double> matrix(graph.rows(), graph.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  return {permutation.indices().data(), permutation.indices().data() + graph.rows()};
}

}  // namespace

template <int N>
bool MultifrontalLu<N>::analyse(const BlockMatrix<N>& matrix) {
  if (version_ == matrix.pattern_version()) return false;
  const RowGraph graph = graph_of(matrix, factored_slots(matrix, Factoring::whole));
  plan_ = plan_elimination(graph, minimum_degree(graph));
  plan_sources(matrix);
  plan_children();
  version_ = matrix.pattern_version();
  return true;
}

template <int N>
void MultifrontalLu<N>::plan_sources(const BlockMatrix<N>& matrix) {
  source_start_.assign(1, 0);
  source_.clear();
  std::vector<int> local(matrix.rows());
  for (int s = 0; s < plan_.supernodes(); ++s) {
    for (int p = plan_.first[s]; p < plan_.first[s + 1]; ++p) local[p] = p - plan_.first[s];
    for (int k = 0; k < plan_.rest_size(s); ++k) local[plan_.rest[plan_.rest_start[s] + k]] = plan_.own(s) + k;
    for (int p = plan_.first[s]; p < plan_.first[s + 1]; ++p) {
      const int row = plan_.row_at[p];
      for (int slot = matrix.row_start(row); slot < matrix.row_start(row + 1); ++slot) {
        const int q = plan_.place_of[matrix.column(slot)];
        if (q < plan_.first[s]) continue;
        source_.push_back({slot, local[p], local[q]});
        if (q >= plan_.first[s + 1]) source_.push_back({matrix.find(matrix.column(slot), row), local[q], local[p]});
      }
    }
    source_start_.push_back(static_cast<int>(source_.size()));
  }
}

template <int N>
void MultifrontalLu<N>::plan_children() {
  const int count = plan_.supernodes();
  children_.assign(count, 0);
  in_parent_.resize(plan_.rest.size());
  value_at_.assign(1, 0);
  factor_work_ = 0.0;
  for (int s = 0; s < count; ++s) {
    const double n = static_cast<double>(own(s)), r = static_cast<double>(rest(s));
    factor_work_ += n * n * n / 3.0 + n * n * r + n * r * r;
    value_at_.push_back(value_at_.back() + static_cast<std::size_t>(own(s) * (own(s) + 2 * rest(s))));
    const int p = plan_.parent[s];
    if (p < 0) continue;
    ++children_[p];
    int k = plan_.rest_start[p];
    for (int i = plan_.rest_start[s]; i < plan_.rest_start[s + 1]; ++i) {
      const int place = plan_.rest[i];
      if (place < plan_.first[p + 1]) {
        in_parent_[i] = place - plan_.first[p];
      } else {
        while (plan_.rest[k] != place) ++k;
        in_parent_[i] = plan_.own(p) + k - plan_.rest_start[p];
      }
    }
  }
  exchange_.resize(N * plan_.row_at.size());
}

template <int N>
void MultifrontalLu<N>::gather(const BlockMatrix<N>& matrix, int s, double* front) const {
  const Eigen::Index size = own(s) + rest(s);
  Dense f(front, size, size);
  f.setZero();
  for (int k = source_start_[s]; k < source_start_[s + 1]; ++k) {
    f.template block<N, N>(N * source_[k].row, N * source_[k].column) = matrix.value(source_[k].slot);
  }
}

template <int N>
bool MultifrontalLu<N>::eliminate(int s, double* front) {
  const Eigen::Index n = own(s), r = rest(s), size = n + r;
  Dense f(front, size, size);
  double* value = value_.data() + value_at_[s];
  Dense columns(value, size, n), rows(value + size * n, n, r);
  columns = f.leftCols(n);
  Eigen::Ref<Eigen::MatrixXd> pivots = columns.topRows(n);
  Eigen::PartialPivLU<Eigen::Ref<Eigen::MatrixXd>> lu(pivots);
  const double smallest = pivots.diagonal().cwiseAbs().minCoeff();
  if (!(smallest > 0.0) || !pivots.allFinite()) return false;
  const auto& indices = lu.permutationP().indices();
  std::copy(indices.data(), indices.data() + n, exchange_.begin() + N * plan_.first[s]);
  if (r == 0) return true;
  rows.noalias() = lu.permutationP() * f.topRightCorner(n, r);
  pivots.template triangularView<Eigen::UnitLower>().solveInPlace(rows);
  auto below = columns.bottomRows(r);
  pivots.template triangularView<Eigen::Upper>().template solveInPlace<Eigen::OnTheRight>(below);
  f.bottomRightCorner(r, r).noalias() -= below * rows;
  return true;
}

template <int N>
bool MultifrontalLu<N>::factor(const BlockMatrix<N>& matrix) {
  value_.resize(value_at_.back());
  left_.clear();
  std::vector<int> waiting;  // supernodes whose rest lies on the pile
  for (int s = 0; s < plan_.supernodes(); ++s) {
    const Eigen::Index n = own(s), r = rest(s), size = n + r;
    if (front_.size() < static_cast<std::size_t>(size * size)) front_.resize(static_cast<std::size_t>(size * size));
    gather(matrix, s, front_.data());
    Dense front(front_.data(), size, size);
    for (int c = 0; c < children_[s]; ++c) {
      const int child = waiting.back();
      waiting.pop_back();
      const Eigen::Index left = rest(child);
      ConstDense update(left_.data() + left_.size() - left * left, left, left);
      const int* to = in_parent_.data() + plan_.rest_start[child];
      for (Eigen::Index j = 0; j < left / N; ++j) {
        for (Eigen::Index i = 0; i < left / N; ++i) {
          front.template block<N, N>(N * to[i], N * to[j]) += update.template block<N, N>(N * i, N * j);
        }
      }
      left_.resize(left_.size() - static_cast<std::size_t>(left * left));
    }
    if (!eliminate(s, front_.data())) return false;
    if (plan_.parent[s] < 0) continue;
    const std::size_t at = left_.size();
    left_.resize(at + static_cast<std::size_t>(r * r));
    Dense(left_.data() + at, r, r) = front.bottomRightCorner(r, r);
    waiting.push_back(s);
  }
  std::vector<double>().swap(front_);
  std::vector<double>().swap(left_);
  return true;
}

template <int N>
Eigen::VectorXd MultifrontalLu<N>::solve(const Eigen::VectorXd& right_side) const {
  const int count = plan_.supernodes();
  Eigen::VectorXd y(right_side.size()), x(right_side.size()), own_part, rest_part;
  for (std::size_t p = 0; p < plan_.row_at.size(); ++p) y.segment<N>(N * p) = right_side.segment<N>(N * plan_.row_at[p]);
  for (int s = 0; s < count; ++s) {
    const Eigen::Index n = own(s), r = rest(s), at = N * plan_.first[s];
    ConstDense columns(value_.data() + value_at_[s], n + r, n);
    own_part = y.segment(at, n);
    for (Eigen::Index i = 0; i < n; ++i) y[at + exchange_[at + i]] = own_part[i];
    auto mine = y.segment(at, n);
    columns.topRows(n).template triangularView<Eigen::UnitLower>().solveInPlace(mine);
    if (r == 0) continue;
    rest_part.noalias() = columns.bottomRows(r) * mine;
    for (Eigen::Index i = 0; i < r / N; ++i) y.template segment<N>(N * plan_.rest[plan_.rest_start[s] + i]) -= rest_part.template segment<N>(N * i);
  }
  for (int s = count - 1; s >= 0; --s) {
    const Eigen::Index n = own(s), r = rest(s), at = N * plan_.first[s];
    ConstDense columns(value_.data() + value_at_[s], n + r, n), rows(value_.data() + value_at_[s] + (n + r) * n, n, r);
    auto mine = y.segment(at, n);
    if (r > 0) {
      rest_part.resize(r);
      for (Eigen::Index i = 0; i < r / N; ++i) rest_part.template segment<N>(N * i) = y.template segment<N>(N * plan_.rest[plan_.rest_start[s] + i]);
      mine.noalias() -= rows * rest_part;
    }
    columns.topRows(n).template triangularView<Eigen::Upper>().solveInPlace(mine);
  }
  for (std::size_t p = 0; p < plan_.row_at.size(); ++p) x.segment<N>(N * plan_.row_at[p]) = y.segment<N>(N * p);
  return x;
}

template class MultifrontalLu<3>;

}  // namespace openclose
