#include "openclose/linear/single_solver.h"

#include "openclose/linear/incomplete.h"

namespace openclose {
namespace {

/// [-] Pivots that have lost more of their diagonal block than this are not known any more: of the numbers of 16 bits 3 % would be left.
constexpr double largest_loss = 1e3;

class EstimatingSolver : public LinearSolver {
 public:
  bool factor(const BlockMatrix& matrix, double) override {
    ++(factor_.analyse(matrix) ? this->counters_.symbolic : this->counters_.symbolic_skipped);
    ++this->counters_.factorisations;
    plain_ = nullptr;
    if (factor_.factor(matrix) && factor_.largest_inverse() <= largest_loss) return true;
    ++this->counters_.pivots_lost;
    factor_.let_go();
    plain_ = make_block_solver(Factoring::whole);
    return plain_->factor(matrix);
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& right_side, double reduction) override {
    ++this->counters_.solves;
    return plain_ ? plain_->solve(right_side, reduction) : factor_.solve(right_side);
  }
  Memory memory() const override {
    Memory of = plain_ ? plain_->memory() : Memory();
    of.factor += factor_.bytes();
    return of;
  }

 private:
  IncompleteLu factor_{Factoring::whole, Fill::all};
  std::unique_ptr<LinearSolver> plain_;  ///< in its place where pivots are lost
};

}  // namespace

std::unique_ptr<LinearSolver> make_estimating_solver() {
  return std::make_unique<EstimatingSolver>();
}

}  // namespace openclose
