// Random block systems for the tests of this folder.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "openclose/linear/block_matrix.h"
#include "support/dense.h"

namespace openclose::test {

class RandomSystems {
 public:
  explicit RandomSystems(unsigned seed) : generator_(seed) {}

  double number() { return std::uniform_real_distribution<double>(-1.0, 1.0)(generator_); }
  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(generator_); }
  Eigen::Matrix3d block() {
    return Eigen::Matrix3d::NullaryExpr([this] { return number(); });
  }
  Eigen::VectorXd vector(int unknowns) {
    return Eigen::VectorXd::NullaryExpr(unknowns, [this](Eigen::Index) { return number(); });
  }

  /// Pairs of different rows, some of them more than once and either way round.
  std::vector<std::pair<int, int>> couplings(int rows, int count) {
    std::vector<std::pair<int, int>> pairs;
    for (int k = 0; k < count && rows > 1; ++k) {
      const int i = below(rows), j = below(rows);
      if (i != j) pairs.emplace_back(i, j);
    }
    return pairs;
  }

  /// Fills the pattern of `pairs`, so that neither triangle is the transpose of the other; `dominance` times the largest row sum on the diagonal.
  void fill(BlockMatrix& matrix, const std::vector<std::pair<int, int>>& pairs, double dominance) {
    matrix.set_zero();
    for (const auto& [i, j] : pairs) {
      matrix.add(i, j, block());
      matrix.add(j, i, block());
    }
    for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, block());
    const double row_sum = dense(matrix).cwiseAbs().rowwise().sum().maxCoeff();
    for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, dominance * row_sum * Eigen::Matrix3d::Identity());
  }

 private:
  std::mt19937 generator_;
};

}  // namespace openclose::test
