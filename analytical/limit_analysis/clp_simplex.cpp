#include <ClpSimplex.hpp>
#include <ClpSolve.hpp>
#include <CoinError.hpp>

#include "openclose/limit_analysis/simplex.h"
#include "openclose_traps.h"

namespace openclose::limit_analysis {
namespace {

/// False, too, where CLP gives up with an error. It computes with its infinity, and its answers are verified without it.
template <class Solve>
bool is_solved(const Solve& solve) try {
  const NonStop non_stop;
  return solve();
} catch (const CoinError&) {
  return false;
}

}  // namespace

class Simplex::Model : public ClpSimplex {};

const unsigned char Simplex::at_lower_bound = ClpSimplex::atLowerBound;
const bool Simplex::available = true;

Simplex::Simplex(double tolerance) : model_(std::make_unique<Model>()) {
  model_->setLogLevel(0);
  model_->setPrimalTolerance(tolerance);
  model_->setDualTolerance(tolerance);
}
Simplex::~Simplex() = default;
Simplex::Simplex(Simplex&&) noexcept = default;
Simplex& Simplex::operator=(Simplex&&) noexcept = default;

void Simplex::load(const Columns& columns, const std::vector<double>& right_side) {
  std::vector<CoinBigIndex> starts(columns.starts_.begin(), columns.starts_.end());
  starts.push_back(static_cast<CoinBigIndex>(columns.values_.size()));
  model_->loadProblem(columns.count(), static_cast<int>(right_side.size()), starts.data(), columns.rows_.data(), columns.values_.data(),
                      columns.low_.data(), columns.high_.data(), columns.cost_.data(), right_side.data(), right_side.data());
}

bool Simplex::solve_from(const Basis& basis) {
  return is_solved([&] {
    model_->copyinStatus(basis.data());
    model_->primal();
    return model_->isProvenOptimal();
  });
}

bool Simplex::solve_by_barrier(bool with_crossover) {
  return is_solved([&] {
    ClpSolve barrier;
    barrier.setSolveType(with_crossover ? ClpSolve::useBarrier : ClpSolve::useBarrierNoCross);
    barrier.setPresolveType(ClpSolve::presolveOff);
    model_->initialSolve(barrier);
    // A barrier that stops early may have what is asked for; who asks verifies it.
    return !with_crossover || model_->isProvenOptimal();
  });
}

bool Simplex::solve_from_zero() {
  return is_solved([&] {
    model_->allSlackBasis(true);
    model_->dual();
    return model_->isProvenOptimal();
  });
}

const double* Simplex::columns() const {
  return model_->primalColumnSolution();
}

const double* Simplex::prices() const {
  return model_->dualRowSolution();
}

double Simplex::cost() const {
  return model_->objectiveValue();
}

Simplex::Basis Simplex::basis() const {
  return {model_->statusArray(), model_->statusArray() + model_->numberRows() + model_->numberColumns()};
}

}  // namespace openclose::limit_analysis
