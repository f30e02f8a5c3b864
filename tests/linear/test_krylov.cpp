#include <Eigen/LU>

#include "openclose/linear/krylov.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

LinearMap product(const Eigen::MatrixXd& a) {
  return [&a](const Eigen::VectorXd& v) -> Eigen::VectorXd { return a * v; };
}

Eigen::VectorXd same(const Eigen::VectorXd& v) {
  return v;
}

}  // namespace

TEST_CASE("GMRES ends after as many iterations as the matrix has different eigenvalues", "[linear][krylov]") {
  Eigen::VectorXd values(12);
  values << 1, 1, 1, 1, 5, 5, 5, 5, 20, 20, 20, 20;
  const Eigen::MatrixXd a = values.asDiagonal();
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(12, 1.0, 2.0);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(12), residual = b;
  const KrylovResult result = gmres(product(a), same, residual, x, 1e-12 * b.norm(), 12);
  CHECK(result.converged);
  CHECK(result.iterations == 3);
  CHECK((a * x - b).norm() <= 1e-12 * b.norm());
  CHECK((residual - (b - a * x)).norm() <= 1e-14 * b.norm());
}

TEST_CASE("GMRES brings the residual itself down, whatever the scale of the preconditioner", "[linear][krylov]") {
  RandomSystems random(12);
  const int n = 60;
  Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.number(); });
  a.diagonal().array() += 20.0;
  Eigen::MatrixXd nearly = a;
  for (int i = 0; i < n; ++i) nearly(i, i) *= 1.0 + 0.05 * random.number();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(nearly);
  const Eigen::VectorXd b = random.vector(n), start = random.vector(n);
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const LinearMap precondition = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd { return scale * lu.solve(v); };
    Eigen::VectorXd x = start, residual = b - a * x;
    const double wanted = 1e-8 * residual.norm();
    const KrylovResult result = gmres(product(a), precondition, residual, x, wanted, 30);
    CHECK(result.converged);
    CHECK((a * x - b).norm() <= 1.001 * wanted);
    CHECK(result.iterations <= 10);
  }
}

TEST_CASE("GMRES gives up early where it is too slow and leaves x alone", "[linear][krylov]") {
  // The shift of a ring: no polynomial of low degree brings anything.
  const int n = 50;
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) shift(i, (i + 1) % n) = 1.0;
  const Eigen::VectorXd b = Eigen::VectorXd::Unit(n, 0);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n), residual = b;
  const KrylovResult result = gmres(product(shift), same, residual, x, 1e-6, 20);
  CHECK_FALSE(result.converged);
  CHECK(result.iterations <= 6);  // three tenths of those allowed
  CHECK(x.isZero(0.0));
  CHECK(residual == b);
}
