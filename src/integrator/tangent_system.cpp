#include "openclose/integrator/tangent_system.h"

#include <algorithm>
#include <numeric>

namespace openclose {
namespace {

/// A saved state with more rows is damaged: no scene has so many blocks.
constexpr int most_rows = 1 << 24;

bool is_row(int row, int rows) {
  return row >= 0 && row < rows;
}

}  // namespace

template <class BlocksOf>
bool TangentSystem::find_slots(std::size_t count, const BlocksOf& blocks_of) {
  slots_.diagonals.clear();
  for (int row : row_of_) slots_.diagonals.push_back(row < 0 ? matrix_.nobody() : matrix_.diagonal(row));
  const ContactSlots nobodies{matrix_.nobody(), matrix_.nobody()};
  const std::size_t known = slots_.of_contacts.size();
  resize_closely(slots_.of_contacts, (count + batch_size - 1) / batch_size * batch_size);
  std::fill(slots_.of_contacts.begin() + static_cast<std::ptrdiff_t>(std::min(count, known)), slots_.of_contacts.end(), nobodies);
  for (std::size_t c = 0; c < count; ++c) {
    ContactSlots& slots = slots_.of_contacts[c];
    const auto [a, b] = blocks_of(c);
    const int i = row_of_[a], j = row_of_[b];
    if (i < 0 || j < 0) {
      slots = nobodies;
      continue;
    }
    if (matrix_.is_at(slots.vertex_edge, i, j)) continue;  // most contacts have their places of the last step
    slots = {matrix_.find(i, j), matrix_.find(j, i)};
    if (slots.vertex_edge < 0) {
      slots_.of_contacts.clear();
      return false;
    }
  }
  return true;
}

void TangentSystem::fit(const StepProblem& problem) {
  row_of_.clear();
  for (int b = 0; b < problem.system.block_count(); ++b) row_of_.push_back(problem.system.block(b).equation);
  fit_pattern(problem, [&](std::size_t c) { return std::pair(problem.contacts[c].vertex_block, problem.contacts[c].edge_block); });
}

void TangentSystem::fit(const StepProblem& problem, const std::vector<ContactBatch>& contacts) {
  row_of_.resize(problem.system.free_count() + 1);
  std::iota(row_of_.begin(), row_of_.end() - 1, 0);
  row_of_.back() = BlockSystem::fixed;
  fit_pattern(problem, [&](std::size_t at) {
    const ContactBatch& batch = contacts[at / batch_size];
    const int k = static_cast<int>(at % batch_size);
    return std::pair(batch.vertex_place(k), batch.edge_place(k));
  });
}

template <class BlocksOf>
void TangentSystem::fit_pattern(const StepProblem& problem, const BlocksOf& blocks_of) {
  skip_symbolic_ = problem.method.skip_symbolic;
  const int rows = problem.system.free_count();
  const bool fits = solver_ && matrix_.rows() == rows && find_slots(problem.contacts.size(), blocks_of);
  if (!fits) renew_pattern(problem.method, rows, problem.contacts.size(), blocks_of);
  matrix_.use_threads(problem.method.threads);
  solver_->use_threads(problem.method.threads);
}

void TangentSystem::fit_part(const MethodInput& method, int rows, int blocks, const std::vector<std::pair<int, int>>& contacts) {
  row_of_.assign(blocks, BlockSystem::fixed);
  std::iota(row_of_.begin(), row_of_.begin() + rows, 0);
  solver_ = nullptr;
  renew_pattern(method, rows, contacts.size(), [&](std::size_t c) { return contacts[c]; });
}

template <class BlocksOf>
void TangentSystem::renew_pattern(const MethodInput& method, int rows, std::size_t count, const BlocksOf& blocks_of) {
  std::vector<std::pair<int, int>> couplings;
  for (std::size_t c = 0; c < count; ++c) {
    const auto [a, b] = blocks_of(c);
    const std::pair<int, int> coupling = std::minmax(row_of_[a], row_of_[b]);
    if (coupling.first >= 0 && (couplings.empty() || couplings.back() != coupling))
      couplings.push_back(coupling);  // a pair's contacts are neighbours
  }
  kind_ = method.linear_solver;
  factoring_ = method.skip_factorisation ? Factoring::needed : Factoring::whole;
  set_pattern(rows, couplings);
  find_slots(count, blocks_of);
}

void TangentSystem::set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings) {
  matrix_.set_pattern(rows, couplings);
  slots_.of_contacts.clear();
  if (!solver_) choose_solver(rows);
}

void TangentSystem::choose_solver(int rows) {
  solver_rows_ = rows;
  solver_ = make_solver(kind_, factoring_);
}

bool TangentSystem::factor(double kept_change) {
  if (!skip_symbolic_) matrix_.renew_version();
  const bool regular = solver_->factor(matrix_, kept_change);
  solver_memory_.grow_to(solver_->memory());
  return regular;
}

Eigen::VectorXd TangentSystem::solve(const Eigen::VectorXd& right_side, double reduction, double enough) {
  Eigen::VectorXd x = solver_->solve(right_side, reduction, enough);
  solver_memory_.grow_to(solver_->memory());
  return x;
}

Memory TangentSystem::memory() const {
  Memory of = solver_memory_;
  of.matrix = matrix_.bytes();
  of.contacts = bytes_of(slots_.of_contacts);
  of.blocks = bytes_of(row_of_, slots_.diagonals);
  return of;
}

void TangentSystem::exchange(Archive& archive) {
  int rows = matrix_.rows();
  auto couplings = matrix_.couplings();
  archive(solver_rows_, rows, couplings, kind_, factoring_);
  const bool known = kind_ <= LinearSolverKind::plain && factoring_ <= Factoring::needed;
  archive.require(known && rows >= 0 && rows < most_rows, "the saved state has a solver that there is not");
  if (solver_rows_ == no_solver) return;
  archive.require(std::all_of(couplings.begin(), couplings.end(),
                              [rows](const auto& c) { return c.first != c.second && is_row(c.first, rows) && is_row(c.second, rows); }),
                  "the saved state has a matrix with rows that are not there");
  if (archive.reading()) {
    choose_solver(solver_rows_);
    set_pattern(rows, couplings);
  }
  solver_->exchange(archive, matrix_);
}

}  // namespace openclose
