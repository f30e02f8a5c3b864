// `dem`, one step of the explicit method written plainly: the forces where the step starts move the blocks, then the contacts follow.
//
// This is the reference that the loop of central_difference.h is tested against; Simulation takes that one.
#include <algorithm>

#include "openclose/integrator/crossing_energy.h"
#include "openclose/integrator/registry.h"

namespace openclose {
namespace {

class Dem : public Enforcement {
 public:
  using Unknowns = Motion::Unknowns;

  ContactSprings springs(const StepProblem& problem, const Contact& contact) const override { return joint_springs(problem, contact); }

  void solve(const StepProblem& problem, StepSolution& solution) override {
    const BlockSystem& system = problem.system;
    solution.d = Eigen::VectorXd::Zero(dofs * system.free_count());
    if (problem.statics) {
      solution.reason = "method.contact = \"dem\" has no static steps";
      return;
    }
    const Unknowns still = Unknowns::Zero();
    Eigen::VectorXd force = Eigen::VectorXd::Zero(dofs * system.free_count());
    for (const Contact& c : problem.contacts) {
      const auto velocity = [&](int b) { return problem.velocity(b); };
      ContactOutcome o = outcome(
          problem, c, [&](int) { return still; }, velocity);
      if (o.forces.status == ContactStatus::open && c.status == ContactStatus::open) {
        o.forces.normal = c.normal_force;
        o.forces.shear = c.shear_force;
      }
      const ContactKinematics k(o.pose);
      add(force, system.block(c.vertex_block).equation, o.forces.normal * k.normal_vertex + o.forces.shear * k.shear_vertex);
      add(force, system.block(c.edge_block).equation, o.forces.normal * k.normal_edge + o.forces.shear * k.shear_edge);
      solution.start_contacts.push_back(o);
    }
    for (int b : system.free_blocks()) {
      const auto& block = system.block(b);
      const Unknowns total = force.segment<dofs>(dofs * block.equation) + problem.external.force(system, b, still);
      Unknowns d = problem.dt * problem.velocity(b) + total.cwiseQuotient(problem.inertia * block.mass);
      if (block.rotation_locked) d[Motion::rotation_index] = 0.0;
      solution.d.segment<dofs>(dofs * block.equation) = d;
    }
    const auto displacement = [&](int b) { return solution.of(system, b); };
    const auto velocity = [&](int b) { return Unknowns(solution.of(system, b) / problem.dt); };
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      ContactOutcome end = outcome(problem, problem.contacts[i], displacement, velocity);
      settle_opening(problem, problem.contacts[i], solution.start_contacts.forces(i), end);
      solution.contacts.push_back(end);
    }
    solution.converged = true;
  }

  std::unique_ptr<TimeScheme> make_time_scheme(const MethodInput& method) const override {
    refuse_integrators(method);
    const auto refuse = [&](const char* key, const char* value) {
      throw InputError(method.contact_where, key, std::string(value) + " has no meaning for method.contact = \"dem\"", "the default");
    };
    if (method.statics) refuse("method.statics", "true");
    if (method.rotation != RotationKind::exact) refuse("method.rotation", "\"linear\"");
    return make_central_difference_scheme();
  }
  bool is_explicit() const override { return true; }
  bool has_joint_springs() const override { return true; }
  LinearCounters linear_counters() const override { return counters_; }

 private:
  /// Springs and dashpots of a contact after the blocks have moved, with the velocities of the middle of the last step.
  template <class Displacement, class Velocity>
  ContactOutcome outcome(const StepProblem& problem, const Contact& contact, const Displacement& d, const Velocity& v) const {
    const int a = contact.vertex_block, b = contact.edge_block;
    const TabulatedJoint& joint = problem.joints.joint(contact.joint);
    const ContactDashpots dashpots(joint, contact.length, problem.system.reduced_mass(a, b));
    const ContactSprings s = springs(problem, contact);
    const ContactKinematics k(problem.system, contact, d(a), d(b));
    ForceTrials trial;
    trial.elastic_normal = -s.normal * ((s.gap - s.target) + k.gap_change);
    trial.viscous_normal = -dashpots.normal * (k.normal_vertex.dot(v(a)) + k.normal_edge.dot(v(b)));
    trial.elastic_shear = s.initial_shear - s.shear * k.slip_change;
    trial.viscous_shear = -dashpots.shear * (k.shear_vertex.dot(v(a)) + k.shear_edge.dot(v(b)));
    return {s, carry(ContactStrength(joint, contact), trial), k.pose()};
  }

  /// See crossing_energy.h.
  static void settle_opening(const StepProblem& problem, const Contact& contact, const CarriedForces& start, ContactOutcome& end) {
    if (start.status == ContactStatus::open || end.forces.status != ContactStatus::open) return;
    const double share = problem.method.step_fraction * problem.method.step_fraction;
    if (ContactStrength(problem.joints.joint(contact.joint), contact).tension > 0.0) return;
    const double gap = contact.stretch() + end.pose.gap_change;
    const double energy = 0.5 * std::min(start.normal, start.elastic_normal) * gap + contact.crossing_energy;
    const Opening opening = settled(energy, end.normal_stiffness, end.pose.gap_change, end.shear_stiffness, end.pose.slip_change,
                                    contact.elastic_slip, start.shear, share);
    end.forces.normal = opening.normal;
    end.forces.shear = opening.shear;
    end.crossing_energy = opening.energy;
  }

  static void add(Eigen::VectorXd& force, int equation, const Unknowns& f) {
    if (equation >= 0) force.segment<dofs>(dofs * equation) += f;
  }

  LinearCounters counters_;
};

}  // namespace

std::unique_ptr<Enforcement> make_dem() {
  return std::make_unique<Dem>();
}

}  // namespace openclose
