#include "grids.h"
#include "openclose/linear/solver.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::grid;
using openclose::test::RandomSystems;

namespace {

double relative_residual(const BlockMatrix<3>& matrix, const Eigen::VectorXd& x, const Eigen::VectorXd& right_side) {
  REQUIRE(x.size() == right_side.size());
  return (matrix.multiply(x) - right_side).norm() / right_side.norm();
}

}  // namespace

TEST_CASE("a grid of blocks is solved alike by every solver", "[linear][lagged]") {
  RandomSystems random(21);
  for (const int sliding_every : {0, 7}) {
    const BlockMatrix<3> matrix = grid(40, 25, sliding_every);
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    const auto plain = make_solver<3>(matrix.rows(), LinearSolverKind::plain);
    REQUIRE(plain->factor(matrix));
    const Eigen::VectorXd expected = plain->solve(right_side);
    CHECK(relative_residual(matrix, expected, right_side) < 1e-10);
    for (const LinearSolverKind kind : {LinearSolverKind::automatic, LinearSolverKind::direct, LinearSolverKind::iterative}) {
      const auto solver = make_solver<3>(matrix.rows(), kind);
      REQUIRE(solver->factor(matrix));
      CHECK((solver->solve(right_side) - expected).norm() < 1e-8 * expected.norm());
      CHECK(solver->counters().plain == 0);
    }
    const auto fronts = make_multifrontal_solver<3>(Refactor::always);
    REQUIRE(fronts->factor(matrix));
    CHECK((fronts->solve(right_side) - expected).norm() < 1e-8 * expected.norm());
    CHECK(fronts->counters().plain == 0);
  }
}

TEST_CASE("fronts exchange rows that would be zero pivots, and need no help", "[linear][lagged]") {
  BlockMatrix<3> matrix;
  matrix.set_pattern(2, {{0, 1}});
  Eigen::Matrix3d turn;
  turn << 0, 0, 2, 3, 0, 0, 0, 5, 0;
  matrix.add(0, 0, turn);
  matrix.add(1, 1, turn);
  matrix.add(0, 1, 0.5 * Eigen::Matrix3d::Identity());
  const auto solver = make_multifrontal_solver<3>(Refactor::always);
  REQUIRE(solver->factor(matrix));
  const Eigen::VectorXd right_side = Eigen::VectorXd::LinSpaced(6, 1.0, 6.0);
  CHECK(relative_residual(matrix, solver->solve(right_side), right_side) < 1e-15);
  CHECK(solver->counters().krylov_iterations == 0);
  CHECK(solver->counters().plain == 0);
}

TEST_CASE("fronts that were let go of are made again, unless later matrices are solved with them", "[linear][lagged]") {
  RandomSystems random(23);
  const BlockMatrix<3> matrix = grid(60, 60);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  for (const Refactor refactor : {Refactor::always, Refactor::when_needed}) {
    const auto solver = make_multifrontal_solver<3>(refactor);
    REQUIRE(solver->factor(matrix));
    const Eigen::VectorXd expected = solver->solve(right_side);
    solver->let_go();
    REQUIRE(solver->factor(matrix));
    const Eigen::VectorXd again = solver->solve(right_side);
    CHECK((again - expected).norm() <= 1e-9 * expected.norm());
    CHECK(solver->counters().symbolic == 1);
    CHECK(solver->counters().factorisations == (refactor == Refactor::always ? 2 : 1));
  }
}

TEST_CASE("a factor serves for matrices like its own, to the same residual", "[linear][lagged]") {
  RandomSystems random(22);
  const auto solver = make_multifrontal_solver<3>(Refactor::when_needed);
  BlockMatrix<3> matrix = grid(60, 60);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  REQUIRE(solver->factor(matrix));
  CHECK(relative_residual(matrix, solver->solve(right_side), right_side) < 1e-12);
  CHECK(solver->counters().factors_kept == 0);
  // One joint loses half its shear stiffness: a change of rank two at most.
  const Eigen::Vector3d a(1.0, 0.0, -0.5), b(1.0, 0.0, 0.5);
  const int i = 60 * 30 + 30, j = i + 60;
  matrix.add(i, i, -0.5 * a * a.transpose());
  matrix.add(j, j, -0.5 * b * b.transpose());
  matrix.add(i, j, 0.5 * a * b.transpose());
  matrix.add(j, i, 0.5 * b * a.transpose());
  REQUIRE(solver->factor(matrix));
  CHECK(relative_residual(matrix, solver->solve(right_side), right_side) <= 1.001 * full_reduction);
  CHECK(solver->counters().factorisations == 1);
  CHECK(solver->counters().factors_kept == 1);
  CHECK(solver->counters().krylov_iterations > 0);
  CHECK(solver->counters().krylov_iterations <= 3);
  CHECK(solver->counters().krylov_given_up == 0);
}

TEST_CASE("a factor serves for a pattern that has grown", "[linear][lagged]") {
  RandomSystems random(23);
  const auto solver = make_multifrontal_solver<3>(Refactor::when_needed);
  const BlockMatrix<3> before = grid(60, 60);
  const Eigen::VectorXd right_side = random.vector(before.unknowns());
  REQUIRE(solver->factor(before));
  auto pairs = test::grid_pairs(60, 60);
  pairs.emplace_back(5, 3000);
  BlockMatrix<3> after;
  after.set_pattern(before.rows(), pairs);
  for (int i = 0; i < before.rows(); ++i) {
    for (int s = before.row_start(i); s < before.row_start(i + 1); ++s) after.add(i, before.column(s), before.value(s));
  }
  const Eigen::Matrix3d spring = 0.1 * Eigen::Vector3d(0.0, 1.0, 0.0).asDiagonal().toDenseMatrix();
  after.add(5, 5, spring);
  after.add(3000, 3000, spring);
  after.add(5, 3000, -spring);
  after.add(3000, 5, -spring);
  REQUIRE(solver->factor(after));
  CHECK(relative_residual(after, solver->solve(right_side), right_side) <= 1.001 * full_reduction);
  CHECK(solver->counters().symbolic == 1);
  CHECK(solver->counters().factors_kept == 1);
}

TEST_CASE("a factor that no longer serves is renewed", "[linear][lagged]") {
  RandomSystems random(24);
  const auto solver = make_multifrontal_solver<3>(Refactor::when_needed);
  BlockMatrix<3> matrix = grid(60, 60);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  REQUIRE(solver->factor(matrix));
  for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, std::pow(10.0, 3.0 * random.number()) * Eigen::Matrix3d::Identity());
  REQUIRE(solver->factor(matrix));
  CHECK(relative_residual(matrix, solver->solve(right_side), right_side) < full_reduction);
  CHECK(solver->counters().krylov_given_up == 1);
  CHECK(solver->counters().factorisations == 2);
  CHECK(solver->counters().factors_kept == 0);
}

TEST_CASE("where no factor serves twice, tries become rare, and come back", "[linear][lagged]") {
  RandomSystems random(26);
  const auto solver = make_multifrontal_solver<3>(Refactor::when_needed);
  const Eigen::VectorXd right_side = random.vector(grid(30, 30).unknowns());
  const auto solve = [&](double spread) {
    BlockMatrix<3> matrix = grid(30, 30);
    for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, std::pow(10.0, spread * random.number()) * Eigen::Matrix3d::Identity());
    REQUIRE(solver->factor(matrix));
    CHECK(relative_residual(matrix, solver->solve(right_side), right_side) < full_reduction);
  };
  for (int i = 0; i < 40; ++i) solve(3.0);
  // After pauses of 1, 2, 4, 8, 8, ... matrices: tries at the 2nd, 4th, 7th, 12th, 21st, 30th and 39th.
  CHECK(solver->counters().krylov_given_up == 7);
  CHECK(solver->counters().factorisations == 40);
  for (int i = 0; i < 20; ++i) solve(1e-6);
  CHECK(solver->counters().factors_kept > 5);
  CHECK(solver->counters().krylov_given_up <= 8);
}

TEST_CASE("a matrix that has become singular has no solution, also with the factor of an earlier one", "[linear][lagged]") {
  const auto solver = make_multifrontal_solver<3>(Refactor::when_needed);
  const BlockMatrix<3> regular = grid(4, 4);
  const Eigen::VectorXd right_side = Eigen::VectorXd::Ones(regular.unknowns());
  REQUIRE(solver->factor(regular));
  BlockMatrix<3> singular = regular;
  singular.set_zero();
  const bool found_at_once = !solver->factor(singular);
  CHECK((found_at_once || solver->solve(right_side).size() == 0));
  REQUIRE(solver->factor(regular));
  CHECK(relative_residual(regular, solver->solve(right_side), right_side) < full_reduction);
}

TEST_CASE("a solve may be asked for less", "[linear][lagged]") {
  RandomSystems random(25);
  BlockMatrix<3> first = grid(60, 60, 9), second = grid(60, 60, 0);
  for (int i = 0; i < first.rows(); ++i) {
    first.add(i, i, 0.1 * Eigen::Matrix3d::Identity());
    second.add(i, i, 0.11 * Eigen::Matrix3d::Identity());
  }
  const Eigen::VectorXd right_side = random.vector(first.unknowns());
  const auto rough = make_multifrontal_solver<3>(Refactor::when_needed);
  REQUIRE(rough->factor(first));
  REQUIRE(rough->factor(second));
  const double left = relative_residual(second, rough->solve(right_side, 1e-2), right_side);
  CHECK(left <= 1e-2);
  CHECK(left > 1e-9);
  CHECK(rough->counters().factors_kept == 1);
}
