#include <stdexcept>

#include "openclose/linear/block_matrix.h"
#include "random_systems.h"
#include "support/catch.h"
#include "support/dense.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

using Block = BlockMatrix::Block;

Block numbered(double first) {
  return Block::NullaryExpr([first](Eigen::Index i, Eigen::Index j) { return first + 3.0 * static_cast<double>(i) + static_cast<double>(j); });
}

}  // namespace

TEST_CASE("a new matrix is empty", "[linear][block_matrix]") {
  const BlockMatrix matrix;
  CHECK(matrix.rows() == 0);
  CHECK(matrix.unknowns() == 0);
}

TEST_CASE("the pattern holds the diagonal and both triangles, once each, and starts from zero", "[linear][block_matrix]") {
  BlockMatrix matrix;
  matrix.set_pattern(4, {{2, 0}, {0, 2}, {2, 0}, {1, 2}});
  CHECK(matrix.rows() == 4);
  CHECK(matrix.unknowns() == 12);
  const std::vector<std::vector<int>> expected{{0, 2}, {1, 2}, {0, 1, 2}, {3}};
  for (int i = 0; i < 4; ++i) {
    std::vector<int> columns;
    for (int s = matrix.row_start(i); s < matrix.row_start(i + 1); ++s) columns.push_back(matrix.column(s));
    CHECK(columns == expected[i]);
  }
  CHECK(test::dense(matrix).isZero(0.0));
}

TEST_CASE("a slot is that of one pair", "[linear][block_matrix]") {
  BlockMatrix matrix;
  matrix.set_pattern(4, {{2, 0}, {1, 2}, {1, 3}});
  for (int slot = 0; slot <= matrix.nobody(); ++slot) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) CHECK(matrix.is_at(slot, i, j) == (matrix.find(i, j) == slot));
    }
  }
}

TEST_CASE("blocks are added where they belong", "[linear][block_matrix]") {
  BlockMatrix matrix;
  matrix.set_pattern(3, {{0, 2}});
  matrix.add(0, 2, numbered(1.0));
  matrix.add(0, 2, numbered(10.0));
  matrix.add(2, 0, numbered(100.0));
  matrix.add(1, 1, numbered(1000.0));
  CHECK(matrix.value(matrix.find(0, 2)) == numbered(1.0) + numbered(10.0));
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(9, 9);
  expected.block<3, 3>(0, 6) = numbered(1.0) + numbered(10.0);
  expected.block<3, 3>(6, 0) = numbered(100.0);
  expected.block<3, 3>(3, 3) = numbered(1000.0);
  CHECK(test::dense(matrix) == expected);
  matrix.set_zero();
  CHECK(test::dense(matrix).isZero(0.0));
  CHECK_NOTHROW(matrix.add(0, 2, numbered(1.0)));
}

TEST_CASE("what is outside the pattern is refused, not written somewhere else", "[linear][block_matrix]") {
  BlockMatrix matrix;
  matrix.set_pattern(4, {{0, 2}});
  for (const auto& [i, j] : std::vector<std::pair<int, int>>{{0, 1}, {1, 0}, {0, 3}, {3, 0}, {2, 3}, {1, 2}}) {
    CHECK_THROWS_AS(matrix.add(i, j, numbered(1.0)), std::logic_error);
    CHECK(matrix.find(i, j) == -1);
  }
  CHECK(test::dense(matrix).isZero(0.0));
}

TEST_CASE("a new pattern replaces the old one and changes the version", "[linear][block_matrix]") {
  BlockMatrix matrix;
  matrix.set_pattern(3, {{0, 1}});
  const long version = matrix.pattern_version();
  matrix.add(0, 1, numbered(1.0));
  matrix.set_zero();
  CHECK(matrix.pattern_version() == version);
  matrix.set_pattern(5, {{3, 4}});
  CHECK(matrix.pattern_version() != version);
  CHECK(matrix.rows() == 5);
  CHECK(test::dense(matrix).isZero(0.0));
  CHECK(matrix.find(0, 1) == -1);
  CHECK(matrix.find(4, 3) >= 0);
}

TEST_CASE("products are those of the dense matrix", "[linear][block_matrix]") {
  RandomSystems random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const int rows = 1 + random.below(20);
    const auto pairs = random.couplings(rows, 2 * rows);
    BlockMatrix matrix;
    matrix.set_pattern(rows, pairs);
    random.fill(matrix, pairs, 0.1);
    const Eigen::VectorXd x = random.vector(matrix.unknowns());
    // Sums of up to 60 products, in another order.
    const double rounding = 60.0 * 2.2e-16 * test::dense(matrix).cwiseAbs().rowwise().sum().maxCoeff();
    CHECK((matrix.multiply(x) - test::dense(matrix) * x).cwiseAbs().maxCoeff() <= rounding);
  }
}

TEST_CASE("an eliminated unknown keeps its value and influences no other", "[linear][block_matrix]") {
  RandomSystems random(2);
  const std::vector<std::pair<int, int>> pairs{{0, 1}, {1, 2}, {3, 1}};
  BlockMatrix matrix;
  matrix.set_pattern(4, pairs);
  random.fill(matrix, pairs, 1.0);
  Eigen::MatrixXd expected = test::dense(matrix);
  const int row = GENERATE(0, 1, 2, 3);
  const int k = GENERATE(0, 1, 2);
  expected.row(3 * row + k).setZero();
  expected.col(3 * row + k).setZero();
  expected(3 * row + k, 3 * row + k) = 1.0;
  matrix.eliminate(row, k);
  CHECK(test::dense(matrix) == expected);
}
