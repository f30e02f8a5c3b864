// A static step without linear equations, for systems whose factors cost more than everything else (n^1.5 operations, n log n numbers) and of which
// so many contacts come loose that no tangent tells where they go. Blocks follow the forces on them as far as they would go if all closed contacts
// stuck (two_level.h), with Nesterov's momentum (Y. Nesterov, 1983), which starts anew when the forces turn against it (B. O'Donoghue and E. Candes,
// 2015). Contacts slip on that way as they do in an explicit method, and keep their slip: friction that depended on the present place alone would
// feed vibrations instead of damping them. Rest is what it is for Newton's method, the residual alone.
#pragma once

#include <vector>

#include "openclose/integrator/step_equations.h"
#include "openclose/integrator/two_level.h"

namespace openclose {

class AcceleratedRelaxation {
 public:
  /// Works on the equations, which must outlive it.
  explicit AcceleratedRelaxation(StepEquations& equations) : equations_(equations) {}

  /// Solves a static step for solution.d, starting from the value it has; fills its contacts. What friction holds in the end depends on the way
  /// there.
  void solve(const StepProblem& problem, const SpringsOf& springs, StepSolution& solution);
  /// The largest so far, equations included.
  const Memory& memory() const { return memory_; }

 private:
  /// With the contacts that count, as if they stuck, and with blocks held so that their own unbalanced force moves them no farther than a way [m].
  TwoLevelFlexibility flexibility(const Eigen::VectorXd& d, const std::vector<bool>& counted, double longest_way) const;
  /// The springs of contacts that slide or are open slip to where they carry what these carry now.
  void keep_slip();
  /// What the law says of contact c for its way since the start of the step.
  /// \param springs  those that the step has started with
  ContactForces slipped_as_a_whole(const SpringsOf& springs, std::size_t c) const;
  /// Contacts that have slipped in the step as a whole and lose strength by that carry what they can without. True if there are any.
  bool break_slipped_bonds(const SpringsOf& springs);
  /// Those have slid for what loses its strength by that, though they stick on what they have kept.
  void note_slip(const SpringsOf& springs);
  /// Whether a block has gone so far that the step will be refused.
  bool has_left(const Eigen::VectorXd& d) const;
  ContactTrial& contacts() { return equations_.contacts(); }
  const ContactTrial& contacts() const { return equations_.contacts(); }

  StepEquations& equations_;
  std::vector<JointState> states_;  ///< of the joints, with the strength that they have lost on the way
  Memory memory_;
};

}  // namespace openclose
