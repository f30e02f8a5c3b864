#include <Eigen/LU>

#include "openclose/linear/krylov.h"
#include "random_systems.h"
#include "support/catch.h"

using namespace openclose;
using openclose::test::RandomSystems;

namespace {

/// In double precision, as the residual of what has come out.
MapInto product(const Eigen::MatrixXd& a) {
  return [&a](const Eigen::VectorXf& v, Eigen::VectorXf& product) { product = (a * v.cast<double>()).cast<float>(); };
}

void same(const Eigen::VectorXf& v, Eigen::VectorXf& of_v) {
  of_v = v;
}

double left_by(const KrylovStep& found, const Eigen::MatrixXd& a, const Eigen::VectorXf& residual) {
  REQUIRE(found.step.size() == residual.size());
  return (a * found.step.cast<double>() - residual.cast<double>()).norm();
}

}  // namespace

TEST_CASE("GMRES ends after as many iterations as the matrix has different eigenvalues", "[linear][krylov]") {
  Eigen::VectorXd values(12);
  values << 1, 1, 1, 1, 5, 5, 5, 5, 20, 20, 20, 20;
  const Eigen::MatrixXd a = values.asDiagonal();
  const Eigen::VectorXf b = Eigen::VectorXf::LinSpaced(12, 1.0f, 2.0f);
  KrylovRoom room;
  const KrylovStep found = krylov_step(product(a), same, b, 1e-5 * b.norm(), 12, room);
  CHECK(found.converged);
  CHECK(found.iterations == 3);
  CHECK(left_by(found, a, b) <= 1e-5 * b.norm());
}

TEST_CASE("GMRES brings the residual itself down, whatever the scale of the preconditioner", "[linear][krylov]") {
  RandomSystems random(12);
  const int n = 60;
  Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.number(); });
  a.diagonal().array() += 20.0;
  Eigen::MatrixXd nearly = a;
  for (int i = 0; i < n; ++i) nearly(i, i) *= 1.0 + 0.05 * random.number();
  const Eigen::PartialPivLU<Eigen::MatrixXd> lu(nearly);
  const Eigen::VectorXf residual = random.vector(n).cast<float>();
  KrylovRoom room;
  for (const double scale : {1.0, 1e-6, 1e6}) {
    const MapInto precondition = [&](const Eigen::VectorXf& v, Eigen::VectorXf& of_v) { of_v = (scale * lu.solve(v.cast<double>())).cast<float>(); };
    const double wanted = 1e-4 * residual.norm();
    const KrylovStep found = krylov_step(product(a), precondition, residual, wanted, 30, room);
    CHECK(found.converged);
    CHECK(left_by(found, a, residual) <= 1.01 * wanted);
    CHECK(found.iterations <= 5);
  }
}

TEST_CASE("GMRES ends with the iterations that are allowed and has no step where they do not reach", "[linear][krylov]") {
  // The shift of a ring: no polynomial of low degree brings anything.
  const int n = 50;
  Eigen::MatrixXd shift = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) shift(i, (i + 1) % n) = 1.0;
  KrylovRoom room;
  const KrylovStep found = krylov_step(product(shift), same, Eigen::VectorXf::Unit(n, 0), 1e-6, 20, room);
  CHECK_FALSE(found.converged);
  CHECK(found.iterations == 20);
  CHECK(found.step.size() == 0);
}
