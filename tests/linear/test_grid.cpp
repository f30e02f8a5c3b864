#include "grids.h"
#include "openclose/linear/solver.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::grid;
using openclose::test::RandomSystems;

namespace {

double relative_residual(const BlockMatrix& matrix, const Eigen::VectorXd& x, const Eigen::VectorXd& right_side) {
  REQUIRE(x.size() == right_side.size());
  return (matrix.multiply(x) - right_side).norm() / right_side.norm();
}

}  // namespace

TEST_CASE("a grid of blocks is solved alike by every solver", "[linear][solver]") {
  RandomSystems random(21);
  for (const int sliding_every : {0, 7}) {
    const BlockMatrix matrix = grid(40, 25, sliding_every);
    const Eigen::VectorXd right_side = random.vector(matrix.unknowns());
    const auto plain = make_solver(LinearSolverKind::plain);
    REQUIRE(plain->factor(matrix));
    const Eigen::VectorXd expected = plain->solve(right_side);
    CHECK(relative_residual(matrix, expected, right_side) < 1e-10);
    for (const LinearSolverKind kind : {LinearSolverKind::automatic, LinearSolverKind::direct, LinearSolverKind::iterative}) {
      const auto solver = make_solver(kind);
      REQUIRE(solver->factor(matrix));
      CHECK((solver->solve(right_side) - expected).norm() < 1e-8 * expected.norm());
      CHECK(solver->counters().pivots_lost == 0);
    }
  }
}
