// The equations of motion of a step as functions of the blocks' displacements: what is left of the forces and the inertia of each block, how much of
// it is balance, and how it changes with the displacements. It knows nothing of how the displacements are found.
//
//   r(d) = inertia M (drift - d) + theta F(d) + (1 - theta) F(0), see time_scheme.h
#pragma once

#include <vector>

#include "openclose/integrator/contact_trial.h"
#include "openclose/integrator/tangent_system.h"

namespace openclose {

class StepEquations {
 public:
  using Unknowns = Motion::Unknowns;

  /// A free block in the step; by their equations.
  struct StepBlock {
    int block = 0;
    bool has_elements = false, rotation_locked = false;
    double radius = 0.0;
    Unknowns inertia, force, drift;        ///< mass over time squared; all but contacts' at the start; displacement without forces
    double magnitude = 0.0;                ///< [N] of these forces
    double rounding_of_coordinates = 0.0;  ///< [N]
    double emphasis = 1.0;                 ///< [-] of its residual, see StepProblem::emphasis()
    bool is_alone = false;                 ///< without contacts and point forces
  };

  /// \param contacts  to be laid out for the step; they must outlive what is asked of its equations
  void prepare(const StepProblem& problem, const SpringsOf& springs, ContactTrial& contacts);
  /// The same step with springs that differ only in what they carry at its start, in the gaps they keep and in their stiffness.
  void prepare_again(const std::vector<ContactSprings>& springs, ContactTrial& contacts);
  /// The equations of a part of another system, while all other blocks stay where they are there.
  void take_part(const StepEquations& whole, const Part& part, ContactTrial& contacts);
  /// Blocks that nothing touches go where constant forces move them, which is known at once. They have no residual, and their forces are no measure
  /// of others, so that whatever they are changes not a bit of what the others do.
  void move_blocks_alone(Eigen::VectorXd& d) const;
  /// Evaluates at the present position and keeps the forces as those at the start.
  void sum_start_forces();

  void evaluate(const Eigen::VectorXd& d);
  const Eigen::VectorXd& residual() const { return residual_; }
  double unbalanced(int row) const;   ///< [N] residual of a block
  double largest_unbalanced() const;  ///< [N] by StepProblem::emphasis()
  double tolerated(int row) const;    ///< [N] of it
  /// Largest residual of a block over what is tolerated: converged at 1, which is also what negligible ones count for; infinite where that tells
  /// nothing.
  double residual_norm() const;
  /// What a step must reduce: in motion the work of all residuals on what inertia alone would let them move [J^1/2], so that a single block does not
  /// stop the others; at rest the residual_norm(), which is given.
  double merit(double norm) const;
  /// Whether no block has a velocity, nor a force that would give it one worth the name: the tolerance, of the largest force, may be finer than what
  /// the equilibrium was found to.
  bool stands_still() const;
  double force_scale() const { return force_scale_; }  ///< [N] largest single force in the last evaluation

  /// Adds up the derivatives. Rows and columns of locked rotations are those of the unit matrix.
  /// \param exact          with the terms that are not symmetric
  /// \param open_ones_too  contacts that are open may have a stiffness, too
  void assemble(const Eigen::VectorXd& d, bool exact, bool open_ones_too, const MatrixSlots& slots, BlockMatrix& matrix) const;

  // What contacts carry in the next linear solve in place of what the law says.
  /// The laws' linear pieces of the last step, wherever the iteration starts from, so that a step in which no contact changes its state needs one
  /// solve. Corners that only touch count as sticking, unless their springs are known to hang loose.
  void take_last_states();
  /// The pieces of these branches, around the forces that the springs start from.
  void take_states(const std::vector<Branch>& branches);
  /// Contacts that would slide one way and then the other stick in between: they enter with the spring's own force. (Where the spring is stiff the
  /// range of sticking is so narrow that the iteration would jump over it for ever.) Returns their number.
  int hold_reversed(const std::vector<Branch>& branches_before);

  const StepProblem& problem() const { return *problem_; }
  int rows() const { return static_cast<int>(blocks_.size()); }
  const std::vector<StepBlock>& blocks() const { return blocks_; }
  ContactTrial& contacts() { return *contacts_; }
  const ContactTrial& contacts() const { return *contacts_; }
  const Eigen::VectorXd& start_force() const { return start_force_; }
  Memory memory() const;  ///< without the contacts

 private:
  void find_blocks_alone();
  void move_block(int row, const Eigen::VectorXd& d);
  /// Forces and residual of a block to which its contacts have added theirs.
  void evaluate_block(int row, const Eigen::VectorXd& d);
  double magnitude(const StepBlock& block, const Unknowns& d) const;  ///< [N] of the forces on it but those of contacts
  void find_force_scale(double of_contacts, const Eigen::VectorXd& d);
  double start_scale() const;  ///< [N] largest single force at the start of the step, that of the inertia included
  /// Contact c carries these forces in the next linear solve.
  void replace_forces(std::size_t c, const ContactForces& forces);
  /// Contact c carries in the next linear solve what it would in this status around these forces.
  void take_state(std::size_t c, ContactStatus status, double normal, double shear);

  const StepProblem* problem_ = nullptr;
  ContactTrial* contacts_ = nullptr;
  std::vector<StepBlock> blocks_;
  std::vector<ForceRow> rows_;   ///< all forces at the trial position but inertia; of those that have no equation not to be read
  Eigen::VectorXd start_force_;  ///< the same at the start of the step, used if theta < 1
  Eigen::VectorXd residual_;
  double force_scale_ = 0.0;
  double contact_scale_ = 0.0;  ///< [N] of the springs at the start of the step
  double block_scale_ = 0.0;    ///< [N] of what acts then on blocks with contacts, that of the inertia included
};

}  // namespace openclose
