#include "openclose/analysis/energy_ledger.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace openclose {
namespace {

double square(double x) {
  return x * x;
}

/// One contact of an elastic enforcement; paths are the products of the force directions at start and end with the work displacement.
struct ContactPaths {
  double normal_end, shear_end;
  double normal_start, shear_start;
};

void add_elastic_contact(EnergyLedger& ledger, const Contact& contact, const ContactOutcome& end, const CarriedForces& start,
                         const ContactPaths& paths, double theta) {
  const double kn = end.normal_stiffness, ks = end.shear_stiffness;
  const double gap_change = end.pose.gap_change, slip = end.pose.slip_change;
  const double n1 = end.forces.normal, t1 = end.forces.shear;
  const double p0 = start.elastic_normal / kn, p1 = end.forces.elastic_normal / kn;
  const double u0 = contact.elastic_slip, u1 = -end.forces.elastic_shear / ks;
  const double opening0 = contact.stretch() + p0;

  double by_springs = (theta - 0.5) * (kn * square(p1 - p0) + ks * square(u1 - u0)) + theta * n1 * opening0;
  double by_rotation = theta * (n1 * (paths.normal_end - gap_change) + t1 * (paths.shear_end - slip));
  double viscous_normal = theta * (n1 - end.forces.elastic_normal), viscous_shear = theta * (t1 - end.forces.elastic_shear);
  double shear = theta * t1;
  double let_go = 0.0;
  if (theta < 1.0) {
    const double weight = 1.0 - theta, n0 = start.normal, t0 = start.shear, opening1 = contact.stretch() + gap_change + p1;
    by_springs -= weight * n0 * opening1;
    by_rotation += weight * (n0 * paths.normal_start - n0 * gap_change + t0 * paths.shear_start - t0 * slip);
    viscous_normal += weight * (n0 - start.elastic_normal);
    viscous_shear += weight * (t0 - start.elastic_shear);
    shear += weight * t0;
    // Where the strength has gone since the last step the spring lets go before it starts.
    let_go = weight * (start.elastic_shear + ks * u0) * (u1 - u0);
  }

  ledger.contact_springs += 0.5 * kn * (p1 * p1 - p0 * p0) + 0.5 * ks * (u1 * u1 - u0 * u0);
  if (!contact.joint_state.bonded && contact.normal_force < 0.0) {
    // It has lost its strength while it pulled.
    const double released = contact.stored_energy - (0.5 * kn * p0 * p0 + 0.5 * ks * u0 * u0);
    ledger.contact_springs -= released;
    ledger.redefinition += released;
  }
  ledger.scheme += by_springs;
  ledger.scheme -= by_rotation;
  ledger.scheme -= let_go;
  ledger.contact_damping += viscous_normal * (p1 - p0) - viscous_shear * (u1 - u0);
  ledger.friction -= shear * (slip - (u1 - u0));
}

/// [N] All that a step with the forces at its end needs of those at its start. Of the springs of `soft` and `shi`.
double elastic_normal_at_start(const Contact& contact, const TabulatedJoint& joint, const ContactOutcome& end) {
  const double elastic = -end.normal_stiffness * contact.stretch();
  return is_open(ContactStrength(joint, contact), elastic) ? 0.0 : elastic;
}

/// Open before and after, nothing stored: every entry would be zero.
bool rests_open(const Contact& contact, ContactStatus end) {
  return end == ContactStatus::open && contact.status == ContactStatus::open && !contact.joint_state.bonded && contact.stretch() > 0.0 &&
         contact.elastic_slip == 0.0 && contact.stored_energy == 0.0 && contact.normal_force == 0.0 && contact.shear_force == 0.0;
}

/// Forces averaged over the path; what rotations leave between the ways of these forces and the changes of gap and slip.
void add_averaged_contact(EnergyLedger& ledger, const Contact& contact, const PathOutcome& path, double normal_rest, double shear_rest,
                          const ContactOutcome& end) {
  const PathEnergies& e = path.energies;
  const double stored = stored_energy(end.normal_stiffness, end.shear_stiffness, end.forces.elastic_normal, end.forces.elastic_shear);
  ledger.contact_springs += stored - contact.stored_energy;
  // What a spring had before strength was taken from it, or the contact changed, and has not now.
  ledger.redefinition += contact.stored_energy - (stored - e.springs) + e.rupture;
  ledger.friction += e.friction;
  ledger.contact_damping += e.damping;
  ledger.scheme += e.scheme - path.normal * normal_rest - path.shear * shear_rest;
}

using Unknowns = Motion::Unknowns;

/// Per block: what the forces of the step worked on.
using WorkDisplacements = std::vector<Unknowns>;

WorkDisplacements work_displacements(const StepProblem& problem, const StepSolution& solution, const TimeScheme& scheme) {
  const BlockSystem& system = problem.system;
  WorkDisplacements list(system.block_count());
  for (int b = 0; b < system.block_count(); ++b) {
    const Unknowns d = solution.of(system, b);
    list[b] = problem.statics ? d : scheme.work_displacement(b, problem.dt, d, system.velocity(b));
  }
  return list;
}

/// Kinetic energy, gravity and base motion. A static step starts from rest, whatever the scheme, and drops its kinetic energy at the end.
void add_blocks(EnergyLedger& ledger, const StepProblem& problem, const StepSolution& solution, const TimeScheme& scheme,
                const WorkDisplacements& work_displacement) {
  const BlockSystem& system = problem.system;
  const double dt = problem.dt;
  for (int b : system.free_blocks()) {
    const auto& mass = system.block(b).mass;
    const Unknowns d = solution.of(system, b), path = work_displacement[b], v0 = problem.velocity(b);
    const Unknowns v1 = problem.statics ? Unknowns(2.0 / dt * d) : scheme.next_velocity(b, dt, d, v0);
    const double before = 0.5 * v0.dot(mass.cwiseProduct(v0)), after = 0.5 * v1.dot(mass.cwiseProduct(v1));
    if (problem.statics) {
      const Unknowns dropped = system.velocity(b);
      ledger.scheme += after + 0.5 * dropped.dot(mass.cwiseProduct(dropped));
    }
    if (!problem.statics) ledger.scheme -= scheme.own_work(b, dt, d, v0, mass);
    const double weight_work = problem.external.weight(system, b).dot(path);
    const double base_work = problem.external.base_force(system, b).dot(path);
    ledger.gravity -= weight_work;
    ledger.base_motion -= base_work;
    ledger.turnover += std::abs(after - before) + std::abs(weight_work) + std::abs(base_work);
  }
}

/// Loads and supports.
void add_elements(EnergyLedger& ledger, const StepProblem& problem, const StepSolution& solution, const WorkDisplacements& work_displacement) {
  const BlockSystem& system = problem.system;
  const double theta = problem.end_weight;
  for (const auto& element : problem.external.elements()) {
    const int b = element->block();
    if (system.block(b).equation < 0) continue;
    const Unknowns d = solution.of(system, b), path = work_displacement[b];
    const ElementPath start = element->path(system, Unknowns::Zero()), way = element->path(system, d);
    Unknowns force;  // as it acted in this step
    if (solution.first_order) {
      force = element->force(start) - element->stiffness(start) * d;
    } else if (problem.averages_path()) {
      force = element->mean_force(way);
    } else {
      force = theta * element->force(way) + (1.0 - theta) * element->force(start);
    }
    const double work = force.dot(path), change = element->energy_change(way);
    (element->account() == ForceAccount::loads ? ledger.loads : ledger.support_springs) += change;
    ledger.scheme -= work + change;
    if (element->account() == ForceAccount::loads) ledger.turnover += std::abs(change);
  }
}

void add_contacts(EnergyLedger& ledger, const StepProblem& problem, const StepSolution& solution, bool elastic,
                  const WorkDisplacements& work_displacement) {
  const double theta = problem.end_weight;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const Contact& contact = problem.contacts[c];
    if (solution.contacts.paths().empty() && rests_open(contact, solution.contacts.status(c))) continue;
    const ContactOutcome end = solution.contacts[c];
    const Unknowns &pv = work_displacement[contact.vertex_block], &pe = work_displacement[contact.edge_block];
    if (!solution.contacts.paths().empty()) {
      const PathOutcome& mean = solution.contacts.paths()[c];
      add_averaged_contact(ledger, contact, mean, mean.pose.normal_way(pv, pe) - end.pose.gap_change,
                           mean.pose.shear_way(pv, pe) - end.pose.slip_change, end);
      continue;
    }
    ContactPaths paths{end.pose.normal_way(pv, pe), end.pose.shear_way(pv, pe), 0.0, 0.0};
    if (!elastic) {
      ledger.impact -= end.forces.normal * paths.normal_end;
      ledger.friction -= end.forces.shear * paths.shear_end;
      continue;
    }
    CarriedForces start;
    if (theta == 1.0) {
      start.elastic_normal = elastic_normal_at_start(contact, problem.joints.joint(contact.joint), end);
    } else {
      const ContactPose pose = solution.contacts.pose_at_start(c);
      start = solution.contacts.start_forces()[c];
      paths.normal_start = pose.normal_way(pv, pe);
      paths.shear_start = pose.shear_way(pv, pe);
    }
    add_elastic_contact(ledger, contact, end, start, paths, theta);
  }
}

}  // namespace

double stored_energy(double normal_stiffness, double shear_stiffness, double normal, double shear) {
  return 0.5 * (normal * normal / normal_stiffness + shear * shear / shear_stiffness);
}

void add_step(EnergyLedger& ledger, const StepProblem& problem, const StepSolution& solution, const TimeScheme& scheme, bool elastic) {
  const WorkDisplacements work_displacement = work_displacements(problem, solution, scheme);
  add_blocks(ledger, problem, solution, scheme, work_displacement);
  add_elements(ledger, problem, solution, work_displacement);
  add_contacts(ledger, problem, solution, elastic, work_displacement);
}

}  // namespace openclose
