#include <limits>
#include <numeric>

#include "grids.h"
#include "openclose/linear/single_matrix.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::grid;
using openclose::test::RandomSystems;

namespace {

constexpr double rounding = std::numeric_limits<float>::epsilon();

/// Some other order.
std::vector<int> order_of(const BlockMatrix& matrix) {
  std::vector<int> order(matrix.rows());
  for (int i = 0; i < matrix.rows(); ++i) order[i] = (7 * i + 3) % matrix.rows();
  REQUIRE(matrix.rows() % 7 != 0);
  return order;
}

Eigen::VectorXd in_rows(const Eigen::VectorXf& vector, const std::vector<int>& order) {
  Eigen::VectorXd rows = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(order.size()));
  add_in_order(vector, 1.0, order, rows);
  return rows;
}

Eigen::VectorXf product_of(const SingleMatrix& matrix, const Eigen::VectorXf& x) {
  Eigen::VectorXf product(x.size());
  matrix.multiply(x, product);
  return product;
}

}  // namespace

TEST_CASE("vectors go into the order of the rows and back", "[linear][single]") {
  const std::vector<int> order{2, 0, 1};
  const Eigen::VectorXd vector = Eigen::VectorXd::LinSpaced(9, 1.0, 9.0);
  const Eigen::VectorXf ordered = in_order(vector, 1.0, order);
  Eigen::VectorXf expected(12);
  expected << 7, 8, 9, 0, 1, 2, 3, 0, 4, 5, 6, 0;
  CHECK(ordered == expected);
  Eigen::VectorXd sum = vector;
  add_in_order(in_order(1e60 * vector, 1e60, order), 2.0, order, sum);
  CHECK((sum - 3.0 * vector).norm() < 10.0 * rounding * vector.norm());
}

TEST_CASE("the product in single precision is that of the matrix, on any number of threads", "[linear][single]") {
  RandomSystems random(71);
  const BlockMatrix matrix = grid(60, 50, 5);
  const std::vector<int> order = order_of(matrix);
  SingleMatrix single;
  single.take(matrix, order);
  const Eigen::VectorXf x = in_order(random.vector(matrix.unknowns()), 1.0, order), product = product_of(single, x);
  const Eigen::VectorXd expected = matrix.multiply(in_rows(x, order));
  CHECK((in_rows(product, order) - expected).norm() < 4.0 * rounding * expected.norm());
  for (Eigen::Index i = 3; i < product.size(); i += 4) CHECK(product[i] == 0.0f);
  for (const int threads : {2, 3}) {
    single.use_threads(threads);
    CHECK(product_of(single, x) == product);
  }
  // Other numbers, another pattern.
  for (const auto& other : {grid(60, 50), grid(8, 5)}) {
    const std::vector<int> order_of_other = order_of(other);
    single.take(other, order_of_other);
    const Eigen::VectorXf y = in_order(random.vector(other.unknowns()), 1.0, order_of_other);
    const Eigen::VectorXd of_other = other.multiply(in_rows(y, order_of_other));
    CHECK((in_rows(product_of(single, y), order_of_other) - of_other).norm() < 4.0 * rounding * of_other.norm());
  }
}

TEST_CASE("what moves together does not lose its digits to stiff contacts", "[linear][single]") {
  RandomSystems random(72);
  BlockMatrix matrix = grid(20, 10);
  constexpr double stiffness = 1e6, difference = 1e-3;
  for (int s = 0; s < matrix.row_start(matrix.rows()); ++s) matrix.value(s) *= stiffness;
  // Nothing holds the lowest row but inertia.
  for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, (i < 20 ? 1.0 - stiffness : 1.0) * Eigen::Matrix3d::Identity());
  const std::vector<int> order = order_of(matrix);
  SingleMatrix single;
  single.take(matrix, order);
  Eigen::VectorXd x = difference * random.vector(matrix.unknowns());
  for (int i = 0; i < matrix.rows(); ++i) x.segment<2>(3 * i) += Eigen::Vector2d(3.0, -7.0);
  const Eigen::VectorXf ordered = in_order(x, 1.0, order);
  const Eigen::VectorXd expected = matrix.multiply(in_rows(ordered, order));
  // Of the forces by the differences; those by the way of all are thousands of times larger.
  CHECK((in_rows(product_of(single, ordered), order) - expected).norm() < 10.0 * rounding * stiffness * difference * std::sqrt(matrix.unknowns()));
}
