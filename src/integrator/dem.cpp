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
    ContactTrial& contacts = solution.contacts;
    contacts.prepare(problem, springs_of(problem));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact& c = problem.contacts[i];
      const ContactKinematics k(contacts.pose_at_start(i));
      CarriedForces f = forces(problem, c, k, [&](int b) { return problem.velocity(b); });
      if (f.status == ContactStatus::open && c.status == ContactStatus::open) {
        f.normal = c.normal_force;
        f.shear = c.shear_force;
      }
      add(force, system.block(c.vertex_block).equation, f.normal * k.normal_vertex + f.shear * k.shear_vertex);
      add(force, system.block(c.edge_block).equation, f.normal * k.normal_edge + f.shear * k.shear_edge);
      contacts.set(i, f, 0.0, 0.0);
    }
    contacts.keep_start_forces();
    for (int b : system.free_blocks()) {
      const auto& block = system.block(b);
      const Unknowns total = force.segment<dofs>(dofs * block.equation) + problem.external.force(system, b, still);
      Unknowns d = problem.dt * problem.velocity(b) + total.cwiseQuotient(problem.inertia * block.mass);
      if (block.rotation_locked) d[Motion::rotation_index] = 0.0;
      solution.d.segment<dofs>(dofs * block.equation) = d;
      contacts.moves()[static_cast<std::size_t>(block.equation)] = BlockMove(d, system.rotation_kind(), block.radius);
    }
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact& c = problem.contacts[i];
      const ContactKinematics k(ContactPose(contacts.start(i).pose(ContactTrial::lane(i), contacts.moves())));
      const CarriedForces end = forces(problem, c, k, [&](int b) { return Unknowns(solution.of(system, b) / problem.dt); });
      contacts.set(i, end, k.gap_change, k.slip_change);
      settle_opening(problem, i, contacts);
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
  template <class Velocity>
  CarriedForces forces(const StepProblem& problem, const Contact& contact, const ContactKinematics& k, const Velocity& v) const {
    const int a = contact.vertex_block, b = contact.edge_block;
    const TabulatedJoint& joint = problem.joints.joint(contact.joint);
    const ContactDashpots dashpots(joint, contact.length, problem.system.reduced_mass(a, b));
    const ContactSprings s = springs(problem, contact);
    ForceTrials trial;
    trial.elastic_normal = -s.normal * ((s.gap - s.target) + k.gap_change);
    trial.viscous_normal = -dashpots.normal * (k.normal_vertex.dot(v(a)) + k.normal_edge.dot(v(b)));
    trial.elastic_shear = s.initial_shear - s.shear * k.slip_change;
    trial.viscous_shear = -dashpots.shear * (k.shear_vertex.dot(v(a)) + k.shear_edge.dot(v(b)));
    return carry(ContactStrength(joint, contact), trial);
  }

  /// See crossing_energy.h.
  static void settle_opening(const StepProblem& problem, std::size_t c, ContactTrial& contacts) {
    const Contact& contact = problem.contacts[c];
    const CarriedForces& start = contacts.start_forces()[c];
    CarriedForces end = contacts.forces(c);
    if (start.status == ContactStatus::open || end.status != ContactStatus::open) return;
    const double share = problem.method.step_fraction * problem.method.step_fraction;
    if (contacts.strength(c).tension > 0.0) return;
    const double gap_change = contacts.gap_change(c), slip_change = contacts.slip_change(c), gap = contact.stretch() + gap_change;
    const double energy = 0.5 * std::min(start.normal, start.elastic_normal) * gap + contact.crossing_energy;
    const Opening opening =
        settled(energy, contacts.normal_stiffness(c), gap_change, contacts.shear_stiffness(c), slip_change, contact.elastic_slip, start.shear, share);
    end.normal = opening.normal;
    end.shear = opening.shear;
    contacts.set(c, end, gap_change, slip_change);
    contacts.set_crossing_energy(c, opening.energy);
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
