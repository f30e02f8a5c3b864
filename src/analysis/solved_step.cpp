#include "openclose/analysis/solved_step.h"

#include <algorithm>
#include <cmath>

#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

using Unknowns = Motion::Unknowns;

/// A contact as it stands at the start of a step.
ContactPose pose_at_start(const BlockSystem& system, const Contact& contact) {
  return {ContactStart(system, contact), {}, {}};
}

/// Adds to the rows of free blocks.
auto adds_to(Eigen::VectorXd& rows, const BlockSystem& system) {
  return [&](int b, const Unknowns& f) {
    const int i = system.block(b).equation;
    if (i >= 0) rows.segment<dofs>(dofs * i) += f;
  };
}

}  // namespace

double largest_move(const BlockSystem& system, const StepSolution& solution) {
  double largest = 0.0;
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    const Unknowns d = solution.of(system, b);
    if (Motion::displacement_bound(d, block.radius) <= largest) continue;
    for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) {
      largest = std::max(largest, Motion::displacement(d, system.arm(v), system.rotation_kind()).norm());
    }
  }
  return largest;
}

double local_error(const StepProblem& problem, const StepSolution& solution) {
  const BlockSystem& system = problem.system;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(dofs * system.free_count());
  const auto push = adds_to(change, system);
  for (int b : system.free_blocks()) {
    if (!problem.external.has_elements(b)) continue;  // the others do not change
    push(b, problem.external.force(system, b, solution.of(system, b)) - problem.external.force(system, b, Unknowns::Zero()));
  }
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const Contact& c = problem.contacts[i];
    const CarriedForces now = solution.contacts.forces(i);
    if (now.status != ContactStatus::open) push_apart(c, solution.contacts.pose(i), now.normal, now.shear, push);
    if (c.status != ContactStatus::open) push_apart(c, solution.contacts.pose_at_start(i), -c.normal_force, -c.shear_force, push);
  }
  double largest = 0.0;
  for (int b : system.free_blocks()) {
    const auto& block = system.block(b);
    Unknowns error = problem.dt * problem.dt / 12.0 * change.segment<dofs>(dofs * block.equation).cwiseQuotient(block.mass);
    if (block.rotation_locked) error[Motion::rotation_index] = 0.0;
    largest = std::max(largest, Motion::displacement_bound(error, block.radius));
  }
  return largest;
}

double unbalanced_force(const StepProblem& problem, const StepSolution& solution) {
  const BlockSystem& system = problem.system;
  double largest = 0.0;  // of what inertia carries
  for (int b : system.free_blocks()) {
    const Unknowns inertia_force = problem.inertia * system.block(b).mass.cwiseProduct(solution.of(system, b));
    largest = std::max(largest, problem.emphasis(b) * Motion::largest_force(inertia_force, system.block(b).radius));
  }
  // Where friction lags behind the normal force, equilibrium with the old friction is none yet.
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const CarriedForces f = solution.contacts.forces(i);
    if (f.status != ContactStatus::sliding) continue;
    const Contact& c = problem.contacts[i];
    const double bound = ContactStrength(problem.joints.joint(c.joint), c).shear_bound(f.normal).value;
    double emphasis = 1.0;
    for (int b : {c.vertex_block, c.edge_block}) {
      if (system.block(b).equation >= 0) emphasis = std::max(emphasis, problem.emphasis(b));
    }
    largest = std::max(largest, emphasis * std::abs(bound - std::abs(f.shear)));
  }
  return largest + solution.unbalanced;
}

double friction_slip(const StepProblem& problem, const StepSolution& solution, std::size_t contact, bool elastic) {
  if (solution.contacts.status(contact) != ContactStatus::sliding) return 0.0;
  const double elastic_shear = solution.contacts.forces(contact).elastic_shear;
  const double stretch = elastic ? -elastic_shear / solution.contacts.shear_stiffness(contact) - problem.contacts[contact].elastic_slip : 0.0;
  return std::abs(solution.contacts.slip_change(contact) - stretch);
}

LossesOfStep losses(const StepProblem& problem, const StepSolution& solution, bool elastic) {
  LossesOfStep largest;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const Contact& c = problem.contacts[i];
    const JointProperties& joint = problem.joints.joint(c.joint);
    if (!can_lose_strength(joint, c.joint_state)) continue;
    const ContactStatus status = solution.contacts.status(i);
    const double lost = loss(joint, c.joint_state, state_after(joint, c.joint_state, status, friction_slip(problem, solution, i, elastic)));
    largest.any = std::max(largest.any, lost);
    if (status != ContactStatus::sliding || !weakens_along_slip(joint, c.joint_state)) continue;
    const double left = 1.0 - loss(joint, {}, c.joint_state);
    // A spring that is relieved slips at once, however short the step: only what the blocks' motion does goes with its length.
    const double by_motion = weakening_by(joint, std::abs(solution.contacts.slip_change(i)));
    largest.along_slip = std::max(largest.along_slip, std::min({lost, left, by_motion}));
  }
  return largest;
}

bool moves_nothing(const StepProblem& problem, const StepSolution& solution) {
  if (problem.statics || problem.scheme->is_within_step() || !solution.d.isZero(0.0)) return false;
  return std::ranges::all_of(problem.system.free_blocks(), [&](int b) { return problem.drift(b).isZero(0.0); });
}

bool has_come_to_rest(const StepProblem& problem, int b, const Motion::Unknowns& velocity) {
  const double radius = problem.system.block(b).radius;
  const double speed = std::max(Motion::translation(velocity).norm(), radius * std::abs(Motion::rotation(velocity)));
  return speed <= tolerance::rest * problem.dt * problem.external.gravity().norm();
}

double kinetic_change(const StepProblem& problem, const StepSolution& solution) {
  const BlockSystem& system = problem.system;
  double change = 0.0;
  for (int b : system.free_blocks()) {
    const Unknowns before = problem.velocity(b), after = problem.scheme->next_velocity(b, problem.dt, solution.of(system, b), before);
    const auto& mass = system.block(b).mass;
    change += 0.5 * (after.dot(mass.cwiseProduct(after)) - before.dot(mass.cwiseProduct(before)));
  }
  return change;
}

namespace {

/// [-] Of the speed of two blocks along each other, and of the impulse of their contact: what is less is how bodies that stay together turn around
/// each other, within a step of a tenth of a radian, and what rounding leaves of those at rest.
constexpr double least_of_collision = 0.1;

/// Whether two blocks came to a contact with an approach that it had to stop: one that its normal force spends a good part of its impulse on.
bool stops_approach(const StepProblem& problem, const Contact& c, double normal) {
  const ContactPose pose = pose_at_start(problem.system, c);
  double gap_rate = 0.0, slip_rate = 0.0, mobility = 0.0;
  push_apart(c, pose, 1.0, 0.0, [&](int b, const Unknowns& force) {
    if (problem.system.block(b).equation < 0) return;
    gap_rate += force.dot(problem.velocity(b));
    mobility += force.dot(force.cwiseQuotient(problem.system.block(b).mass));
  });
  push_apart(c, pose, 0.0, 1.0, [&](int b, const Unknowns& force) { slip_rate += force.dot(problem.velocity(b)); });
  return -gap_rate > least_of_collision * std::abs(slip_rate) && -gap_rate > least_of_collision * normal * problem.dt * mobility;
}

}  // namespace

std::vector<Blow> blows(const StepProblem& problem, const StepSolution& solution) {
  std::vector<Blow> list;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const Contact& c = problem.contacts[i];
    const CarriedForces now = solution.contacts.forces(i);
    if (now.status == ContactStatus::open || !(now.normal > 0.0)) continue;
    const double before = c.status == ContactStatus::open ? 0.0 : std::max(0.0, c.normal_force);
    // A collision of bodies can last for two steps, the second as hard as the first: there only the approach tells it from bodies at rest.
    const bool is_steady = std::abs(now.normal - before) <= least_of_collision * now.normal;
    const double part = !is_steady && stops_approach(problem, c, now.normal) ? 1.0 : 1.0 - before / now.normal;
    if (part <= 0.0) continue;
    for (int b : {c.vertex_block, c.edge_block}) list.push_back({b, part});
  }
  return list;
}

Eigen::VectorXd forces_now(const StepProblem& problem, const Enforcement& enforcement) {
  const BlockSystem& system = problem.system;
  Eigen::VectorXd force(dofs * system.free_count());
  for (int b : system.free_blocks()) force.segment<dofs>(dofs * system.block(b).equation) = problem.external.force(system, b, Unknowns::Zero());
  for (const Contact& c : problem.contacts) {
    const ContactForces f = spring_slider(enforcement.springs(problem, c), ContactStrength(problem.joints.joint(c.joint), c), 0.0, 0.0);
    if (f.status != ContactStatus::open) push_apart(c, pose_at_start(system, c), f.normal, f.shear, adds_to(force, system));
  }
  for (int b : system.free_blocks()) {
    if (system.block(b).rotation_locked) force[dofs * system.block(b).equation + Motion::rotation_index] = 0.0;
  }
  return force;
}

}  // namespace openclose
