#include "openclose/integrator/tangent_system.h"

namespace openclose {

template <int N>
bool TangentSystem<N>::find_slots(const StepProblem<N>& problem) {
  slots_.clear();
  std::pair<int, int> last{-1, -1};
  ContactSlots slots;
  for (const Contact& c : problem.contacts) {
    const int i = problem.system.block(c.vertex_block).equation, j = problem.system.block(c.edge_block).equation;
    if (const std::pair pair{i, j}; pair != last) {  // contacts of one pair mostly follow one another
      last = pair;
      slots = {i < 0 ? -1 : matrix_.diagonal(i), j < 0 ? -1 : matrix_.diagonal(j), -1, -1};
      if (i >= 0 && j >= 0) {
        slots.vertex_edge = matrix_.find(i, j);
        slots.edge_vertex = matrix_.find(j, i);
        if (slots.vertex_edge < 0) return false;
      }
    }
    slots_.push_back(slots);
  }
  return true;
}

template <int N>
void TangentSystem<N>::fit(const StepProblem<N>& problem) {
  const int rows = problem.system.free_count();
  if (solver_ && matrix_.rows() == rows && find_slots(problem)) return;
  std::vector<std::pair<int, int>> couplings;
  for (const Contact& c : problem.contacts) {
    const int i = problem.system.block(c.vertex_block).equation, j = problem.system.block(c.edge_block).equation;
    if (i >= 0 && j >= 0) couplings.emplace_back(i, j);
  }
  kind_ = problem.method.linear_solver;
  set_pattern(rows, couplings);
  find_slots(problem);
}

template <int N>
void TangentSystem<N>::set_pattern(int rows, const std::vector<std::pair<int, int>>& couplings) {
  matrix_.set_pattern(rows, couplings);
  if (!solver_) solver_ = make_solver<N>(rows, kind_);
}

template <int N>
void TangentSystem<N>::exchange(Archive& archive) {
  int rows = solver_ ? matrix_.rows() : 0;
  auto couplings = matrix_.couplings();
  archive(rows, couplings, kind_);
  if (rows == 0) return;
  if (archive.reading()) set_pattern(rows, couplings);
  solver_->exchange(archive);
}

template class TangentSystem<3>;

}  // namespace openclose
