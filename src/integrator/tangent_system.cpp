#include "openclose/integrator/tangent_system.h"

#include <algorithm>

namespace openclose {
namespace {

/// A saved state with more rows is damaged: no scene has so many blocks.
constexpr int most_rows = 1 << 24;

bool is_row(int row, int rows) {
  return row >= 0 && row < rows;
}

/// Pairs of rows in contact; a pair's contacts are neighbours.
std::vector<std::pair<int, int>> couplings_of(const ContactTrial& contacts, int rows) {
  std::vector<std::pair<int, int>> couplings;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const auto [a, b] = contacts.places(c);
    const std::pair<int, int> coupling = std::minmax(a, b);
    if (coupling.second < rows && (couplings.empty() || couplings.back() != coupling)) couplings.push_back(coupling);
  }
  return couplings;
}

}  // namespace

bool TangentSystem::find_slots(const ContactTrial& contacts) {
  const int rows = matrix_.rows(), places = static_cast<int>(contacts.moves().size());
  slots_.diagonals.clear();
  for (int place = 0; place < places; ++place) slots_.diagonals.push_back(place < rows ? matrix_.diagonal(place) : matrix_.nobody());
  const ContactSlots nobodies{matrix_.nobody(), matrix_.nobody()};
  const std::size_t known = slots_.of_contacts.size();
  resize_closely(slots_.of_contacts, batch_size * contacts.batches().size());
  std::fill(slots_.of_contacts.begin() + static_cast<std::ptrdiff_t>(std::min(contacts.size(), known)), slots_.of_contacts.end(), nobodies);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    ContactSlots& slots = slots_.of_contacts[c];
    const auto [i, j] = contacts.places(c);
    if (i >= rows || j >= rows) {
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

void TangentSystem::fit(const MethodInput& method, int rows, const ContactTrial& contacts) {
  skip_symbolic_ = method.skip_symbolic;
  const bool fits = solver_ && matrix_.rows() == rows && find_slots(contacts);
  if (!fits) renew_pattern(method, rows, contacts);
  matrix_.use_threads(method.threads);
  solver_->use_threads(method.threads);
}

void TangentSystem::renew_pattern(const MethodInput& method, int rows, const ContactTrial& contacts) {
  kind_ = method.linear_solver;
  factoring_ = method.skip_factorisation ? Factoring::needed : Factoring::whole;
  set_pattern(rows, couplings_of(contacts, rows));
  find_slots(contacts);
}

void TangentSystem::set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings) {
  matrix_.set_pattern(rows, couplings);
  slots_.of_contacts.clear();
  if (!solver_) solver_ = make_solver(kind_, factoring_);
}

bool TangentSystem::factor(double kept_change) {
  if (!skip_symbolic_) matrix_.renew_version();
  const bool regular = solver_->factor(matrix_, kept_change);
  solver_memory_.grow_to(solver_->memory());
  return regular;
}

Eigen::VectorXd TangentSystem::solve(const Eigen::VectorXd& right_side, double reduction) {
  Eigen::VectorXd x = solver_->solve(right_side, reduction);
  solver_memory_.grow_to(solver_->memory());
  return x;
}

Memory TangentSystem::memory() const {
  Memory of = solver_memory_;
  of.matrix = matrix_.bytes();
  of.contacts = bytes_of(slots_.of_contacts);
  of.blocks = bytes_of(slots_.diagonals);
  return of;
}

void TangentSystem::exchange(Archive& archive) {
  int rows = matrix_.rows();
  auto couplings = matrix_.couplings();
  bool has_solver = solver_ != nullptr;
  archive(has_solver, rows, couplings, kind_, factoring_);
  const bool known = kind_ <= LinearSolverKind::plain && factoring_ <= Factoring::needed;
  archive.require(known && rows >= 0 && rows < most_rows, "the saved state has a solver that there is not");
  if (!has_solver) return;
  archive.require(std::all_of(couplings.begin(), couplings.end(),
                              [rows](const auto& c) { return c.first != c.second && is_row(c.first, rows) && is_row(c.second, rows); }),
                  "the saved state has a matrix with rows that are not there");
  if (archive.reading()) {
    forget();
    set_pattern(rows, couplings);
  }
  solver_->exchange(archive, matrix_);
}

}  // namespace openclose
