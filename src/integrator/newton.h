// Newton's method for one step with given contact springs.
//
// Two tangents: the exact one, non-symmetric where contacts slide, with backtracking on the residual, and where that finds no descent a symmetric one
// (sticking springs only) with an energy line search, which makes progress while many contacts still change state. Convergence means the residual
// alone: the contact states are functions of the displacement.
//
// Where a static step has thousands of loose contacts, a few of them make any common length of the step uselessly short. It is then begun again, from
// a cold start gone on with after its first iteration, with another tangent and whole steps: contacts that have just opened or slid are held by their
// springs in it, and let go while they stay as they are, each for itself. With all of them held the iteration is the one of initial stresses (O. C.
// Zienkiewicz, S. Valliappan and I. P. King, 1969), which is slow and steady; with none it is Newton's. The residual knows nothing of this, and so
// neither does the solution.
//
// What the equations are is in step_equations.h. In the motion of a large system parts of it are solved for themselves between two iterations, see
// subdomains.h.
#pragma once

#include "openclose/integrator/step_equations.h"
#include "openclose/integrator/subdomains.h"
#include "openclose/integrator/tangent_system.h"

namespace openclose {

/// Which contact states the first tangent is made of.
enum class FirstTangent {
  last_step,      ///< those of the last step: contacts in their old places do what they did
  last_solution,  ///< those of the contacts that the solution has, whose forces are what the springs start from
  present,        ///< those of the displacement that the iteration starts from
};

/// In motion: an iteration that has not halved the residuals in so many is lost among the contact states, where residuals have minima that are no
/// balance, and ends: softer springs, a longer ramp of the cohesion or a shorter step are the way then. Slopes of 387 to 4,568 free blocks: of 136
/// iterations that found their balance and went for more than 3 without halving the residuals, 3 did so for more than 30 and 13 for more than 20,
/// which is too soon; of 28 that found none in 60, 12 for more than 30.
constexpr int most_iterations_to_halve = 30;
/// The same with held contacts, which are let go a few at a time, so that residuals fall in leaps, if the iteration does not go round in a circle.
/// (With 30 a slope of 4,900 blocks settles in 181 iterations instead of 121, strength reductions of random slopes take 0.84 to 0.9 times as many.)
constexpr int most_iterations_to_halve_holding = 60;
/// The same, of either, where the caller has another way, see Newton::set_another_way(): a balance that is not found costs less than one that is
/// looked for in vain. Iterations with `hard` over those with the number above: four dropped piles 0.80 to 0.86, failing slopes of 387 to 4,568
/// blocks 0.83 to 1.02, twelve random tumbles 0.71 to 1.11; with 7 0.74 to 0.90, 0.84 to 1.15, 0.73 to 1.26, with 15 0.78 to 1.02, 0.80 to 1.03,
/// 0.90 to 1.10.
constexpr int most_iterations_to_halve_beside_another_way = 10;

/// What ends an iteration: a norm of the residual, or a number of linear solves.
struct NewtonEnd {
  double norm;
  int iterations;
};

/// [-] Of the residual by an iterative linear solver. What is left of it falls to the next iteration, which starts with more than that: from the
/// contacts that change state, or from the turning of the others. Iterations of all steps of a slope of 1,773 free blocks: 411 with 1e-12, 418 with
/// 1e-6, 420 with 1e-5, 432 with 1e-4.
inline constexpr double linear_reduction = 1e-5;

class Newton {
 public:
  /// Solves for solution.d, starting from the value it has; fills its contacts. effort is added to.
  void solve(const StepProblem& problem, const SpringsOf& springs, StepSolution& solution, FirstTangent first = FirstTangent::last_step);
  void solve(const StepProblem& problem, const std::vector<ContactSprings>& springs, StepSolution& solution,
             FirstTangent first = FirstTangent::last_step) {
    solve(problem, springs_in(springs), solution, first);
  }
  /// The step of the last solve() again, with springs that differ only in what they carry at its start, in the gaps they keep and
  /// in their stiffness.
  void solve_again(const std::vector<ContactSprings>& springs, StepSolution& solution, FirstTangent first);
  /// From now on: whether there is another way to the solution, so that an iteration which does not get on is given up sooner.
  void set_another_way(bool is_there) { has_another_way_ = is_there; }
  /// A part of another system for itself, while all other blocks stay where they are there, from found.d. True if its residual is smaller then.
  bool solve_part(const StepEquations& whole, const Part& part, NewtonEnd end, StepSolution& found);

  StepEquations& equations() { return equations_; }
  void exchange(Archive& archive) {
    tangent_.exchange(archive);
    archive(subdomains_);
  }
  /// The largest so far, factors of parts included; springs are their owner's.
  const Memory& memory() const { return memory_; }
  /// Of what there is now.
  Memory present_memory() const;
  /// Those of parts included.
  LinearCounters linear_counters() const { return tangent_.counters() += subdomains_.counters(); }

 private:
  enum class Tangent { exact, symmetric };
  enum class Outcome { ended, singular, cold_start, no_common_step };
  /// Where an iteration stands.
  struct Course;

  void solve_prepared(StepSolution& solution, FirstTangent first);
  /// Evaluates at the displacement to start from and returns its residual_norm().
  double begin(const Eigen::VectorXd& d, FirstTangent first);
  bool stands_still(const Eigen::VectorXd& d) const;
  /// Iterates from solution.d until its residual_norm() is small enough.
  Outcome iterate(const StepProblem& problem, StepSolution& solution, double& norm, NewtonEnd until, bool may_start_cold);
  /// Goes on, after the first iteration of a cold start, by whole steps with the exact tangent, in which what has just opened or begun to slide is
  /// still held by a part of its springs. False if blocks come loose all the same.
  bool iterate_from_cold(StepSolution& solution, double& norm);
  /// One of these: all digits of it, since single loose blocks have a small part of the residual. False if there is none or it goes farther.
  /// \param longest  [m]
  bool take_whole_step(StepSolution& solution, double longest, double& norm);
  /// The same by whole steps with tangents that hold contacts which have changed their state.
  /// \param done  iterations that have been made so; the last one from branches_before_
  Outcome iterate_holding(StepSolution& solution, double& norm, int done);
  /// Adapts holds_ to what an iteration has changed.
  void hold_changed(double norm);
  /// Solves parts and says whether that has made the residual smaller.
  bool help_by_parts(StepSolution& solution, Course& course);
  /// Evaluates along a step and returns the part of it that was tried: all of one with the exact tangent.
  double try_step(const Eigen::VectorXd& d, const Eigen::VectorXd& step, const Course& course);
  double line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double slope);
  /// Part of the exact step along which the merit falls as it should; 0 if none. Leaves the forces there.
  double backtrack(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double merit_before);
  /// The iteration has gone to where the forces are, with this residual_norm().
  void follow(Course& course, double norm);
  void choose_tangent(Course& course);
  void assemble(const Eigen::VectorXd& d, Tangent tangent);
  /// \param reduction  [-] of the residual by a linear solver, see LinearSolver::solve()
  Eigen::VectorXd direction(const Eigen::VectorXd& d, Tangent tangent, double reduction);
  ContactTrial& contacts() { return equations_.contacts(); }
  const std::vector<Branch>& branches() { return equations_.contacts().branches(); }
  /// Takes what there is now into the account.
  /// \param others  what is there beside it
  void note_memory(const Memory& others) { memory_.grow_to(present_memory() + others); }

  StepEquations equations_;
  TangentSystem tangent_;
  Subdomains subdomains_;
  std::vector<Branch> branches_before_;  ///< of the contacts, before the iteration
  std::vector<double> holds_;            ///< [-] part of its springs that an open or sliding contact has in the tangent; else empty
  Eigen::VectorXd trial_;                ///< displacement
  Memory memory_;
  bool is_part_ = false;
  bool has_another_way_ = false;
};

}  // namespace openclose
