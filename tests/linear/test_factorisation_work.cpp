#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include "grids.h"
#include "openclose/linear/factorisation_work.h"
#include "openclose/linear/solver.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

/// Every block holds on to its eight neighbours and to the ground.
BlockMatrix wall(int columns, int rows, double inertia) {
  auto pairs = test::grid_pairs(columns, rows);
  for (int i = 0; i + columns < columns * rows; ++i) {
    if (i % columns > 0) pairs.emplace_back(i, i + columns - 1);
    if (i % columns + 1 < columns) pairs.emplace_back(i, i + columns + 1);
  }
  BlockMatrix matrix;
  matrix.set_pattern(columns * rows, pairs);
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, inertia * one);
  for (const auto& [i, j] : pairs) {
    matrix.add(i, i, one);
    matrix.add(j, j, one);
    matrix.add(i, j, -one);
    matrix.add(j, i, -one);
  }
  return matrix;
}

/// A solver that goes on where this one is.
std::unique_ptr<LinearSolver> written_and_read(LinearSolver& solver, const BlockMatrix& matrix) {
  Archive written;
  solver.exchange(written, matrix);
  Archive bytes(written.bytes());
  auto read = make_incomplete_solver(make_block_solver(), 0);
  read->exchange(bytes, matrix);
  REQUIRE(bytes.at_end());
  return read;
}

}  // namespace

TEST_CASE("the products of a factorisation are those that can be counted by hand", "[linear][factorisation_work]") {
  RandomSystems random(49);
  const auto products = [&](int rows, const std::vector<std::pair<int, int>>& pairs) {
    BlockMatrix matrix;
    matrix.set_pattern(rows, pairs);
    random.fill(matrix, pairs, 1.5);
    return products_of_factorisation(matrix, Factoring::whole);
  };
  CHECK(products(3, {}) == 3.0);                                                  // pivots alone
  CHECK(products(5, {{0, 1}, {1, 2}, {2, 3}, {3, 4}}) == 4 * (1 + 1 + 1) + 1.0);  // from either end, no fill
  // All with all: a row with a blocks above the diagonal is multiplied by its pivot's inverse and subtracted from a rows.
  CHECK(products(4, {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}) == (3 * 4 + 1) + (2 * 3 + 1) + (1 * 2 + 1) + 1.0);
  // A star: its middle goes last but for one of its rays.
  CHECK(products(5, {{0, 1}, {0, 2}, {0, 3}, {0, 4}}) == 4 * (1 + 1 + 1) + 1.0);
}

TEST_CASE("GMRES may take as long as a factorisation does", "[linear][factorisation_work]") {
  RandomSystems random(50);
  const auto counters = [&](int columns, int rows, double inertia) {
    const BlockMatrix matrix = wall(columns, rows, inertia);
    const auto solver = make_incomplete_solver(make_block_solver(), 0);
    REQUIRE(solver->factor(matrix));
    solver->solve(random.vector(matrix.unknowns()), 1e-5);
    return solver->counters();
  };
  // As many blocks. The factor of the square one takes twenty times as long as that of the tower, an iteration as long.
  const LinearCounters square = counters(60, 60, 1e-3), tower = counters(6, 600, 1e-1);
  CHECK(square.krylov_iterations > 20);
  CHECK(square.krylov_given_up == 0);
  CHECK(tower.krylov_iterations < 5);
  CHECK(tower.krylov_given_up == 1);
}

TEST_CASE("blocks that come to hold on to each other have their factorisation counted anew", "[linear][factorisation_work]") {
  RandomSystems random(52);
  BlockMatrix apart;
  apart.set_pattern(3600, {});
  for (int i = 0; i < apart.rows(); ++i) apart.add(i, i, Eigen::Matrix3d::Identity());
  const BlockMatrix square = wall(60, 60, 1e-3);
  const auto solver = make_incomplete_solver(make_block_solver(), 0);
  REQUIRE(solver->factor(apart));
  REQUIRE(solver->factor(square));
  solver->solve(random.vector(square.unknowns()), 1e-5);
  CHECK(solver->counters().krylov_iterations > 20);
  CHECK(solver->counters().krylov_given_up == 0);
}

TEST_CASE("what the incomplete factor has cost, GMRES has not", "[linear][factorisation_work]") {
  // Narrow enough for an incomplete factor of half the products; with all of them GMRES would get there.
  RandomSystems random(50);
  const BlockMatrix narrow = wall(6, 600, 4e-1);
  const auto solver = make_incomplete_solver(make_block_solver(), 0);
  REQUIRE(solver->factor(narrow));
  solver->solve(random.vector(narrow.unknowns()), 1e-3);
  CHECK(solver->counters().krylov_given_up == 1);
}

TEST_CASE("a solver of no blocks is written and read", "[linear][factorisation_work]") {
  BlockMatrix none;
  none.set_pattern(0, {});
  const auto solver = make_incomplete_solver(make_block_solver(), 0);
  REQUIRE(solver->factor(none));
  CHECK(written_and_read(*solver, none));
}

TEST_CASE("work that no factorisation takes is refused of a saved solver", "[linear][factorisation_work]") {
  const BlockMatrix square = wall(60, 60, 1e-1);
  const auto solver = make_incomplete_solver(make_block_solver(), 0);
  REQUIRE(solver->factor(square));
  Archive written;
  solver->exchange(written, square);
  // Products and blocks are the last two numbers.
  const std::string& bytes = written.bytes();
  double counted[2];
  std::memcpy(counted, bytes.data() + bytes.size() - sizeof counted, sizeof counted);
  REQUIRE((square.rows() < counted[1] && counted[1] < counted[0] && counted[0] < 1e12));
  const auto with = [&](double products, double blocks) {
    std::string forged = bytes;
    const double numbers[] = {products, blocks};
    std::memcpy(forged.data() + forged.size() - sizeof numbers, numbers, sizeof numbers);
    Archive read(forged);
    make_incomplete_solver(make_block_solver(), 0)->exchange(read, square);
  };
  CHECK_NOTHROW(with(1e12, 1e4));
  CHECK_THROWS_AS(with(1.01e12, 1e4), DamagedState);
  CHECK_THROWS_AS(with(-1.0, 1e4), DamagedState);
  CHECK_THROWS_AS(with(0.0, -1.0), DamagedState);
  CHECK_THROWS_AS(with(std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()), DamagedState);
  CHECK_THROWS_AS(with(std::numeric_limits<double>::quiet_NaN(), 1e4), DamagedState);
}

TEST_CASE("a solver that was written and read goes on with the work that was counted before", "[linear][factorisation_work]") {
  RandomSystems random(51);
  const BlockMatrix square = wall(60, 60, 1e-1), tower = wall(6, 600, 1e-1);
  const auto solve_tower = [&](LinearSolver& solver) {
    REQUIRE(solver.factor(tower));
    solver.solve(random.vector(tower.unknowns()), 1e-5);
    return solver.counters().krylov_given_up;
  };
  const auto first = make_incomplete_solver(make_block_solver(), 0);
  REQUIRE(first->factor(square));
  const auto second = written_and_read(*first, square);
  CHECK(solve_tower(*first) == 0);
  CHECK(solve_tower(*second) == 0);
}
