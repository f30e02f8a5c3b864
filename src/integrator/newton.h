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
// In the motion of a large system a few contacts that change their states would make all blocks iterate. Between two iterations of the whole, the
// parts around them are solved for themselves (the nonlinear elimination of P. J. Lanzkron, D. J. Rose and J. T. Wilkes, 1996), so that the number of
// iterations of the whole does not grow with the system.
//
// Beyond that, factors cost more than everything else (n^1.5 operations, n log n numbers), and a slope of 50,000 blocks has so many loose contacts
// that no tangent tells where they go. relax() then finds the balance without a tangent: blocks follow the forces on them as far as they would go if
// all closed contacts stuck (two_level.h), with Nesterov's momentum (Y. Nesterov, 1983), which starts anew when the forces turn against it (B.
// O'Donoghue and E. Candes, 2015). Contacts slip on that way as they do in an explicit method, and keep their slip: friction that depended on the
// present place alone would feed vibrations instead of damping them. Rest is what it is for Newton's method, the residual alone.
#pragma once

#include <memory>

#include "openclose/integrator/batch_renewal.h"
#include "openclose/integrator/parts.h"
#include "openclose/integrator/tangent_system.h"
#include "openclose/integrator/two_level.h"

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
/// The same with held contacts, which are let go a few at a time, so that residuals fall in leaps, if the iteration does not go round in a circle: a
/// slope of 4,568 free blocks found its balance after 84 iterations, 39 of which did not halve the residual, one of 9,745 went round for 120.
constexpr int most_iterations_to_halve_holding = 60;
/// The same for solve_if_few_change(): where few contacts change, their hold is soon let go.
constexpr int most_iterations_to_halve_if_few_change = 10;

class Newton {
 public:
  using Unknowns = Motion::Unknowns;

  /// Solves for solution.d, starting from the value it has; fills its contacts. effort is added to.
  void solve(const StepProblem& problem, const SpringSource& springs, StepSolution& solution, FirstTangent first = FirstTangent::last_step);
  void solve(const StepProblem& problem, const std::vector<ContactSprings>& springs, StepSolution& solution,
             FirstTangent first = FirstTangent::last_step) {
    solve(problem, GivenSprings(springs), solution, first);
  }
  /// The step of the last solve() again, with springs that differ only in what they carry at its start, in the gaps they keep and
  /// in their stiffness.
  void solve_again(const std::vector<ContactSprings>& springs, StepSolution& solution, FirstTangent first);

  /// [-] Part of the cohesion over which it comes in, in what is solved from now on: see ShearLimit.
  void set_cohesion_ramp(double ramp) { ramp_ = ramp; }

  /// The same for a static step that has more blocks than Newton's method is quick with, unless few contacts change their state: ends without
  /// convergence as soon as held contacts do not bring the residual down quickly.
  void solve_if_few_change(const StepProblem& problem, const SpringSource& springs, StepSolution& solution);
  /// The same for a static step, by relaxation. What friction holds in the end depends on the way there.
  void relax(const StepProblem& problem, const SpringSource& springs, StepSolution& solution);

  /// Minus the derivative of all forces but inertia by the unknowns, at the start of the step, contacts in the status they have. Rows and columns of
  /// locked rotations are those of the unit matrix.
  Eigen::MatrixXd stiffness(const StepProblem& problem, const std::vector<ContactSprings>& springs);

  /// [N] forces of contacts, gravity, loads and supports at the present position.
  Eigen::VectorXd forces(const StepProblem& problem, const std::vector<ContactSprings>& springs);

  double force_scale() const { return force_scale_; }  ///< [N] largest single force in the last evaluation
  void exchange(Archive& archive) {
    tangent_.exchange(archive);
    archive(part_counters_);
  }
  /// The largest so far, factors of parts and of relaxation included; springs are their owner's.
  const Memory& memory() const { return memory_; }
  /// Those of parts included.
  LinearCounters linear_counters() const { return LinearCounters(tangent_.counters()) += part_counters_; }

 private:
  enum class Tangent { exact, symmetric };
  enum class Outcome { ended, singular, cold_start, no_common_step };

  /// What ends an iteration: a norm of the residual, or a number of linear solves.
  struct Until {
    double norm;
    int iterations;
  };

  struct StepBlock {
    int block = 0;
    bool has_elements = false, rotation_locked = false;
    double radius = 0.0;
    Unknowns inertia, force, drift;        ///< mass over time squared; all but contacts' at the start; displacement without forces
    double magnitude = 0.0;                ///< [N] of these forces
    double rounding_of_coordinates = 0.0;  ///< [N]
    bool is_alone = false;                 ///< without contacts and point forces
  };

  /// Takes back what outcomes have, so that the next step can be laid out in it.
  void take_back(ContactOutcomes& outcomes);
  /// Evaluates at the displacement to start from and returns its residual_norm().
  double begin(const Eigen::VectorXd& d, FirstTangent first);
  /// Whether no block has a velocity, nor a force that would give it one worth the name: the iteration's own tolerance, of the largest force, may be
  /// finer than what the equilibrium was found to.
  bool stands_still(const Eigen::VectorXd& d) const;
  /// Where an iteration stands.
  struct Course;
  /// Solves parts and says whether that has made the residual smaller.
  bool help_by_parts(StepSolution& solution, Course& course);
  /// Evaluates along a step and returns the part of it that was tried: all of one with the exact tangent.
  double try_step(const Eigen::VectorXd& d, const Eigen::VectorXd& step, const Course& course);
  /// The iteration has gone to where the forces are, with this residual_norm().
  void follow(Course& course, double norm);
  void choose_tangent(Course& course);
  /// Iterates from solution.d until its residual_norm() is small enough.
  Outcome iterate(const StepProblem& problem, StepSolution& solution, double& norm, Until until, bool may_start_cold);
  /// Solves the parts around the largest residuals, each for itself, and moves on with those that got better unless the residual is larger then.
  /// Returns its norm.
  double solve_parts(StepSolution& solution, double norm);
  std::vector<Part> unbalanced_parts(double norm, double end);
  /// The equations of a part of another system, while all other blocks stay where they are there.
  void take_part(const Newton& whole, const Part& part);
  /// Goes on, after the first iteration of a cold start, by whole steps with the exact tangent, in which what has just opened or begun to slide is
  /// still held by a part of its springs. False if blocks come loose all the same.
  bool iterate_from_cold(StepSolution& solution, double& norm);
  /// The same by whole steps with tangents that hold contacts which have changed their state.
  /// \param done  iterations that have been made so; the last one from branches_before_
  Outcome iterate_holding(StepSolution& solution, double& norm, int done);
  /// The next linear solve holds contacts by holds_. With friction that lags it leaves out for them that friction follows the normal force.
  void hold_contacts(bool friction_lags);
  /// Adapts holds_ to what an iteration has changed.
  void hold_changed(double norm);
  /// With the contacts that count, as if they stuck, and with blocks held so that their own unbalanced force moves them no farther than a way [m].
  TwoLevelFlexibility flexibility(const Eigen::VectorXd& d, const std::vector<bool>& counted, double longest_way) const;
  /// The springs of contacts that slide or are open slip to where they carry what these carry now.
  void keep_slip();
  /// What the law says of contact c for its way since the start of the step.
  /// \param springs  those that the step has started with
  ContactForces slipped_as_a_whole(const SpringSource& springs, std::size_t c) const;
  /// Contacts that have slipped in the step as a whole and lose strength by that carry what they can without. True if there are any.
  bool break_slipped_bonds(const SpringSource& springs);
  /// Those have slid for what loses its strength by that, though they stick on what they have kept.
  void note_slip(const SpringSource& springs);
  /// Whether a block has gone so far that the step will be refused.
  bool has_left(const Eigen::VectorXd& d) const;
  void prepare(const StepProblem& problem, const SpringSource& springs);
  /// Blocks that nothing touches go where constant forces move them, which is known at once. They have no residual, and their forces are no measure
  /// of others, so that whatever they are changes not a bit of what the others do.
  void find_blocks_alone();
  void move_blocks_alone(Eigen::VectorXd& d) const;
  /// The part of prepare() that solve_again() needs.
  void prepare_start(const std::vector<ContactSprings>& springs);
  void solve_prepared(StepSolution& solution, FirstTangent first);
  void evaluate(const Eigen::VectorXd& d);
  /// The same, to the last bit, where only these rows have moved since the last evaluation.
  void evaluate_moved(const std::vector<int>& moved, const Eigen::VectorXd& d, StepEffort& effort);
  /// Evaluates at the present position and keeps the forces.
  void sum_start_forces();
  void move_block(int row, const Eigen::VectorXd& d);
  /// Forces and residual of a block to which its contacts have added theirs.
  void evaluate_block(int row, const Eigen::VectorXd& d);
  double magnitude(const StepBlock& block, const Unknowns& d) const;  ///< [N] of the forces on it but those of contacts
  void find_force_scale(double of_contacts, const Eigen::VectorXd& d);
  /// The springs of contact c, with the gap counted from their target.
  ContactSprings springs(std::size_t c) const { return start(c).springs(lane(c)); }
  // Contact c of the problem is one of the lanes of its batch.
  static int lane(std::size_t c) { return static_cast<int>(c % batch_size); }
  std::vector<ContactBatch>& contacts() { return starts_->batches; }
  const std::vector<ContactBatch>& contacts() const { return starts_->batches; }
  const ContactBatch& start(std::size_t c) const { return contacts()[c / batch_size]; }
  TrialBatch& trial(std::size_t c) { return trials_[c / batch_size]; }
  const TrialBatch& trial(std::size_t c) const { return trials_[c / batch_size]; }
  ContactForces forces(std::size_t c) const { return trial(c).forces(lane(c), branches_[c]); }
  /// The forces act along its normal and tangent, at its arms.
  ContactPose force_pose(std::size_t c) const { return averages_path() ? mean_pose(start(c).start(lane(c)), pose(c)) : pose(c); }
  ContactPose pose(std::size_t c) const { return start(c).pose(lane(c), moves_); }
  bool averages_path() const { return step_forces_ == StepForces::averaged; }
  /// What a step sees of the springs of contact c while it stays closed: half of them, if it averages over its path.
  ContactSprings seen_springs(std::size_t c) const;
  /// Forces and derivatives for the first iteration: the laws' linear pieces of the last step, wherever the iteration starts from, so that a step in
  /// which no contact changes its state needs one solve. Corners that only touch count as sticking, unless their
  /// springs are known to hang loose.
  void take_last_states();
  /// Contact c carries these forces in the next linear solve.
  void replace_forces(std::size_t c, const ContactForces& forces);
  /// Contact c carries in the next linear solve what it would in this status around these forces.
  void take_state(std::size_t c, ContactStatus status, double normal, double shear);
  /// The same of branches_before_, around the forces that the springs start from.
  void take_states_before();
  /// What a step must reduce: in motion the work of all residuals on what inertia alone would let them move [J^1/2], so that a single block does not
  /// stop the others; at rest the residual_norm(), which is given.
  double merit(double norm) const;
  /// Largest residual of a block over what is tolerated: converged at 1, which is also what negligible ones count for; infinite where that tells
  /// nothing.
  double residual_norm() const;
  double unbalanced(int row) const;  ///< [N] residual of a block
  double largest_unbalanced() const;
  double tolerated(int row) const;  ///< [N] of it
  void assemble(const Eigen::VectorXd& d, Tangent tangent);
  /// \param reduction, enough  [-] of the residual by a linear solver, see LinearSolver::solve()
  Eigen::VectorXd direction(const Eigen::VectorXd& d, Tangent tangent, double reduction, double enough = 0.0);
  /// Contacts that would slide one way and then the other stick in between: they enter the next linear solve with the spring's own force. (Where the
  /// spring is stiff the range of sticking is so narrow that the iteration would jump over it for ever.) Returns their number.
  int hold_reversed();
  double line_search(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double slope);
  /// Part of the exact step along which the merit falls as it should; 0 if none. Leaves the forces there.
  double backtrack(const Eigen::VectorXd& d, const Eigen::VectorXd& step, double merit_before);
  /// The means over the path go to the solution, the forces at its end take their place.
  std::vector<ElasticBatch> report_paths(StepSolution& solution);
  std::vector<ElasticBatch> elastic_parts() const;
  /// The solution has the contacts' outcomes from here until the next step.
  void lend(StepSolution& solution);
  /// Of what there is now.
  Memory present_memory() const;
  /// Takes it into the account.
  /// \param others  what is there beside it
  void note_memory(const Memory& others = {}) { memory_.grow_to(present_memory() + others); }

  double ramp_ = tolerance::cohesion_ramp;  ///< [-]
  const StepProblem* problem_ = nullptr;
  BatchRenewal renewal_;
  std::size_t contact_count_ = 0;
  /// Of the problem's contacts, in statics in the order of the list. Steps that are known by their outcomes have them, too: where they still do,
  /// the next step has others.
  std::shared_ptr<ContactStarts> starts_ = std::make_shared<ContactStarts>();
  std::vector<StepBlock> blocks_;                ///< the free ones, by their equations
  std::vector<BlockMove> moves_;                 ///< at the trial displacement: of the rows, of others that a part sees, and of what stays
  StepForces step_forces_ = StepForces::at_end;  ///< what trials_ has
  std::vector<TrialBatch> trials_;
  std::vector<Branch> branches_;         ///< of the contacts
  std::vector<Branch> branches_before_;  ///< of the iteration
  std::vector<bool> has_broken_;         ///< contacts that have lost strength while they were relaxed
  std::vector<double> holds_;            ///< [-] part of its springs that an open or sliding contact has in the tangent; else empty
  Eigen::VectorXd trial_;                ///< displacement
  std::vector<ForceRow> rows_;           ///< all forces at the trial position but inertia; of those that have no equation not to be read
  bool has_replaced_forces_ = false;     ///< since the last evaluation: contacts carry something else than the law says
  Eigen::VectorXd start_force_;          ///< the same at the start of the step, used if theta < 1
  Eigen::VectorXd residual_;
  double force_scale_ = 0.0;
  double start_scale_ = 0.0;  ///< [N] largest single force at the start of the step, that of the inertia included
  double block_scale_ = 0.0;  ///< [N] the same of what acts on blocks without contacts
  TangentSystem tangent_;
  Neighbourhood neighbourhood_;  ///< of this step, once it is needed
  LinearCounters part_counters_;
  Memory memory_;
  bool is_part_ = false;
  bool only_if_few_change_ = false;
};

}  // namespace openclose
