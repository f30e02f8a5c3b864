// `soft`, the paper's DDA-SC: the springs are the joint's own stiffness; penetration is the joint's closure and is not constrained.
#include <algorithm>
#include <cmath>

#include "openclose/integrator/accelerated_relaxation.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/newton.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

/// [-] path_average: largest dissipation of a contact, and that of a step which has no solution without.
constexpr double largest_dissipation = 0.1;

/// Free blocks from which on static steps are relaxed. The slope of example 3.4 with closer joints settles with 6,869 of them in 1.31, with 8,120 in
/// 1.04, with 9,745 in 0.53 of the instructions of Newton's method, at half of its memory, and with 43,000 and more by relaxation only. That is for
/// blocks of which many come loose: where few contacts change their states, as in a wall of bricks, Newton's method is quicker, and friction is not
/// what the vibrations of a relaxation leave in the joints (a wall of 10,040 bricks: 29 kN in its head joints, which carry nothing).
constexpr int many_blocks = 9000;

class Soft final : public Enforcement {
 public:
  ContactSprings springs(const StepProblem& problem, const Contact& contact) const override {
    ContactSprings s = joint_springs(problem, contact);
    add_dashpots(problem, contact, s);
    if (problem.averages_path() && problem.method.dissipation) {
      // In proportion to the step, so that it takes nothing from the order.
      const double frequency = std::sqrt(s.normal / problem.system.reduced_mass(contact.vertex_block, contact.edge_block));
      s.dissipation = std::min(largest_dissipation, *problem.method.dissipation * frequency * problem.dt);
    }
    return s;
  }

  void solve(const StepProblem& problem, StepSolution& solution) override {
    attempt(problem, springs_of(problem), solution);
    if (solution.converged || !problem.averages_path()) return;
    const StepEffort wasted = solution.effort;
    solution.clear();
    const auto most_dissipative = [&](std::size_t c) {
      ContactSprings s = springs(problem, problem.contacts[c]);
      s.dissipation = largest_dissipation;
      return s;
    };
    attempt(problem, most_dissipative, solution);
    solution.effort += wasted;
    solution.dissipative = true;
  }

  bool takes_adaptive_steps() const override { return true; }
  bool has_joint_springs() const override { return true; }
  std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const override { return make_integrator(method); }
  LinearCounters linear_counters() const override { return newton_.linear_counters(); }
  Memory memory() const override {
    Memory largest = newton_.memory();
    largest.grow_to(relaxation_.memory());
    return largest;
  }
  void exchange(Archive& archive) override {
    newton_.exchange(archive);
    archive(many_come_loose_);
  }

 private:
  void attempt(const StepProblem& problem, const SpringsOf& springs, StepSolution& solution) {
    solution.d = drift(problem);
    const StaticSolver solver = problem.statics ? problem.method.static_solver : StaticSolver::newton;
    const bool is_large = problem.system.free_count() >= many_blocks;
    if (solver == StaticSolver::newton || (solver == StaticSolver::automatic && !is_large)) return newton_.solve(problem, springs, solution);
    if (solver == StaticSolver::automatic && !many_come_loose_) {
      // Quick only if few contacts change their states.
      newton_.set_another_way(true);
      newton_.solve(problem, springs, solution);
      newton_.set_another_way(false);
      if (solution.converged) return;
      many_come_loose_ = true;
      const StepEffort wasted = solution.effort;
      solution.clear();
      solution.effort = wasted;
      solution.d = drift(problem);
    }
    relaxation_.solve(problem, springs, solution);
  }

  Newton newton_;
  AcceleratedRelaxation relaxation_{newton_.equations()};
  bool many_come_loose_ = false;  ///< a static step of many blocks has shown that Newton's method is not the way to their balance
};

}  // namespace

std::unique_ptr<Enforcement> make_soft() {
  return std::make_unique<Soft>();
}

}  // namespace openclose
