#include <Eigen/LU>

#include "grids.h"
#include "openclose/linear/incomplete.h"
#include "openclose/linear/solver.h"
#include "random_systems.h"
#include "support/catch.h"
#include "support/dense.h"

using namespace openclose;
using openclose::test::grid;
using openclose::test::RandomSystems;

namespace {

/// [-] What whole numbers of 16 bits leave of a solve with a matrix of moderate condition: of the largest entry of a row, each of nine may lack one
/// of 32,767 parts.
constexpr double sixteen_bits = 9.0 / 32767.0;

double relative_residual(const BlockMatrix& matrix, const Eigen::VectorXd& x, const Eigen::VectorXd& right_side) {
  REQUIRE(x.size() == right_side.size());
  return (matrix.multiply(x) - right_side).norm() / right_side.norm();
}

/// Held by inertia as much as by the neighbours.
BlockMatrix moving(BlockMatrix matrix, double inertia = 1.0) {
  for (int i = 0; i < matrix.rows(); ++i) matrix.add(i, i, inertia * Eigen::Matrix3d::Identity());
  return matrix;
}

/// Tells what is asked of a block solver.
class WatchedSolver : public LinearSolver {
 public:
  bool factor(const BlockMatrix& matrix, double kept_change) override { return real_->factor(matrix, kept_change); }
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override { return real_->solve(right_side, reduction); }
  void let_go() override {
    ++times_let_go;
    real_->let_go();
  }
  int times_let_go = 0;

 private:
  std::unique_ptr<LinearSolver> real_ = make_block_solver();
};

auto make_solver_for_all_sizes() {
  return make_incomplete_solver(make_block_solver(), 0);
}

}  // namespace

TEST_CASE("an incomplete factor without anything to drop is the factor", "[linear][incomplete]") {
  RandomSystems random(41);
  // Trees have no fill in the order from their ends; neither have two that do not touch.
  const std::vector<std::vector<std::pair<int, int>>> forests = {{}, {{0, 1}, {1, 2}, {2, 3}, {3, 4}}, {{0, 3}, {3, 5}, {3, 1}, {2, 4}}};
  for (const auto& pairs : forests) {
    BlockMatrix matrix;
    matrix.set_pattern(6, pairs);
    random.fill(matrix, pairs, 1.5);
    IncompleteLu lu;
    CHECK(lu.analyse(matrix));
    CHECK_FALSE(lu.analyse(matrix));
    CHECK(lu.stored_blocks() == 6 + 2 * pairs.size());
    REQUIRE(lu.factor(matrix));
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    CHECK(relative_residual(matrix, lu.solve(right_side), right_side) < sixteen_bits);
  }
}

TEST_CASE("fill of low level is kept", "[linear][incomplete]") {
  RandomSystems random(42);
  // The fill of a ring is three fewer than it has rows. From either end it has levels 1, 2, 3 and so on: all of it is kept with seven rows, with
  // eight all but one.
  for (const int rows : {7, 8}) {
    std::vector<std::pair<int, int>> ring;
    for (int i = 0; i < rows; ++i) ring.emplace_back(i, (i + 1) % rows);
    BlockMatrix matrix;
    matrix.set_pattern(rows, ring);
    random.fill(matrix, ring, 0.6);
    IncompleteLu lu;
    lu.analyse(matrix);
    CHECK(lu.stored_blocks() == static_cast<std::size_t>(rows + 2 * (rows + 4)));
    REQUIRE(lu.factor(matrix));
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    CHECK((relative_residual(matrix, lu.solve(right_side), right_side) < sixteen_bits) == (rows == 7));
  }
  // A grid fills more than that.
  const BlockMatrix matrix = moving(grid(20, 20));
  IncompleteLu lu;
  lu.analyse(matrix);
  REQUIRE(lu.factor(matrix));
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  const double left = relative_residual(matrix, lu.solve(right_side), right_side);
  CHECK(left < 0.1);
  CHECK(left > sixteen_bits);
}

TEST_CASE("products in an incomplete factor are those of rows that are not kept", "[linear][incomplete]") {
  constexpr int rows = 5;
  BlockMatrix chain;
  chain.set_pattern(rows, test::grid_pairs(1, rows));
  for (int i = 0; i < rows; ++i) chain.add(i, i, 4.0 * Eigen::Matrix3d::Identity());
  for (const auto& [i, j] : test::grid_pairs(1, rows)) {
    chain.add(i, j, -Eigen::Matrix3d::Identity());
    chain.add(j, i, -Eigen::Matrix3d::Identity());
  }
  IncompleteLu lu(Factoring::needed);
  lu.analyse(chain);
  REQUIRE(lu.factor(chain));
  CHECK(lu.products() == 2 * (rows - 1));  // by the inverse of the pivot above, and off the diagonal
  REQUIRE(lu.factor(chain));
  CHECK(lu.rows_kept() == rows);
  CHECK(lu.products() == 0);
}

TEST_CASE("an estimating solver keeps all fill", "[linear][incomplete]") {
  RandomSystems random(50);
  const auto solver = make_estimating_solver();
  // Eigenvalues of the springs of a grid are below 10, so that the condition is.
  constexpr double condition = 10.0;
  for (const double inertia : {1.0, 2.0}) {
    const BlockMatrix matrix = moving(grid(20, 20, 7), inertia);
    REQUIRE(solver->factor(matrix));
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    CHECK(relative_residual(matrix, solver->solve(right_side), right_side) < condition * sixteen_bits);
  }
  CHECK(solver->counters().factorisations == 2);
  CHECK(solver->counters().solves == 2);
  CHECK(solver->counters().pivots_lost == 0);
  CHECK(solver->memory().factor > 0);
  // Stiff springs between blocks that next to nothing holds.
  for (const double inertia : {1e-1, 1e-5, 1e-6}) {
    BlockMatrix loose = grid(6, 1);
    for (int i = 0; i < loose.rows(); ++i) loose.add(i, i, (inertia - 1.0) * Eigen::Matrix3d::Identity());
    REQUIRE(solver->factor(loose));
    CHECK(solver->counters().pivots_lost == (inertia == 1e-1 ? 0 : inertia == 1e-5 ? 1 : 2));
    const Eigen::VectorXd right_side = random.vector(loose.unknowns()), exact = test::dense(loose).lu().solve(right_side);
    CHECK((solver->solve(right_side) - exact).norm() < 0.03 * exact.norm());
  }
  BlockMatrix singular = grid(4, 4);
  singular.set_zero();
  CHECK_FALSE(solver->factor(singular));
}

TEST_CASE("an incomplete factor does not ask for the unit of the right side", "[linear][incomplete]") {
  const BlockMatrix matrix = moving(grid(5, 5));
  IncompleteLu lu;
  lu.analyse(matrix);
  REQUIRE(lu.factor(matrix));
  const Eigen::VectorXd right_side = Eigen::VectorXd::LinSpaced(matrix.unknowns(), -1.0, 2.0), x = lu.solve(right_side);
  CHECK((lu.solve(1e60 * right_side) - 1e60 * x).norm() <= 1e-6 * 1e60 * x.norm());
  CHECK(lu.solve(Eigen::VectorXd::Zero(matrix.unknowns())).norm() == 0.0);
}

TEST_CASE("an incomplete factor does not ask for the unit of length", "[linear][incomplete]") {
  RandomSystems random(49);
  const std::vector<std::pair<int, int>> tree = {{0, 3}, {3, 5}, {3, 1}, {2, 4}, {0, 2}};
  // Moments over lengths and rotations times lengths are forces and ways: of blocks of a metre in metres, of a centimetre, of a kilometre.
  for (const double length : {1.0, 1e-2, 1e3}) {
    BlockMatrix matrix;
    matrix.set_pattern(6, tree);
    random.fill(matrix, tree, 1.5);
    const Eigen::Vector3d unit(1.0, 1.0, length);
    for (int s = 0; s < matrix.row_start(6); ++s) matrix.value(s) = unit.asDiagonal() * matrix.value(s) * unit.asDiagonal();
    const Eigen::VectorXd units = unit.replicate(6, 1), right_side = units.cwiseProduct(random.vector(18));
    IncompleteLu lu;
    lu.analyse(matrix);
    REQUIRE(lu.factor(matrix));
    const Eigen::VectorXd left = (matrix.multiply(lu.solve(right_side)) - right_side).cwiseQuotient(units);
    CHECK(left.norm() < sixteen_bits * right_side.cwiseQuotient(units).norm());
  }
}

TEST_CASE("a system in motion is solved with an incomplete factor, to the residual asked for", "[linear][incomplete]") {
  RandomSystems random(43);
  for (const int sliding_every : {0, 7}) {
    const BlockMatrix matrix = moving(grid(60, 50, sliding_every));
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    const auto plain = make_sparse_solver();
    REQUIRE(plain->factor(matrix));
    const Eigen::VectorXd expected = plain->solve(right_side);
    const auto solver = make_solver_for_all_sizes();
    REQUIRE(solver->factor(matrix));
    CHECK((solver->solve(right_side) - expected).norm() < 1e-10 * expected.norm());
    const double left = relative_residual(matrix, solver->solve(right_side, 1e-3), right_side);
    CHECK(left <= 1e-3);
    CHECK(left > 1e-9);
    CHECK(solver->counters().incomplete == 1);
    CHECK(solver->counters().solves == 2);
    CHECK(solver->counters().factorisations == 0);
    REQUIRE(solver->factor(matrix));
    CHECK(solver->counters().symbolic == 1);
    CHECK(solver->counters().symbolic_skipped == 1);
  }
}

TEST_CASE("small systems and those that inertia does not hold are factored", "[linear][incomplete]") {
  RandomSystems random(44);
  BlockMatrix matrix = grid(60, 50);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  const auto direct = make_block_solver();
  REQUIRE(direct->factor(matrix));
  const Eigen::VectorXd expected = direct->solve(right_side);

  const auto larger = make_incomplete_solver(make_block_solver(), matrix.rows() + 1);
  REQUIRE(larger->factor(matrix));
  CHECK(larger->solve(right_side) == expected);
  CHECK(larger->counters().incomplete == 0);
  CHECK(larger->counters().factorisations == 1);

  const auto solver = make_solver_for_all_sizes();
  const auto solve = [&](const BlockMatrix& m) {
    REQUIRE(solver->factor(m));
    return solver->solve(right_side);
  };
  for (int i = 0; i < 11; ++i) CHECK(solve(matrix) == expected);
  // After pauses of 1, 2 and 4 matrices: tries at the 1st, 3rd, 6th and 11th.
  CHECK(solver->counters().krylov_given_up == 4);
  CHECK(solver->counters().incomplete == 4);
  CHECK(solver->counters().factorisations == 11);
  // Once it moves, the pause of 8 is the last.
  const BlockMatrix in_motion = moving(matrix);
  for (int i = 0; i < 12; ++i) CHECK(relative_residual(in_motion, solve(in_motion), right_side) <= 1.001 * full_reduction);
  CHECK(solver->counters().incomplete == 8);
  CHECK(solver->counters().krylov_given_up == 4);
}

TEST_CASE("a factor that was let go of is made again", "[linear][incomplete]") {
  RandomSystems random(46);
  const BlockMatrix matrix = grid(60, 50);
  const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
  const auto solver = make_block_solver();
  REQUIRE(solver->factor(matrix));
  const Eigen::VectorXd expected = solver->solve(right_side);
  for (int i = 0; i < 2; ++i) {
    solver->let_go();
    REQUIRE(solver->factor(matrix));
    CHECK(solver->solve(right_side) == expected);
  }
  CHECK(solver->counters().symbolic == 1);
  CHECK(solver->counters().rows_kept == 0);
}

TEST_CASE("a direct factor stays while tries are in vain, and goes once GMRES takes half of what it may", "[linear][incomplete]") {
  RandomSystems random(47);
  const BlockMatrix at_rest = grid(60, 50), in_motion = moving(at_rest);
  const Eigen::VectorXd right_side = random.vector(at_rest.unknowns());
  auto owned = std::make_unique<WatchedSolver>();
  const WatchedSolver& direct = *owned;
  const auto solver = make_incomplete_solver(std::move(owned), 0);
  const auto solve = [&](const BlockMatrix& m) {
    REQUIRE(solver->factor(m));
    CHECK(relative_residual(m, solver->solve(right_side), right_side) <= 1.001 * full_reduction);
  };
  // Tries, which are in vain, at the 1st, 3rd and 6th matrix at rest; a pause of 4 before the next.
  for (int i = 0; i < 6; ++i) solve(at_rest);
  CHECK(solver->counters().incomplete == 3);
  CHECK(direct.times_let_go == 0);
  for (int i = 0; i < 6; ++i) solve(in_motion);
  CHECK(solver->counters().incomplete == 5);
  CHECK(direct.times_let_go == 2);
  // With so little inertia GMRES gets there, but takes more than half of what it may.
  const BlockMatrix slow = moving(at_rest, 1e-1);
  for (int i = 0; i < 4; ++i) solve(slow);
  CHECK(solver->counters().incomplete == 9);
  CHECK(solver->counters().krylov_given_up == 3);
  CHECK(direct.times_let_go == 2);
}

TEST_CASE("memory of factors and of GMRES", "[linear][incomplete]") {
  RandomSystems random(48);
  const BlockMatrix at_rest = grid(60, 50), in_motion = moving(at_rest);
  const Eigen::VectorXd right_side = random.vector(at_rest.unknowns());
  const std::size_t numbers = sizeof(double) * static_cast<std::size_t>(9 * at_rest.row_start(at_rest.rows()));
  CHECK(at_rest.bytes() > numbers);
  CHECK(at_rest.bytes() < numbers + 9 * at_rest.rows() * sizeof(int));
  const auto direct = make_block_solver();
  REQUIRE(direct->factor(at_rest));
  const std::size_t with_fill = direct->memory().factor;
  CHECK(with_fill > 2 * numbers);
  CHECK(direct->memory().krylov == 0);
  direct->let_go();
  CHECK(direct->memory().factor < with_fill / 2);

  // A solver that goes on with what another one has counted has no factor yet.
  const auto plain = make_sparse_solver(), restarted = make_sparse_solver();
  REQUIRE(plain->factor(at_rest));
  CHECK(plain->memory().factor > 2 * numbers);
  Archive written;
  plain->exchange(written, at_rest);
  Archive bytes(written.bytes());
  restarted->exchange(bytes, at_rest);
  CHECK(restarted->counters().factorisations == 1);
  CHECK(restarted->memory().factor == 0);

  const auto solver = make_solver_for_all_sizes();
  REQUIRE(solver->factor(in_motion));
  solver->solve(right_side, 1e-3);
  // Two vectors an iteration, and the one that the next would start from.
  CHECK(solver->memory().krylov ==
        sizeof(float) * batch_size * static_cast<std::size_t>((2 * solver->counters().krylov_iterations + 1) * in_motion.rows()));
  const std::size_t incomplete = solver->memory().factor;
  CHECK(incomplete > numbers / 2);
  CHECK(incomplete < with_fill);
  // In vain, and the factor that was made instead is the only one.
  REQUIRE(solver->factor(at_rest));
  solver->solve(right_side);
  REQUIRE(solver->counters().krylov_given_up == 1);
  CHECK(solver->memory().factor > with_fill);
  CHECK(solver->memory().factor < with_fill + incomplete);
}

TEST_CASE("a singular matrix has no solution, also after an incomplete factor", "[linear][incomplete]") {
  BlockMatrix matrix = grid(4, 4);
  matrix.set_zero();
  const auto solver = make_solver_for_all_sizes();
  CHECK_FALSE(solver->factor(matrix));
}

TEST_CASE("a solver that was written and read goes on to the same bits", "[linear][incomplete]") {
  RandomSystems random(45);
  const BlockMatrix still = grid(30, 30), in_motion = moving(still);
  const Eigen::VectorXd right_side = random.vector(still.unknowns());
  const auto first = make_solver_for_all_sizes();
  for (int i = 0; i < 3; ++i) {
    REQUIRE(first->factor(still));
    first->solve(right_side);
  }
  Archive written;
  first->exchange(written, still);
  Archive bytes(written.bytes());
  const auto second = make_solver_for_all_sizes();
  second->exchange(bytes, still);
  CHECK(bytes.at_end());
  for (int i = 0; i < 6; ++i) {
    REQUIRE(first->factor(in_motion));
    REQUIRE(second->factor(in_motion));
    CHECK(first->solve(right_side) == second->solve(right_side));
    CHECK(first->counters().incomplete == second->counters().incomplete);
    CHECK(first->counters().factorisations == second->counters().factorisations);
  }
}
