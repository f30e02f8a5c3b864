#include "openclose/integrator/spring_groups.h"

#include <algorithm>
#include <numeric>

namespace openclose {

SpringGroups::SpringGroups(const StepProblem& problem, double stiffness_over_inertia)
    : problem_(problem), first_(problem.system.free_count()), groups_(first_.size()) {
  unite();
  std::vector<double> length(first_.size(), 0.0), stiffness(first_.size(), 0.0);  // [m], [N] length times stiffness
  for (const Contact& contact : problem.contacts) {
    const double joint = problem.joints.joint(contact.joint).normal_stiffness;
    for (const int b : {contact.vertex_block, contact.edge_block}) {
      const int equation = problem.system.block(b).equation;
      if (equation < 0) continue;
      length[equation] += contact.length;
      stiffness[equation] += contact.length * (joint * contact.length);
      Group& of = groups_[first_[equation]];
      of.stiffest_joint = std::max(of.stiffest_joint, joint);
    }
  }
  for (const int b : problem.system.free_blocks()) {
    const auto& block = problem.system.block(b);
    if (stiffness[block.equation] == 0.0) continue;
    const double mean = stiffness[block.equation] / length[block.equation];
    Group& of = groups_[first_[block.equation]];
    of.factor = std::max(of.factor, stiffness_over_inertia * problem.inertia * block.mass[0] / mean);
  }
}

/// Sets of equations that are joined, each as a tree whose root is its smallest one (R. E. Tarjan, Efficiency of a good but not linear set union
/// algorithm, J. ACM 22 (1975)).
void SpringGroups::unite() {
  std::iota(first_.begin(), first_.end(), 0);
  for (const Contact& contact : problem_.contacts) {
    const int one = problem_.system.block(contact.vertex_block).equation, other = problem_.system.block(contact.edge_block).equation;
    if (one < 0 || other < 0) continue;
    const int a = first_of(one), b = first_of(other);
    first_[std::max(a, b)] = std::min(a, b);
  }
  for (int equation = 0; equation < static_cast<int>(first_.size()); ++equation) first_[equation] = first_of(equation);
}

int SpringGroups::first_of(int equation) {
  while (first_[equation] != equation) equation = first_[equation] = first_[first_[equation]];
  return equation;
}

int SpringGroups::equation_of(const Contact& contact) const {
  return std::max(problem_.system.block(contact.vertex_block).equation, problem_.system.block(contact.edge_block).equation);
}

}  // namespace openclose
