#include <ClpEventHandler.hpp>
#include <ClpSimplex.hpp>
#include <ClpSolve.hpp>
#include <CoinError.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "openclose/limit_analysis/simplex.h"
#include "openclose_traps.h"

namespace openclose::limit_analysis {

/// Asks in the iterations of CLP whether to stop. What is thrown then must not cross the library: it is kept until that has returned.
class Simplex::Listener : public ClpEventHandler {
 public:
  struct State {
    std::function<void()> interruption;
    std::exception_ptr thrown;
    int iterations = 0;
  };

  explicit Listener(std::shared_ptr<State> state) : state_(std::move(state)) {}
  ClpEventHandler* clone() const override { return new Listener(*this); }

  int event(Event which) override {
    constexpr int goes_on = -1, stops = 0, iterations_between = 64;  // the last: some milliseconds where programs are large
    if (state_->thrown) return stops;                                // CLP tries other ways once it was stopped
    if (which != endOfIteration || ++state_->iterations % iterations_between != 0 || !state_->interruption) return goes_on;
    try {
      state_->interruption();
    } catch (...) {
      state_->thrown = std::current_exception();
      return stops;
    }
    return goes_on;
  }

 private:
  std::shared_ptr<State> state_;
};

class Simplex::Model : public ClpSimplex {
 public:
  Model() {
    const Listener listener(heard);
    passInEventHandler(&listener);
  }

  /// False, too, where CLP gives up with an error. It computes with its infinity, and its answers are verified without it.
  template <class Solve>
  bool is_solved(const Solve& solve) {
    if (!can_be_solved) return false;
    bool is_proved = false;
    try {
      const NonStop non_stop;
      is_proved = solve();
    } catch (const CoinError&) {
    }
    if (heard->thrown) std::rethrow_exception(std::exchange(heard->thrown, nullptr));
    return is_proved;
  }

  std::shared_ptr<Listener::State> heard = std::make_shared<Listener::State>();
  bool can_be_solved = true;
};

namespace {

/// [-] Numbers of a problem that differ by more are none of rock, and rounding (1e-17 of what is one) is still within it. There CLP ends the process:
/// its barrier method with strengths of 1e50, its simplex method with bounds of 1e100.
constexpr double widest_range = 1e35;

class Range {
 public:
  void take(const std::vector<double>& numbers) {
    for (const double number : numbers) {
      const double size = std::abs(number);
      if (size == 0.0 || size >= COIN_DBL_MAX || !std::isfinite(size)) continue;
      smallest_ = std::min(smallest_, size);
      largest_ = std::max(largest_, size);
    }
  }
  bool is_wide() const { return largest_ > widest_range * smallest_; }

 private:
  double smallest_ = std::numeric_limits<double>::infinity(), largest_ = 0.0;
};

}  // namespace

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

void Simplex::set_interruption(std::function<void()> f) {
  model_->heard->interruption = std::move(f);
}

void Simplex::load(const Columns& columns, const std::vector<double>& right_side) {
  std::vector<CoinBigIndex> starts(columns.starts_.begin(), columns.starts_.end());
  starts.push_back(static_cast<CoinBigIndex>(columns.values_.size()));
  model_->loadProblem(columns.count(), static_cast<int>(right_side.size()), starts.data(), columns.rows_.data(), columns.values_.data(),
                      columns.low_.data(), columns.high_.data(), columns.cost_.data(), right_side.data(), right_side.data());
  Range range;
  for (const auto* numbers : {&columns.values_, &columns.low_, &columns.high_, &columns.cost_, &right_side}) range.take(*numbers);
  model_->can_be_solved = !range.is_wide();
}

bool Simplex::solve_from(const Basis& basis) {
  return model_->is_solved([&] {
    model_->copyinStatus(basis.data());
    model_->primal();
    return model_->isProvenOptimal();
  });
}

bool Simplex::solve_by_barrier(bool with_crossover) {
  return model_->is_solved([&] {
    ClpSolve barrier;
    barrier.setSolveType(with_crossover ? ClpSolve::useBarrier : ClpSolve::useBarrierNoCross);
    barrier.setPresolveType(ClpSolve::presolveOff);
    // It would take Ctrl-C for itself, end this way of solving and go on with another one.
    constexpr int interrupts = 2, left_alone = 1;
    barrier.setSpecialOption(interrupts, left_alone);
    model_->initialSolve(barrier);
    // A barrier that stops early may have what is asked for; who asks verifies it.
    return !with_crossover || model_->isProvenOptimal();
  });
}

bool Simplex::solve_from_zero() {
  return model_->is_solved([&] {
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
