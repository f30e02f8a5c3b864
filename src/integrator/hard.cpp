// `hard`: no penetration, by multipliers that are iterated to convergence within the step (method of multipliers with Newton inside).
//
// Each outer pass solves N = max(0, shift - k (gap - target)), T = clamp(initial shear - k s) and takes N, T as the next pass's shift and initial
// shear. The passes converge whatever the stiffness k is (it only sets how fast), so the answer does not depend on the joint's stiffness: a closed
// contact keeps its gap exactly, a sticking one its place. In motion k is a multiple of the inertia, in statics of the joint's stiffness, which then
// decides how the first pass shares what rigid contacts leave undetermined.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "openclose/core/tolerance.h"
#include "openclose/integrator/newton.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

/// [-] Each outer pass reduces the error of the multipliers about by this factor; more would cost digits (rounding of the gap times the stiffness).
/// Where Newton gets lost among the contact states, the softer ones take more passes, each of them easier.
constexpr std::array stiffness_over_inertia = {1e3, 30.0, 1.0};
constexpr double stiffness_over_joint = 10.0;
/// [-] Units in the last place that rounding may leave in a gap.
constexpr double rounding_units = 4.0;
constexpr int most_outer_passes = 100;

template <int N>
class Hard : public Enforcement<N> {
 public:
  ContactSprings springs(const StepProblem<N>& problem, const Contact& contact) const override {
    return springs(problem, contact, stiffness_over_inertia.front());
  }

  StepSolution<N> solve(const StepProblem<N>& problem) override {
    StepSolution<N> solution;
    for (const double ratio : stiffness_over_inertia) {
      solve(problem, ratio, solution);
      if (solution.converged) break;
    }
    return solution;
  }

  std::unique_ptr<TimeScheme<N>> make_time_scheme(const MethodInput& method) const override {
    require_default_theta(method);
    return make_midstep_scheme<N>();
  }
  bool has_elastic_contacts() const override { return false; }
  const LinearCounters& linear_counters() const override { return newton_.linear_counters(); }

 private:
  static ContactSprings springs(const StepProblem<N>& problem, const Contact& contact, double ratio) {
    const JointProperties& joint = problem.joints.joint(contact.joint);
    double mass = 0.0;
    for (int b : {contact.vertex_block, contact.edge_block}) {
      if (problem.system.block(b).equation >= 0) mass = std::max(mass, problem.system.block(b).mass[0]);
    }
    const double from_inertia = ratio * problem.inertia * mass;
    const double normal_from_joint = stiffness_over_joint * joint.normal_stiffness * contact.length;
    const double shear_from_joint = stiffness_over_joint * joint.shear_stiffness * contact.length;
    ContactSprings s;
    s.normal = problem.statics ? std::max(from_inertia, normal_from_joint) : from_inertia;
    s.shear = problem.statics ? std::max(from_inertia, shear_from_joint) : from_inertia;
    s.gap = contact.gap;
    s.target = target_gap(problem, contact);
    s.shift = contact.normal_force;
    s.initial_shear = contact.shear_force;
    return s;
  }

  void solve(const StepProblem<N>& problem, double ratio, StepSolution<N>& solution) {
    springs_.clear();
    for (const Contact& c : problem.contacts) springs_.push_back(springs(problem, c, ratio));
    // From the drift dt v: the stiff matrix costs digits of what is solved for, and these are better lost from the change of motion than from the
    // motion.
    solution.d = Eigen::VectorXd::Zero(N * problem.system.free_count());
    for (int b : problem.system.free_blocks())
      solution.d.template segment<N>(N * problem.system.block(b).equation) = problem.dt * problem.velocity(b);
    for (int pass = 0; pass < most_outer_passes; ++pass) {
      newton_.solve(problem, springs_, solution);
      if (!solution.converged || constraints_hold(problem, ratio, solution)) return;
      for (std::size_t c = 0; c < springs_.size(); ++c) {
        springs_[c].shift = solution.contacts[c].forces.normal;
        springs_[c].initial_shear = solution.contacts[c].forces.shear;
      }
    }
    solution.converged = false;
    solution.reason = "the multipliers of hard contacts did not converge";
  }

  /// In motion a closed contact keeps the gap it has, so that standing still is always consistent; an open one closes to zero, and a penetration
  /// found on closing is pushed out slowly. In statics every contact goes back to zero gap.
  static double target_gap(const StepProblem<N>& problem, const Contact& contact) {
    if (problem.statics) return 0.0;
    if (contact.status != ContactStatus::open) return contact.gap;
    return std::min(0.0, contact.gap + tolerance::hard_recovery_m_per_s * problem.dt);
  }

  /// Gaps of closed contacts at their targets, sticking ones in place, both in metres and as the error of inertia force they leave.
  bool constraints_hold(const StepProblem<N>& problem, double ratio, const StepSolution<N>& solution) const {
    for (std::size_t c = 0; c < springs_.size(); ++c) {
      const ContactOutcome<N>& o = solution.contacts[c];
      if (o.forces.status == ContactStatus::open) continue;
      double error = std::abs((o.springs.gap - o.springs.target) + o.kinematics.gap_change);
      if (o.forces.status == ContactStatus::sticking) error = std::max(error, std::abs(o.kinematics.slip_change));
      const double inertia_force = error * o.springs.normal / ratio;
      const double tolerated = problem.method.residual_tolerance * newton_.force_scale();
      const bool rounding = error <= rounding_units * std::numeric_limits<double>::epsilon() * coordinates(problem, solution, problem.contacts[c]);
      if (error > tolerance::hard_gap_m || (!problem.statics && inertia_force > tolerated && !rounding)) return false;
    }
    return true;
  }

  /// [m] the coordinates and displacements of which a gap is the small difference; two contacts at one place differ by their rounding.
  static double coordinates(const StepProblem<N>& problem, const StepSolution<N>& solution, const Contact& contact) {
    double sum =
        problem.system.position(contact.vertex_block, contact.vertex).norm() + problem.system.position(contact.edge_block, contact.edge).norm();
    for (int b : {contact.vertex_block, contact.edge_block}) {
      sum += Motion<N>::displacement_bound(solution.of(problem.system, b), problem.system.block(b).radius);
    }
    return sum;
  }

  Newton<N> newton_;
  std::vector<ContactSprings> springs_;
};

}  // namespace

template <int N>
std::unique_ptr<Enforcement<N>> make_hard() {
  return std::make_unique<Hard<N>>();
}

template std::unique_ptr<Enforcement<3>> make_hard<3>();

}  // namespace openclose
