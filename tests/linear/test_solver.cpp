#include <Eigen/LU>
#include <limits>
#include <tuple>

#include "grids.h"
#include "openclose/core/parallel.h"
#include "openclose/linear/solver.h"
#include "openclose_traps.h"
#include "random_systems.h"
#include "support/catch.h"
#include "support/dense.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

using Solver = std::unique_ptr<LinearSolver>;

/// Largest residual over what rounding may leave: |A| |x| times machine precision times the number of unknowns (N. J. Higham, Accuracy and stability
/// of numerical algorithms, 2002, theorem 9.3, with the growth of partial pivoting left to the factor 10).
double residual_over_rounding(const BlockMatrix& matrix, const Eigen::VectorXd& x, const Eigen::VectorXd& right_side) {
  const Eigen::MatrixXd dense = test::dense(matrix);
  const double scale = dense.cwiseAbs().rowwise().sum().maxCoeff() * x.cwiseAbs().maxCoeff();
  const double rounding = 10.0 * static_cast<double>(x.size()) * std::numeric_limits<double>::epsilon() * scale;
  return (dense * x - right_side).cwiseAbs().maxCoeff() / rounding;
}

/// Two blocks held to each other by a spring but to nothing else: any common translation goes through, to the last bit.
BlockMatrix floating_pair() {
  BlockMatrix matrix;
  matrix.set_pattern(2, {{0, 1}});
  const Eigen::Matrix3d k = Eigen::Vector3d(4.0, 2.0, 1.0).asDiagonal();
  matrix.add(0, 0, k);
  matrix.add(1, 1, k);
  matrix.add(0, 1, -k);
  matrix.add(1, 0, -k);
  return matrix;
}

/// Regular, in any order of its rows, but its first pivot is as good as singular without being small.
BlockMatrix nearly_singular_diagonal() {
  BlockMatrix matrix;
  matrix.set_pattern(2, {{0, 1}});
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k.topLeftCorner<2, 2>() << 1.0, 1.0, 1.0, 1.0 + 1e-13;
  matrix.add(0, 0, k);
  matrix.add(1, 1, k);
  matrix.add(0, 1, Eigen::Matrix3d::Identity());
  matrix.add(1, 0, -Eigen::Matrix3d::Identity());
  return matrix;
}

/// Regular, in any order of its rows, but elimination of the first one leaves 2e-13 of the others' diagonals.
BlockMatrix cancelling_diagonal() {
  BlockMatrix matrix;
  matrix.set_pattern(3, {{0, 1}, {0, 2}, {1, 2}});
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 3; ++i) matrix.add(i, i, (1.0 + 1e-13) * unit);
  for (const auto& [i, j, factor] : {std::tuple{0, 1, 1.0}, {0, 2, 1.0}, {1, 2, 2.0}}) {
    matrix.add(i, j, factor * unit);
    matrix.add(j, i, 1.0 / factor * unit);
  }
  return matrix;
}

Solver make(const std::string& name) {
  return name == "block" ? make_block_solver() : make_sparse_solver();
}

}  // namespace

TEST_CASE("all solvers solve random systems to rounding and agree", "[linear][solver]") {
  RandomSystems random(3);
  // Strongly diagonal systems are well conditioned: both answers are right to rounding. The others are only solved to a residual of rounding.
  const double dominance = GENERATE(2.0, 0.02);
  for (int rows = 1; rows <= 60; ++rows) {
    const auto pairs = random.couplings(rows, random.below(4 * rows));
    BlockMatrix matrix;
    matrix.set_pattern(rows, pairs);
    random.fill(matrix, pairs, dominance);
    const Solver sparse = make("sparse"), block = make("block");
    REQUIRE(sparse->factor(matrix));
    REQUIRE(block->factor(matrix));
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    const Eigen::VectorXd x = test::dense(matrix).partialPivLu().solve(right_side), y = sparse->solve(right_side), z = block->solve(right_side);
    CHECK(residual_over_rounding(matrix, x, right_side) < 1.0);
    CHECK(residual_over_rounding(matrix, y, right_side) < 1.0);
    if (dominance <= 1.0) continue;
    CHECK(residual_over_rounding(matrix, z, right_side) < 1.0);
    CHECK((x - y).norm() <= 1e-13 * x.norm());
    CHECK((x - z).norm() <= 1e-13 * x.norm());
  }
}

TEST_CASE("factors, answers and products have the same bits with one thread and with several", "[linear][solver][parallel]") {
  RandomSystems random(10);
  // A grid large enough to be shared, whose elimination tree has large subtrees.
  constexpr int side = 40, rows = side * side;
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < rows; ++i) {
    if (i % side + 1 < side) pairs.emplace_back(i, i + 1);
    if (i + side < rows) pairs.emplace_back(i, i + side);
  }
  BlockMatrix matrix;
  matrix.set_pattern(rows, pairs);
  random.fill(matrix, pairs, 1.5);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  const Solver one = make("block");
  REQUIRE(one->factor(matrix));
  const Eigen::VectorXd x = one->solve(right_side), product = matrix.multiply(right_side);
  CHECK(residual_over_rounding(matrix, x, right_side) < 1.0);
  for (int threads = 2; threads <= most_threads; ++threads) {
    const long factored = times_shared(SharedWork::factorisation), solved = times_shared(SharedWork::substitution);
    const long multiplied = times_shared(SharedWork::product);
    const Solver several = make("block");
    several->use_threads(threads);
    REQUIRE(several->factor(matrix));
    CHECK(several->solve(right_side) == x);
    matrix.use_threads(threads);
    CHECK(matrix.multiply(right_side) == product);
    CHECK(times_shared(SharedWork::factorisation) > factored + 1);  // the subtrees, and the top
    CHECK(times_shared(SharedWork::substitution) == solved + 2);
    CHECK(times_shared(SharedWork::product) == multiplied + 1);
  }
}

TEST_CASE("a system in which nothing moves has an empty solution", "[linear][solver]") {
  BlockMatrix matrix;
  matrix.set_pattern(0, {});
  for (const LinearSolverKind kind : {LinearSolverKind::plain, LinearSolverKind::direct, LinearSolverKind::iterative}) {
    const Solver solver = make_solver(kind);
    REQUIRE(solver->factor(matrix));
    CHECK(solver->solve(Eigen::VectorXd()).size() == 0);
  }
}

TEST_CASE("several right sides use one factorisation", "[linear][solver]") {
  RandomSystems random(4);
  const Solver solver = make(GENERATE("sparse", "block"));
  const auto pairs = random.couplings(12, 30);
  BlockMatrix matrix;
  matrix.set_pattern(12, pairs);
  random.fill(matrix, pairs, 1.0);
  REQUIRE(solver->factor(matrix));
  for (int i = 0; i < 5; ++i) {
    const Eigen::VectorXd right_side = random.vector(36);
    CHECK(residual_over_rounding(matrix, solver->solve(right_side), right_side) < 1.0);
  }
  CHECK(solver->counters().factorisations == 1);
  CHECK(solver->counters().solves == 5);
}

TEST_CASE("symbolic work is done once for a pattern, numbers every time", "[linear][solver]") {
  RandomSystems random(5);
  const Solver solver = make(GENERATE("sparse", "block"));
  BlockMatrix matrix;
  const auto check_solution = [&] {
    REQUIRE(solver->factor(matrix));
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    CHECK(residual_over_rounding(matrix, solver->solve(right_side), right_side) < 1.0);
  };

  const std::vector<std::pair<int, int>> chain{{0, 1}, {1, 2}, {2, 3}}, star{{0, 1}, {0, 2}, {0, 3}}, longer{{0, 1}, {3, 4}};
  matrix.set_pattern(4, chain);
  for (int i = 0; i < 3; ++i) {
    random.fill(matrix, chain, 1.0);
    check_solution();
  }
  CHECK(solver->counters().symbolic == 1);
  CHECK(solver->counters().symbolic_skipped == 2);

  SECTION("another pattern of the same size and number of entries") {
    matrix.set_pattern(4, star);
    random.fill(matrix, star, 1.0);
    check_solution();
  }
  SECTION("another size") {
    matrix.set_pattern(5, longer);
    random.fill(matrix, longer, 1.0);
    check_solution();
  }
  CHECK(solver->counters().symbolic == 2);
  CHECK(solver->counters().symbolic_skipped == 2);
  CHECK(solver->counters().factorisations == 4);
}

TEST_CASE("zeros within the pattern may become numbers later", "[linear][solver]") {
  RandomSystems random(6);
  const Solver solver = make(GENERATE("sparse", "block"));
  const std::vector<std::pair<int, int>> pairs{{0, 1}, {1, 2}};
  BlockMatrix matrix;
  matrix.set_pattern(3, pairs);
  for (int i = 0; i < 3; ++i) matrix.add(i, i, Eigen::Matrix3d::Identity());
  const Eigen::VectorXd right_side = random.vector(9);
  REQUIRE(solver->factor(matrix));
  CHECK(solver->solve(right_side) == right_side);
  random.fill(matrix, pairs, 1.0);
  REQUIRE(solver->factor(matrix));
  CHECK(residual_over_rounding(matrix, solver->solve(right_side), right_side) < 1.0);
  CHECK(solver->counters().symbolic == 1);
}

TEST_CASE("a singular matrix is reported, and the solver works again afterwards", "[linear][solver]") {
  const std::string name = GENERATE("sparse", "block");
  const Solver solver = make(name);
  RandomSystems random(7);
  BlockMatrix matrix;
  SECTION("no entries at all") {
    matrix.set_pattern(2, {{0, 1}});
    CHECK_FALSE(solver->factor(matrix));
  }
  SECTION("one unknown without stiffness") {
    matrix.set_pattern(2, {{0, 1}});
    matrix.add(0, 0, Eigen::Matrix3d::Identity());
    matrix.add(1, 1, Eigen::Vector3d(1.0, 1.0, 0.0).asDiagonal().toDenseMatrix());
    CHECK_FALSE(solver->factor(matrix));
  }
  SECTION("two blocks held by nothing but each other") {
    matrix = floating_pair();
    CHECK_FALSE(solver->factor(matrix));
  }
  matrix = floating_pair();
  matrix.add(0, 0, Eigen::Matrix3d::Identity());
  REQUIRE(solver->factor(matrix));
  const Eigen::VectorXd right_side = random.vector(6);
  CHECK(residual_over_rounding(matrix, solver->solve(right_side), right_side) < 1.0);
}

TEST_CASE("a pivot that has lost its digits goes to the plain solver, which exchanges rows, and is counted", "[linear][solver]") {
  for (const bool before_elimination : {true, false}) {
    INFO((before_elimination ? "nearly singular diagonal" : "cancelling diagonal"));
    const BlockMatrix matrix = before_elimination ? nearly_singular_diagonal() : cancelling_diagonal();
    const Eigen::VectorXd right_side = RandomSystems(7).vector(matrix.unknowns());
    const Solver solver = make("block");
    REQUIRE(solver->factor(matrix));
    CHECK(residual_over_rounding(matrix, solver->solve(right_side), right_side) < 1.0);
    CHECK(solver->counters().pivots_lost == 1);
  }
  RandomSystems systems(8);
  BlockMatrix sound;
  const auto pairs = systems.couplings(12, 20);
  sound.set_pattern(12, pairs);
  systems.fill(sound, pairs, 1.0);
  const Solver solver = make("block");
  REQUIRE(solver->factor(sound));
  CHECK(solver->counters().pivots_lost == 0);
}

TEST_CASE("a system with nothing on its diagonal is solved by exchange of rows", "[linear][solver]") {
  RandomSystems random(10);
  const auto pairs = test::grid_pairs(20, 20);
  BlockMatrix matrix;
  matrix.set_pattern(400, pairs);
  random.fill(matrix, pairs, 0.0);
  for (int i = 0; i < matrix.rows(); ++i) matrix.value(matrix.diagonal(i)).setZero();
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  const Solver solver = make("block");
  REQUIRE(solver->factor(matrix));
  CHECK(residual_over_rounding(matrix, solver->solve(right_side), right_side) < 1.0);
  CHECK(solver->counters().pivots_lost == 1);
}

TEST_CASE("an eliminated unknown makes a floating system regular and keeps its right side", "[linear][solver]") {
  const std::string name = GENERATE("sparse", "block");
  const Solver solver = make(name);
  BlockMatrix matrix = floating_pair();
  for (int k = 0; k < 3; ++k) matrix.eliminate(0, k);
  REQUIRE(solver->factor(matrix));
  Eigen::VectorXd right_side(6), expected(6);
  right_side << 5.0, 6.0, 7.0, 8.0, 8.0, 8.0;
  expected << 5.0, 6.0, 7.0, 2.0, 4.0, 8.0;
  CHECK(solver->solve(right_side) == expected);
}

TEST_CASE("numbers that are none do not pass for a factorisation", "[linear][solver]") {
  const std::string name = GENERATE("sparse", "block");
  const Solver solver = make(name);
  const NonStop non_stop;
  BlockMatrix matrix = floating_pair();
  matrix.add(0, 0, Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  CHECK_FALSE(solver->factor(matrix));
}

TEST_CASE("what nothing connects to a system changes no bit of its solution, wherever it stands among the rows", "[linear][solver]") {
  RandomSystems random(8);
  for (const int rows : {1, 2, 3, 4, 8, 9, 40}) {
    const auto pairs = random.couplings(rows, 2 * rows);
    BlockMatrix alone;
    alone.set_pattern(rows, pairs);
    random.fill(alone, pairs, 1.0);
    const Eigen::VectorXd right_side = random.vector(alone.unknowns());
    const Solver solver = make_block_solver();
    REQUIRE(solver->factor(alone));
    const Eigen::VectorXd x = solver->solve(right_side);
    CHECK(residual_over_rounding(alone, x, right_side) < 1.0);
    for (const int stranger : {0, rows / 2, rows}) {
      const auto moved = [&](int row) { return row < stranger ? row : row + 1; };
      std::vector<std::pair<int, int>> moved_pairs;
      for (const auto& [i, j] : pairs) moved_pairs.emplace_back(moved(i), moved(j));
      BlockMatrix both;
      both.set_pattern(rows + 1, moved_pairs);
      Eigen::VectorXd with_stranger = Eigen::VectorXd::Ones(both.unknowns());
      for (int i = 0; i < rows; ++i) {
        for (int s = alone.row_start(i); s < alone.row_start(i + 1); ++s) both.add(moved(i), moved(alone.column(s)), alone.value(s));
        with_stranger.segment<3>(3 * moved(i)) = right_side.segment<3>(3 * i);
      }
      both.add(stranger, stranger, Eigen::Vector3d(2.0, 3.0, 5.0).asDiagonal().toDenseMatrix());
      const Solver other = make_block_solver();
      REQUIRE(other->factor(both));
      const Eigen::VectorXd y = other->solve(with_stranger);
      for (int i = 0; i < rows; ++i) CHECK(y.segment<3>(3 * moved(i)) == x.segment<3>(3 * i));
    }
  }
}
