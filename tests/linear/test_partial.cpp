// Rows of a factor that are kept, and couplings that are left out of it.
#include "grids.h"
#include "openclose/core/parallel.h"
#include "openclose/linear/incomplete.h"
#include "openclose/linear/solver.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

using Solver = std::unique_ptr<LinearSolver>;

double relative_residual(const BlockMatrix& matrix, const Eigen::VectorXd& x, const Eigen::VectorXd& right_side) {
  REQUIRE(x.size() == right_side.size());
  return (matrix.multiply(x) - right_side).norm() / right_side.norm();
}

Eigen::VectorXd solution(LinearSolver& solver, const BlockMatrix& matrix, const Eigen::VectorXd& right_side, double kept_change = 0.0) {
  REQUIRE(solver.factor(matrix, kept_change));
  return solver.solve(right_side);
}

Eigen::VectorXd fresh_solution(const BlockMatrix& matrix, const Eigen::VectorXd& right_side) {
  return solution(*make_block_solver(), matrix, right_side);
}

/// Row 0 is coupled to all others, and these to nothing else. Diagonals of 4.
BlockMatrix star(int rows) {
  BlockMatrix matrix;
  std::vector<std::pair<int, int>> pairs;
  for (int i = 1; i < rows; ++i) pairs.emplace_back(0, i);
  matrix.set_pattern(rows, pairs);
  for (int i = 0; i < rows; ++i) matrix.add(i, i, 4.0 * Eigen::Matrix3d::Identity());
  for (int i = 1; i < rows; ++i) {
    matrix.add(0, i, 0.3 * Eigen::Matrix3d::Identity());
    matrix.add(i, 0, 0.2 * Eigen::Matrix3d::Identity());
  }
  return matrix;
}

/// A grid in motion with couplings of this strength over the corners, too.
BlockMatrix grid_with_corners(int side, double strength, double inertia = 1.0) {
  auto pairs = test::grid_pairs(side, side);
  const BlockMatrix grid = test::grid(side, side, 7);
  std::vector<std::pair<int, int>> corners;
  for (int i = 0; i + side + 1 < side * side; ++i) {
    if (i % side + 1 < side) corners.emplace_back(i, i + side + 1);
  }
  pairs.insert(pairs.end(), corners.begin(), corners.end());
  BlockMatrix matrix;
  matrix.set_pattern(side * side, pairs);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int s = grid.row_start(i); s < grid.row_start(i + 1); ++s) matrix.add(i, grid.column(s), grid.value(s));
    matrix.add(i, i, inertia * Eigen::Matrix3d::Identity());
  }
  const Eigen::Matrix3d corner = strength * Eigen::Matrix3d::Identity();
  for (const auto& [i, j] : corners) {
    matrix.add(i, i, corner);
    matrix.add(j, j, corner);
    matrix.add(i, j, -corner);
    matrix.add(j, i, -0.5 * corner);
  }
  return matrix;
}

}  // namespace

TEST_CASE("a factor with kept rows has the bits of a new one while nothing in them has changed", "[linear][partial]") {
  RandomSystems random(51);
  for (const int rows : {5, 30, 60}) {
    const auto pairs = random.couplings(rows, 2 * rows);
    BlockMatrix matrix;
    matrix.set_pattern(rows, pairs);
    random.fill(matrix, pairs, 1.0);
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    const Solver solver = make_block_solver(), whole = make_block_solver(Factoring::whole);
    for (int i = 0; i < 30; ++i) {
      const Eigen::VectorXd x = solution(*solver, matrix, right_side);
      CHECK(x == fresh_solution(matrix, right_side));
      CHECK(x == solution(*whole, matrix, right_side));
      const int row = random.below(rows);
      matrix.value(random.below(2) == 0 ? matrix.diagonal(row) : matrix.row_start(row)) += 0.1 * random.block();
    }
    CHECK(solver->counters().rows == 30 * rows);
    CHECK(solver->counters().rows_kept > rows);
    CHECK(solver->counters().refinements == 0);
    CHECK(whole->counters().rows_kept == 0);
  }
}

TEST_CASE("rows are kept that have not changed and subtract none that has", "[linear][partial]") {
  constexpr int rows = 10;
  BlockMatrix matrix = star(rows);
  const Eigen::VectorXd right_side = RandomSystems(52).vector(matrix.unknowns());
  const Solver solver = make_block_solver();
  const auto kept_with = [&](double change) {
    const long before = solver->counters().rows_kept;
    const Eigen::VectorXd x = solution(*solver, matrix, right_side, change);
    CHECK(relative_residual(matrix, x, right_side) <= 10.0 * change + 1e-15);
    return solver->counters().rows_kept - before;
  };
  CHECK(kept_with(1e-6) == 0);
  CHECK(kept_with(0.0) == rows);
  // Relative to the diagonals, which are 4: changes of 1e-6 are as large as 2.5e-7.
  matrix.value(matrix.find(3, 0))(0, 1) += 1e-6;
  CHECK(kept_with(3e-7) == rows);
  CHECK(kept_with(2e-7) == rows - 2);  // the row and the middle of the star
  CHECK(kept_with(2e-7) == rows);
  // Changes add up until the row is taken anew.
  for (int i = 0; i < 3; ++i) {
    matrix.value(matrix.diagonal(5))(2, 0) += 1e-6;
    CHECK(kept_with(6e-7) == (i < 2 ? rows : rows - 2));
  }
  matrix.value(matrix.diagonal(0))(1, 1) *= 1.1;
  CHECK(kept_with(1e-6) == rows - 1);
}

TEST_CASE("kept rows have the same bits with one thread and with several", "[linear][partial][parallel]") {
  RandomSystems random(53);
  constexpr int side = 40;
  BlockMatrix matrix = grid_with_corners(side, 0.1);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  const Solver one = make_block_solver(), several = make_block_solver();
  several->use_threads(4);
  for (int i = 0; i < 12; ++i) {
    const Eigen::VectorXd x = solution(*one, matrix, right_side);
    CHECK(x == solution(*several, matrix, right_side));
    CHECK(x == fresh_solution(matrix, right_side));
    for (int k = 0; k < 3; ++k) matrix.value(matrix.diagonal(random.below(matrix.rows()))) *= 1.5;
  }
  CHECK(one->counters().rows_kept > 4 * matrix.rows());
}

TEST_CASE("what weak couplings carry is found by refining", "[linear][partial]") {
  const BlockMatrix matrix = grid_with_corners(12, 1e-4);
  const Eigen::VectorXd right_side = RandomSystems(54).vector(matrix.unknowns());
  const Solver solver = make_block_solver(), whole = make_block_solver(Factoring::whole);
  const Eigen::VectorXd x = solution(*solver, matrix, right_side), expected = solution(*whole, matrix, right_side);
  CHECK(relative_residual(matrix, x, right_side) <= full_reduction);
  CHECK((x - expected).norm() <= 1e-11 * expected.norm());
  const long full = solver->counters().refinements;
  CHECK(full > 1);
  const double left = relative_residual(matrix, solver->solve(right_side, 1e-3), right_side);
  CHECK(left <= 1e-7);
  CHECK(left > 1e-12);
  CHECK(solver->counters().refinements < 2 * full);
  CHECK(solver->counters().couplings_taken_in == 0);
  CHECK(solver->counters().solves == 2);
  CHECK(whole->counters().refinements == 0);
}

TEST_CASE("weak couplings that do not stay so, or are not so to the system, are taken in", "[linear][partial]") {
  const Eigen::VectorXd right_side = RandomSystems(55).vector(3 * 12 * 12);
  SECTION("one grows") {
    BlockMatrix matrix = grid_with_corners(12, 1e-4);
    const Solver solver = make_block_solver();
    solution(*solver, matrix, right_side);
    for (const int row : {14, 27}) matrix.value(matrix.find(row, row == 14 ? 27 : 14)) *= 1e4;
    for (const int row : {14, 27}) matrix.value(matrix.diagonal(row)) += Eigen::Matrix3d::Identity();
    CHECK(relative_residual(matrix, solution(*solver, matrix, right_side), right_side) <= full_reduction);
    CHECK(solver->counters().couplings_taken_in == 1);
    const long refinements = solver->counters().refinements;
    for (int i = 0; i < 2; ++i) CHECK(relative_residual(matrix, solution(*solver, matrix, right_side), right_side) <= full_reduction);
    CHECK(solver->counters().refinements > refinements);  // for the others
    CHECK(solver->counters().couplings_taken_in == 1);
    CHECK(solver->counters().symbolic == 2);
    CHECK(solver->counters().solves == 4);
  }
  SECTION("nothing else holds the system") {
    const BlockMatrix matrix = [&] {
      BlockMatrix m = grid_with_corners(12, 5e-4, 1e-7);
      for (int i = 0; i < 12; ++i) m.add(i, i, -(1.0 - 1e-7) * Eigen::Matrix3d::Identity());  // the row below, too
      return m;
    }();
    const Solver solver = make_block_solver(), whole = make_block_solver(Factoring::whole);
    const Eigen::VectorXd expected = solution(*whole, matrix, right_side);
    for (int i = 0; i < 3; ++i) CHECK((solution(*solver, matrix, right_side) - expected).norm() <= 1e-9 * expected.norm());
    CHECK(solver->counters().couplings_taken_in == 1);
  }
}

TEST_CASE("couplings that are zero are not taken for weak ones", "[linear][partial]") {
  BlockMatrix matrix = grid_with_corners(12, 0.0);
  const Eigen::VectorXd right_side = RandomSystems(56).vector(matrix.unknowns());
  const Solver solver = make_block_solver();
  solution(*solver, matrix, right_side);
  for (const int row : {14, 27}) matrix.value(matrix.find(row, row == 14 ? 27 : 14)) += 0.3 * Eigen::Matrix3d::Identity();
  CHECK(relative_residual(matrix, solution(*solver, matrix, right_side), right_side) <= full_reduction);
  CHECK(solver->counters().symbolic == 1);
  CHECK(solver->counters().refinements == 0);
}

TEST_CASE("an incomplete factor leaves weak couplings out", "[linear][partial][incomplete]") {
  const BlockMatrix matrix = grid_with_corners(12, 1e-4);
  IncompleteLu needed(Factoring::needed), whole(Factoring::whole), without(Factoring::whole);
  needed.analyse(matrix);
  whole.analyse(matrix);
  BlockMatrix edges_only;
  edges_only.set_pattern(matrix.rows(), test::grid_pairs(12, 12));
  without.analyse(edges_only);
  CHECK(needed.stored_blocks() == without.stored_blocks());
  CHECK(needed.stored_blocks() < whole.stored_blocks());
  const Eigen::VectorXd right_side = RandomSystems(57).vector(matrix.unknowns());
  const Solver solver = make_incomplete_solver(make_block_solver(), 0);
  REQUIRE(solver->factor(matrix));
  CHECK(relative_residual(matrix, solver->solve(right_side, 1e-3), right_side) <= 1e-3);
  CHECK(solver->counters().incomplete == 1);
  CHECK(solver->counters().factorisations == 0);
}

TEST_CASE("rows of an incomplete factor are kept while they and the pivots that they subtract hardly change", "[linear][partial][incomplete]") {
  BlockMatrix matrix = grid_with_corners(20, 1e-4);
  const Eigen::VectorXd right_side = RandomSystems(60).vector(matrix.unknowns());
  IncompleteLu kept(Factoring::needed), whole(Factoring::whole);
  kept.analyse(matrix);
  whole.analyse(matrix);
  // What is kept differs by 0.01 of the diagonal at most: of the solution, by that times the largest diagonal entry, 5, over the smallest eigenvalue,
  // which is the inertia, 1.
  constexpr double largest_difference = 0.01 * 5.0;
  const auto difference = [&] {
    REQUIRE(kept.factor(matrix));
    IncompleteLu fresh(Factoring::needed);
    fresh.analyse(matrix);
    REQUIRE(fresh.factor(matrix));
    REQUIRE(whole.factor(matrix));
    CHECK(whole.rows_kept() == 0);
    const Eigen::VectorXd expected = fresh.solve(right_side);
    return (kept.solve(right_side) - expected).norm() / expected.norm();
  };
  CHECK(difference() == 0.0);
  CHECK(kept.rows_kept() == 0);
  CHECK(difference() == 0.0);
  CHECK(kept.rows_kept() == matrix.rows());
  // In every row, less than matters; then a little more, which the first change is no longer part of.
  for (int i = 0; i < matrix.rows(); ++i) matrix.value(matrix.diagonal(i)) *= 1.008;
  CHECK(difference() > 1e-4);
  CHECK(difference() < largest_difference);
  CHECK(kept.rows_kept() == matrix.rows());
  for (int i = 0; i < matrix.rows(); ++i) matrix.value(matrix.diagonal(i)) *= 1.008;
  CHECK(difference() == 0.0);
  CHECK(kept.rows_kept() == 0);
  // Two blocks come loose: their rows change, and others only by their pivots.
  for (const int row : {150, 151}) matrix.value(matrix.diagonal(row)) *= 0.3;
  CHECK(difference() < largest_difference);
  CHECK(kept.rows_kept() < matrix.rows() - 4);
  CHECK(kept.rows_kept() > matrix.rows() / 2);
  // Nothing of another pattern.
  matrix.renew_version();
  kept.analyse(matrix);
  whole.analyse(matrix);
  CHECK(difference() == 0.0);
  CHECK(kept.rows_kept() == 0);
}

TEST_CASE("a solver with rows of an incomplete factor kept goes down to the residual asked for", "[linear][partial][incomplete]") {
  BlockMatrix matrix = grid_with_corners(40, 1e-4);
  const Eigen::VectorXd right_side = RandomSystems(61).vector(matrix.unknowns());
  const Solver solver = make_incomplete_solver(make_block_solver(), 0), whole = make_incomplete_solver(make_block_solver(), 0, Factoring::whole);
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd x = solution(*solver, matrix, right_side), expected = solution(*whole, matrix, right_side);
    CHECK(relative_residual(matrix, x, right_side) <= 2.0 * full_reduction);
    CHECK((x - expected).norm() < 1e-10 * expected.norm());
    matrix.value(matrix.diagonal(17 * i)) *= i % 2 == 0 ? 3.0 : 1.001;
  }
  CHECK(solver->counters().rows == 20 * matrix.rows());
  CHECK(solver->counters().rows_kept > 15 * matrix.rows());
  CHECK(whole->counters().rows_kept == 0);
  CHECK(solver->counters().incomplete == 20);
  CHECK(solver->counters().krylov_given_up == 0);
}

TEST_CASE("the rows kept of an incomplete factor are saved", "[linear][partial][incomplete]") {
  BlockMatrix matrix = grid_with_corners(40, 1e-4);
  const Eigen::VectorXd right_side = RandomSystems(62).vector(matrix.unknowns());
  const Solver first = make_incomplete_solver(make_block_solver(), 0), second = make_incomplete_solver(make_block_solver(), 0);
  solution(*first, matrix, right_side);
  for (int i = 0; i < matrix.rows(); ++i) matrix.value(matrix.diagonal(i)) *= 1.008;
  Archive written;
  first->exchange(written, matrix);
  Archive bytes(written.bytes());
  second->exchange(bytes, matrix);
  CHECK(bytes.at_end());
  for (const double factor : {1.0, 1.001, 1.008}) {
    for (int i = 0; i < matrix.rows(); ++i) matrix.value(matrix.diagonal(i)) *= factor;
    CHECK(solution(*first, matrix, right_side) == solution(*second, matrix, right_side));
    CHECK(first->counters().rows_kept == second->counters().rows_kept);
  }
  CHECK(first->counters().rows_kept == 2 * matrix.rows());
  CHECK(first->counters().krylov_given_up == 0);
}

TEST_CASE("after a lost pivot all rows are factored anew", "[linear][partial]") {
  BlockMatrix matrix = star(10);
  const Eigen::VectorXd right_side = RandomSystems(58).vector(matrix.unknowns());
  const Solver solver = make_block_solver();
  solution(*solver, matrix, right_side);
  const Eigen::Matrix3d sound = matrix.value(matrix.diagonal(4));
  matrix.value(matrix.diagonal(4)).topLeftCorner<2, 2>() << 1.0, 1.0, 1.0, 1.0 + 1e-13;
  CHECK(relative_residual(matrix, solution(*solver, matrix, right_side), right_side) < 1e-12);
  CHECK(solver->counters().pivots_lost == 1);
  const long kept = solver->counters().rows_kept;
  matrix.value(matrix.diagonal(4)) = sound;
  CHECK(solution(*solver, matrix, right_side) == fresh_solution(matrix, right_side));
  CHECK(solver->counters().rows_kept == kept);
}

TEST_CASE("kept rows and left out couplings are saved", "[linear][partial]") {
  for (const bool iterative : {false, true}) {
    const auto make = [&] { return iterative ? make_incomplete_solver(make_block_solver(), 0) : make_block_solver(); };
    BlockMatrix matrix = grid_with_corners(12, 1e-4);
    const Eigen::VectorXd right_side = RandomSystems(59).vector(matrix.unknowns());
    constexpr double change = 1e-6;
    const Solver first = make(), second = make();
    solution(*first, matrix, right_side, change);
    // Below what may stay, and beyond; and what is still left out though it has become strong.
    matrix.value(matrix.diagonal(3)) *= 1.0 + 1e-7;
    matrix.value(matrix.diagonal(70)) *= 1.1;
    matrix.value(matrix.find(14, 27)) *= 12.0;
    const Eigen::VectorXd x = solution(*first, matrix, right_side, change);
    CHECK((x == fresh_solution(matrix, right_side)) == false);
    Archive written;
    first->exchange(written, matrix);
    Archive bytes(written.bytes());
    second->exchange(bytes, matrix);
    CHECK(bytes.at_end());
    const Eigen::VectorXd next = solution(*first, matrix, right_side, change);
    CHECK(solution(*second, matrix, right_side, change) == next);
    if (!iterative) CHECK(next == x);  // else the incomplete factor has been tried, for which the rows have gone
    CHECK(second->counters().rows_kept == first->counters().rows_kept);
    CHECK(second->counters().refinements == first->counters().refinements);
    CHECK(second->counters().symbolic == first->counters().symbolic);
    Archive again;
    second->exchange(again, matrix);
    Archive once_more;
    first->exchange(once_more, matrix);
    const bool same = again.bytes() == once_more.bytes();
    CHECK(same);
  }
}
