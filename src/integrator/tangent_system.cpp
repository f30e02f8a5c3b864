#include "openclose/integrator/tangent_system.h"

namespace openclose {
namespace {

/// Calls f(i, j) for the block rows that contacts couple, once for contacts of one pair that follow one another.
template <int N, class F>
void for_each_coupling(const StepProblem<N>& problem, F f) {
  std::pair<int, int> last{-1, -1};
  for (const Contact& c : problem.contacts) {
    const std::pair pair{problem.system.block(c.vertex_block).equation, problem.system.block(c.edge_block).equation};
    if (pair.first < 0 || pair.second < 0 || pair == last) continue;
    f(pair.first, pair.second);
    last = pair;
  }
}

}  // namespace

template <int N>
bool TangentSystem<N>::has_room(const StepProblem<N>& problem) const {
  if (!solver_ || matrix_.rows() != problem.system.free_count()) return false;
  bool room = true;
  for_each_coupling(problem, [&](int i, int j) { room = room && matrix_.contains(i, j); });
  return room;
}

template <int N>
void TangentSystem<N>::fit(const StepProblem<N>& problem) {
  if (has_room(problem)) return;
  std::vector<std::pair<int, int>> couplings;
  for_each_coupling(problem, [&](int i, int j) { couplings.emplace_back(i, j); });
  matrix_.set_pattern(problem.system.free_count(), couplings);
  if (!solver_) solver_ = make_solver<N>(problem.system.free_count(), problem.method.linear_solver);
}

template class TangentSystem<3>;

}  // namespace openclose
