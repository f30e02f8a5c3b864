// The steps of the explicit method written plainly, one by one, every contact found anew: the forces where a step starts move the blocks, then the
// contacts follow. The loop of CentralDifference is compared with them. They cut, refuse and put to rest nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "openclose/analysis/simulation_state.h"
#include "openclose/contact/kinematics.h"
#include "openclose/integrator/crossing_energy.h"

namespace openclose::test {

class PlainExplicit {
 public:
  using Unknowns = Motion::Unknowns;

  explicit PlainExplicit(const Scene& scene) : state_(scene, nullptr) {}

  const BlockSystem& system() const { return state_.system; }
  const JointTable& joints() const { return state_.joints; }
  const EnergyLedger& ledger() const { return state_.ledger; }
  double max_penetration() const { return state_.max_penetration; }
  /// At the end of the last step, half a step after the system's.
  Unknowns velocity(int b) const { return state_.output_velocity[b]; }
  /// Of the present positions.
  const std::vector<Contact>& contacts() {
    state_.find_contacts();
    return state_.contacts.moving;
  }

  void start_base_motion() { state_.base_moves = true; }

  void step(double dt) {
    state_.move_base(dt, false);
    state_.find_contacts();
    BlockSystem& system = state_.system;
    const StepProblem problem = state_.problem(dt, false);
    std::vector<Link> links;
    for (const Contact& c : problem.contacts) links.push_back(at_start(problem, c));
    const std::vector<Unknowns> force = sum_of_forces(links, [](const Link& l) -> const CarriedForces& { return l.start; });
    std::vector<Unknowns> d(system.blocks().size(), Unknowns::Zero());
    for (int b : system.free_blocks()) {
      d[b] = dt * system.velocity(b) + force[b].cwiseQuotient(problem.inertia * system.block(b).mass);
      if (system.block(b).rotation_locked) d[b][Motion::rotation_index] = 0.0;
    }
    for (std::size_t i = 0; i < links.size(); ++i) follow(problem, problem.contacts[i], d, links[i]);
    book(problem, links, d);
    for (std::size_t i = 0; i < links.size(); ++i) accept(links[i], state_.contacts.moving[i]);
    for (int b : system.free_blocks()) {
      system.set_velocity(b, d[b] / dt);
      system.advance(b, d[b]);
    }
    state_.scheme->accept(dt);
    state_.time += dt;
    end_step(dt, sum_of_forces(links, [](const Link& l) -> const CarriedForces& { return l.end; }));
    state_.contacts_current = false;
  }

 private:
  /// A contact in a step.
  struct Link {
    int vertex_block, edge_block;
    ContactSprings springs;
    ContactStrength strength;
    ContactKinematics at;  ///< where `start` or, after the step, `end` act
    CarriedForces start, end;
    Unknowns vertex_at_start, edge_at_start;  ///< [N, N m] what `start` does to its two blocks
    double crossing_energy;                   ///< [J] of one that opens
  };

  /// Springs and dashpots, with these velocities of the two blocks.
  static CarriedForces carried(const StepProblem& problem, const Contact& c, const Link& link, const Unknowns& v, const Unknowns& e) {
    const ContactDashpots dashpots(problem.joints.joint(c.joint), c.length, problem.system.reduced_mass(c.vertex_block, c.edge_block));
    const ContactKinematics& k = link.at;
    const ContactSprings& s = link.springs;
    return carry(link.strength, {-s.normal * ((s.gap - s.target) + k.gap_change), -dashpots.normal * (k.normal_vertex.dot(v) + k.normal_edge.dot(e)),
                                 s.initial_shear - s.shear * k.slip_change, -dashpots.shear * (k.shear_vertex.dot(v) + k.shear_edge.dot(e))});
  }

  static Link at_start(const StepProblem& problem, const Contact& c) {
    const Unknowns still = Unknowns::Zero();
    Link link{c.vertex_block,
              c.edge_block,
              joint_springs(problem, c),
              ContactStrength(problem.joints.joint(c.joint), c),
              ContactKinematics(problem.system, c, still, still),
              {},
              {},
              still,
              still,
              0.0};
    CarriedForces& f = link.start = carried(problem, c, link, problem.velocity(c.vertex_block), problem.velocity(c.edge_block));
    if (f.status == ContactStatus::open && c.status == ContactStatus::open) {  // what settles its opening
      f.normal = c.normal_force;
      f.shear = c.shear_force;
    }
    link.vertex_at_start = f.normal * link.at.normal_vertex + f.shear * link.at.shear_vertex;
    link.edge_at_start = f.normal * link.at.normal_edge + f.shear * link.at.shear_edge;
    return link;
  }

  /// Of all blocks as the system has them, contacts where they were last looked at.
  template <class Forces>
  std::vector<Unknowns> sum_of_forces(const std::vector<Link>& links, const Forces& of) const {
    const BlockSystem& system = state_.system;
    std::vector<Unknowns> sum(system.blocks().size(), Unknowns::Zero());
    for (const Link& link : links) {
      const CarriedForces& f = of(link);
      sum[link.vertex_block] += f.normal * link.at.normal_vertex + f.shear * link.at.shear_vertex;
      sum[link.edge_block] += f.normal * link.at.normal_edge + f.shear * link.at.shear_edge;
    }
    for (int b : system.free_blocks()) sum[b] += state_.external.force(system, b, Unknowns::Zero());
    return sum;
  }

  static void follow(const StepProblem& problem, const Contact& c, const std::vector<Unknowns>& d, Link& link) {
    link.at = ContactKinematics(problem.system, c, d[c.vertex_block], d[c.edge_block]);
    link.end = carried(problem, c, link, d[c.vertex_block] / problem.dt, d[c.edge_block] / problem.dt);
    // See crossing_energy.h.
    const CarriedForces& start = link.start;
    if (start.status == ContactStatus::open || link.end.status != ContactStatus::open || link.strength.tension > 0.0) return;
    const double share = problem.method.step_fraction * problem.method.step_fraction;
    const double energy = 0.5 * std::min(start.normal, start.elastic_normal) * (c.stretch() + link.at.gap_change) + c.crossing_energy;
    const Opening opening =
        settled(energy, link.springs.normal, link.at.gap_change, link.springs.shear, link.at.slip_change, c.elastic_slip, start.shear, share);
    link.end.normal = opening.normal;
    link.end.shear = opening.shear;
    link.crossing_energy = opening.energy;
  }

  /// The ledger of the step, by the formulas of energy_ledger.h with theta = 0; blocks and what else acts on them by the program's own.
  void book(const StepProblem& problem, const std::vector<Link>& links, const std::vector<Unknowns>& d) {
    const BlockSystem& system = problem.system;
    const std::vector<Contact> none;
    StepProblem without_contacts{system, problem.external, problem.joints, none, problem.method};
    without_contacts.dt = problem.dt;
    without_contacts.end_weight = 0.0;
    without_contacts.scheme = problem.scheme;
    StepSolution solution;
    solution.d.resize(dofs * system.free_count());
    for (int b : system.free_blocks()) solution.d.segment<dofs>(dofs * system.block(b).equation) = d[b];
    add_step(state_.ledger, without_contacts, solution, *state_.scheme, true);
    const auto path = [&](int b) { return problem.scheme->work_displacement(b, problem.dt, d[b], system.velocity(b)); };
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Link& link = links[i];
      book(problem.contacts[i], link, link.vertex_at_start.dot(path(link.vertex_block)) + link.edge_at_start.dot(path(link.edge_block)));
    }
  }

  /// \param work  [J] of its forces at the start
  void book(const Contact& c, const Link& link, double work) {
    const double kn = link.springs.normal, ks = link.springs.shear, gap_change = link.at.gap_change, slip = link.at.slip_change;
    const bool was_open = link.start.status == ContactStatus::open, is_open = link.end.status == ContactStatus::open;
    // What settles an opening is no force of the joint.
    const double normal = was_open ? 0.0 : link.start.normal, shear = was_open ? 0.0 : link.start.shear;
    const double p0 = link.start.elastic_normal / kn, p1 = link.end.elastic_normal / kn, closing = p1 - p0;
    const double u0 = c.elastic_slip, u1 = -link.end.elastic_shear / ks, stretched = u1 - u0, plastic = slip - stretched;
    // What rubs is the mean force.
    const double rubbed = std::max(0.0, -0.5 * (shear + (is_open ? 0.0 : link.end.shear)) * plastic);
    EnergyLedger& ledger = state_.ledger;
    ledger.contact_springs += 0.5 * kn * (p1 * p1 - p0 * p0) + 0.5 * ks * (u1 * u1 - u0 * u0);
    ledger.scheme -= 0.5 * (kn * closing * closing + ks * stretched * stretched) + normal * (c.stretch() + gap_change + p1);
    ledger.scheme -= work - normal * gap_change - shear * slip;
    ledger.scheme -= (link.start.elastic_shear + ks * u0) * stretched;  // where the strength has gone the spring lets go before it starts
    ledger.scheme -= rubbed + shear * plastic;
    ledger.contact_damping += (normal - link.start.elastic_normal) * closing - (shear - link.start.elastic_shear) * stretched;
    ledger.friction += rubbed;
  }

  void accept(const Link& link, Contact& c) {
    const double kn = link.springs.normal, ks = link.springs.shear, before = c.crossing_energy, stretch = c.stretch();
    const bool was_open = c.status == ContactStatus::open, is_open = link.end.status == ContactStatus::open;
    c.status = link.end.status;
    const double elastic_slip = is_open ? 0.0 : -link.end.elastic_shear / ks;
    c.joint_state = state_after(state_.joints.joint(c.joint), c.joint_state, c.status, std::abs(link.at.slip_change + c.elastic_slip - elastic_slip));
    c.gap += link.at.gap_change;
    c.normal_force = link.end.normal;
    c.shear_force = link.end.shear;
    c.elastic_slip = elastic_slip;
    c.crossing_energy = is_open ? link.crossing_energy : 0.0;
    if (!is_open && ContactStrength(state_.joints.joint(c.joint), c).tension == 0.0)
      c.crossing_energy = was_open ? closing_energy(kn, stretch, c.stretch()) : before;
    c.stored_energy = (is_open ? 0.0 : stored_energy(kn, ks, link.end.elastic_normal, link.end.elastic_shear)) - c.crossing_energy;
    state_.ledger.contact_springs -= c.crossing_energy - before;
    state_.ledger.scheme += c.crossing_energy - before;
    if (!is_open) state_.max_penetration = std::max(state_.max_penetration, -c.gap);
  }

  /// See CentralDifference::kinetic_ahead() and velocity_at_end().
  void end_step(double dt, const std::vector<Unknowns>& force) {
    const BlockSystem& system = state_.system;
    double power = 0.0;
    for (int b : system.free_blocks()) {
      const Unknowns others = force[b] - state_.external.weight(system, b) - state_.external.base_force(system, b);
      power += system.velocity(b).dot(others);
      state_.output_velocity[b] = system.velocity(b) + 0.5 * dt * force[b].cwiseQuotient(system.block(b).mass);
      if (system.block(b).rotation_locked) state_.output_velocity[b][Motion::rotation_index] = system.velocity(b)[Motion::rotation_index];
    }
    state_.book_kinetic_energy(0.5 * dt * power);
  }

  SimulationState state_;
};

}  // namespace openclose::test
