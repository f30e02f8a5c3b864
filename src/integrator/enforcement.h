// Contact enforcement: how one step is solved so that contacts carry their forces. `soft`, `hard`, `shi` and `dem` stand behind this interface;
// registry.h lists them.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "openclose/contact/joint_table.h"
#include "openclose/core/memory.h"
#include "openclose/integrator/contact_trial.h"
#include "openclose/integrator/time_scheme.h"
#include "openclose/linear/solver.h"
#include "openclose/model/external_forces.h"

namespace openclose {

/// What an explicit method lets happen to the strength of joints; other methods know the first only.
enum class Bonds : unsigned char {
  break_under_load,   ///< as the joints say
  last,               ///< contacts lose neither cohesion nor tensile strength
  last_without_slip,  ///< nor do they slip
  last_unparted,      ///< nor does tension part those that have tensile strength
};

/// [-] A block that is lighter than the heaviest one by more than this is at rest by its own weight. Of settle.unbalanced_fraction = 1e-8 this makes
/// 1e-5 of it, a tenth of the width to which factors of safety are found.
inline constexpr double largest_ratio_of_weights = 1e3;

/// [-] By how much more an unbalanced force counts on a block with this weight [N] than on the heaviest one. Blocks without weight count as that.
inline double emphasis_at_rest(double heaviest, double weight) {
  return weight > 0.0 ? std::max(1.0, heaviest / (largest_ratio_of_weights * weight)) : 1.0;
}

/// One step to be solved. Everything is as it stands at the start of the step.
struct StepProblem {
  const BlockSystem& system;
  const ExternalForces& external;
  const JointTable& joints;
  const std::vector<Contact>& contacts;
  const MethodInput& method;
  double dt = 0.0;          ///< [s]
  bool statics = false;     ///< velocities count as zero
  double inertia = 0.0;     ///< [1/s2] see time_scheme.h
  double end_weight = 1.0;  ///< theta
  int failed_attempts = 0;  ///< at steps from here
  Bonds bonds = Bonds::break_under_load;
  double heaviest_weight = 0.0;   ///< [N] of a static step: SimulationState::force_scale(), see emphasis_at_rest()
  double negligible_force = 0.0;  ///< [N] what it may leave unbalanced on a block, by that
  double longest_displacement = std::numeric_limits<double>::infinity();  ///< [m] of a vertex; a step that moves one farther is refused
  const TimeScheme* scheme = nullptr;                                     ///< null: every step starts from rest

  bool averages_path() const { return scheme && scheme->averages_path(); }
  /// [-] Of block b, which is free; see emphasis_at_rest().
  double emphasis(int b) const { return statics ? emphasis_at_rest(heaviest_weight, external.weight(system, b).norm()) : 1.0; }
  /// Displacement of block b if there were no forces.
  Motion::Unknowns drift(int b) const {
    const auto v = velocity(b);
    return scheme ? scheme->drift(b, dt, v) : Motion::Unknowns(dt * v);
  }
  Motion::Unknowns velocity(int b) const {
    if (statics) return Motion::Unknowns::Zero();
    return system.velocity(b);
  }
};

/// What a step has cost.
struct StepEffort {
  int iterations = 0;        ///< linear solves of the whole system
  int parts = 0;             ///< of the system, solved for themselves in between
  int part_iterations = 0;   ///< linear solves of parts
  long part_rows = 0;        ///< block rows in these
  int relaxation_steps = 0;  ///< evaluations of all forces instead, see accelerated_relaxation.h
  int estimates = 0;         ///< of the way that forces move blocks, made for these

  StepEffort& operator+=(const StepEffort& other) {
    iterations += other.iterations, parts += other.parts, part_iterations += other.part_iterations;
    part_rows += other.part_rows;
    relaxation_steps += other.relaxation_steps, estimates += other.estimates;
    return *this;
  }
};

struct StepSolution {
  bool converged = false;
  bool eased = false;        ///< `hard`: the cohesion came in over a longer ramp, see hard.cpp
  bool first_order = false;  ///< `shi`: loads and supports act as linearised at the start of the step
  bool dissipative = false;  ///< path_average: taken with more dissipation than asked for, see soft.cpp
  std::string reason;        ///< why not converged
  double part = 0.0;         ///< [-] not converged: of the step, a length that is likely to; 0 if that is not known
  double friction_work = 0.0,
         lagging_friction_work = 0.0;  ///< [J] `shi`: of sliding contacts by their strength, and what their friction missed it by
  StepEffort effort;
  Eigen::VectorXd d;        ///< displacement of the step, three numbers per free block
  double unbalanced = 0.0;  ///< [N] if static: largest residual of a block, by emphasis_at_rest()
  ContactTrial contacts;    ///< on which the step is solved, and what they did in it

  /// Empty again, with its memory for the next step.
  void clear() {
    converged = eased = first_order = dissipative = false;
    reason.clear();
    part = 0.0;
    friction_work = lagging_friction_work = 0.0;
    effort = {};
    unbalanced = 0.0;
    contacts.clear();
  }
  Memory memory() const {
    Memory of = contacts.memory();
    of.blocks += sizeof(double) * static_cast<std::size_t>(d.size());
    return of;
  }

  /// Displacement of block b: zero if fixed.
  Motion::Unknowns of(const BlockSystem& system, int b) const {
    const int equation = system.block(b).equation;
    if (equation < 0) return Motion::Unknowns::Zero();
    return d.segment<dofs>(dofs * equation);
  }
};

class Enforcement {
 public:
  virtual ~Enforcement() = default;

  /// Springs of a contact at the start of a step.
  virtual ContactSprings springs(const StepProblem& problem, const Contact& contact) const = 0;
  /// The same of all contacts of a step; enforcement and problem must outlive what is returned.
  SpringsOf springs_of(const StepProblem& problem) const {
    return [this, &problem](std::size_t c) { return springs(problem, problem.contacts[c]); };
  }
  /// Fills an empty solution.
  virtual void solve(const StepProblem& problem, StepSolution& solution) = 0;

  /// Throws InputError if the method asks for a theta that the enforcement has no use for.
  virtual std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const = 0;
  virtual bool follows_gaps() const { return true; }           ///< false: the gap at a step's end is not exactly that of the positions
  virtual bool has_elastic_contacts() const { return true; }   ///< false: contacts store no energy and keep no penetration
  virtual bool takes_adaptive_steps() const { return false; }  ///< true: step.adaptive has a meaning
  /// true: what a contact carries at rest is that of its joint_springs(), so that one such method's equilibrium is another one's.
  virtual bool has_joint_springs() const { return false; }
  /// true: steps need no equations to be solved but must stay below the critical one; Simulation takes them by CentralDifference.
  virtual bool is_explicit() const { return false; }
  /// [m] What a corner may enter a block by before there is a contact, see corner_entry.h.
  virtual double deepest_entry(const MethodInput&) const { return std::numeric_limits<double>::infinity(); }
  virtual double step_cut(const MethodInput&) const { return 0.5; }  ///< factor on a step that failed
  virtual LinearCounters linear_counters() const { return {}; }
  /// The largest so far, that of solutions included.
  virtual Memory memory() const { return {}; }
  /// Hands over what it keeps from step to step and what would change a result, be it in the last bit.
  virtual void exchange(Archive&) {}
};

/// Displacements of a step without forces, dt v: zero in statics. Three numbers per free block.
inline Eigen::VectorXd drift(const StepProblem& problem) {
  Eigen::VectorXd d(dofs * problem.system.free_count());
  for (int b : problem.system.free_blocks()) d.segment<dofs>(dofs * problem.system.block(b).equation) = problem.dt * problem.velocity(b);
  return d;
}

/// Springs of this stiffness [N/m]. The memory is the stretch of the spring, not its force: when the tributary length changes, strength and force
/// change alike.
inline ContactSprings springs_of_stiffness(const Contact& contact, double normal, double shear) {
  ContactSprings s;
  s.normal = normal;
  s.shear = shear;
  s.gap = contact.gap;
  s.target = contact.rest_gap;
  s.initial_shear = -s.shear * contact.elastic_slip;
  return s;
}

/// Springs of the joint's own stiffness.
inline ContactSprings joint_springs(const StepProblem& problem, const Contact& contact) {
  const JointSprings own(problem.joints.joint(contact.joint), contact.length);
  return springs_of_stiffness(contact, own.normal, own.shear);
}

/// Gives the springs the joint's dashpots for this step. They resist the mean velocity d/dt of the step with their whole force: what enters the
/// equation of motion with weight theta is divided by it, and the force at the start is the springs' alone. Pseudo-time has no velocities.
inline void add_dashpots(const StepProblem& problem, const Contact& contact, ContactSprings& springs) {
  const JointProperties& joint = problem.joints.joint(contact.joint);
  if (joint.damping_ratio == 0.0 || problem.statics) return;
  const ContactDashpots dashpots(joint, contact.length, problem.system.reduced_mass(contact.vertex_block, contact.edge_block));
  springs.normal_damping = dashpots.normal / (problem.end_weight * problem.dt);
  springs.shear_damping = dashpots.shear / (problem.end_weight * problem.dt);
}

/// For enforcements with a time scheme of their own: throws InputError if the scene chooses one.
inline void refuse_integrators(const MethodInput& method) {
  const auto refuse = [&](bool given, const char* key) {
    if (given) throw InputError(method.contact_where, key, "has no meaning for method.contact = \"" + method.contact + "\"", "contact = \"soft\"");
  };
  refuse(method.integrator.has_value(), "method.integrator");
  refuse(method.theta.value_or(1.0) != 1.0, "method.theta");
  refuse(method.rho_inf.has_value(), "method.rho_inf");
  refuse(method.dissipation.has_value(), "method.dissipation");
  refuse(method.first_integrator.has_value(), "method.first_integrator");
  refuse(method.static_solver != StaticSolver::automatic, "solver.static_solver");
}

}  // namespace openclose
