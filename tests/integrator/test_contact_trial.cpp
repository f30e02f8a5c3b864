#include <cmath>
#include <string>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/contact_trial.h"
#include "openclose/integrator/newton.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// Blocks on each other, with the contacts between them laid out for a step.
struct Column {
  Simulation simulation{test::column_of_blocks(5)};
  StepProblem problem = simulation.problem(1e-4, false);
  ContactTrial trial;

  Column() { prepare(); }
  void prepare() { trial.prepare(problem, simulation.enforcement().springs_of(problem)); }
};

/// Numbers that tell contact and member.
CarriedForces forces(std::size_t c) {
  const double at = 100.0 * static_cast<double>(c);
  const ContactStatus status = c % 3 == 0 ? ContactStatus::open : (c % 3 == 1 ? ContactStatus::sticking : ContactStatus::sliding);
  return {status, at + 1.0, c % 2 == 0 ? at + 2.0 : -at - 2.0, at + 3.0, at + 4.0};
}

void check_same(const CarriedForces& a, const CarriedForces& b) {
  CHECK(a.status == b.status);
  CHECK(a.normal == b.normal);
  CHECK(a.shear == b.shear);
  CHECK(a.elastic_normal == b.elastic_normal);
  CHECK(a.elastic_shear == b.elastic_shear);
}

std::vector<ContactSprings> springs_of(const StepProblem& problem) {
  std::vector<ContactSprings> springs;
  for (const Contact& contact : problem.contacts) {
    springs.push_back(joint_springs(problem, contact));
    add_dashpots(problem, contact, springs.back());
    springs.back().dissipation = 0.125;
  }
  return springs;
}

}  // namespace

TEST_CASE("batches have the places, the springs and the strength of their contacts", "[integrator][trial]") {
  Scene scene = test::column_of_blocks(6);
  scene.joints[0].damping_ratio = 0.1;
  scene.joints[0].cohesion = 1e5;
  scene.joints[0].tensile_strength = 1e4;
  Simulation simulation(scene);
  std::vector<Contact> contacts = simulation.change_contacts();
  contacts[1].joint_state.bonded = false;
  contacts[2].gap = -1e-4;
  contacts[2].elastic_slip = 2e-5;
  simulation.change_joints().reduce_strength(2.0);
  const StepProblem present = simulation.problem(1e-3, false);
  StepProblem problem{present.system, present.external, present.joints, contacts, present.method};
  problem.dt = 1e-3;
  const std::vector<ContactSprings> springs = springs_of(problem);
  ContactTrial trial;
  trial.prepare(problem, springs_in(springs));
  const std::vector<ContactBatch>& batches = trial.batches();

  REQUIRE(batches.size() == (contacts.size() + batch_size - 1) / batch_size);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    INFO("contact " << c);
    const ContactBatch& batch = batches[c / batch_size];
    const int k = static_cast<int>(c % batch_size);
    const auto place = [&](int block) {
      const int equation = problem.system.block(block).equation;
      return equation >= 0 ? equation : problem.system.free_count();
    };
    CHECK(batch.vertex_place(k) == place(contacts[c].vertex_block));
    CHECK(batch.edge_place(k) == place(contacts[c].edge_block));
    const ContactSprings kept = batch.springs(k);
    CHECK(kept.normal == springs[c].normal);
    CHECK(kept.shear == springs[c].shear);
    CHECK(kept.gap == springs[c].gap - springs[c].target);
    CHECK(kept.shift == springs[c].shift);
    CHECK(kept.initial_shear == springs[c].initial_shear);
    CHECK(kept.normal_damping == springs[c].normal_damping);
    CHECK(kept.shear_damping == springs[c].shear_damping);
    CHECK(kept.dissipation == 0.125);
    const ContactStrength strength = batch.strength(k), expected(problem.joints.joint(contacts[c].joint), contacts[c]);
    CHECK(strength.friction == expected.friction);
    CHECK(strength.cohesion == expected.cohesion);
    CHECK(strength.tension == (c == 1 ? 0.0 : 0.5e4 * contacts[c].length));
  }

  // Places without a contact belong to nobody, whatever was there before.
  contacts.resize(1);
  trial.prepare(problem, springs_in(springs));
  REQUIRE(batches.size() == 1);
  for (int k = 1; k < batch_size; ++k) {
    CHECK(batches[0].vertex_place(k) == problem.system.free_count());
    CHECK(batches[0].springs(k).normal == 0.0);
    CHECK(batches[0].strength(k).tension == 0.0);
  }
}

TEST_CASE("what contacts did comes back as it was set, whole and in parts", "[integrator][trial]") {
  Column column;
  ContactTrial& trial = column.trial;
  for (int round = 0; round < 2; ++round) {
    REQUIRE(trial.size() == column.problem.contacts.size());
    REQUIRE(trial.size() % batch_size != 0);  // full batches and one that is not
    for (std::size_t c = 0; c < trial.size(); ++c) trial.set(c, forces(c), 5.0 + static_cast<double>(c), 6.0 - static_cast<double>(c));
    for (std::size_t c = 0; c < trial.size(); ++c) {
      check_same(trial.forces(c), forces(c));
      check_same(trial[c].forces, forces(c));
      CHECK(trial.status(c) == forces(c).status);
      CHECK(trial.gap_change(c) == 5.0 + static_cast<double>(c));
      CHECK(trial.slip_change(c) == 6.0 - static_cast<double>(c));
      CHECK(trial[c].pose.gap_change == trial.gap_change(c));
      CHECK(trial[c].pose.slip_change == trial.slip_change(c));
      const ContactSprings springs = joint_springs(column.problem, column.problem.contacts[c]);
      CHECK(trial[c].normal_stiffness == springs.normal);
      CHECK(trial[c].shear_stiffness == springs.shear);
    }
    // Again in the same memory.
    trial.clear();
    CHECK(trial.size() == 0);
    column.prepare();
  }
}

TEST_CASE("contacts are where the moves of their blocks bring them", "[integrator][trial]") {
  Column column;
  ContactTrial& trial = column.trial;
  const BlockSystem& system = column.problem.system;
  std::vector<Motion::Unknowns> d(static_cast<std::size_t>(system.block_count()), Motion::Unknowns::Zero());
  for (const int b : system.free_blocks()) {
    d[static_cast<std::size_t>(b)] = {0.1 * b, -0.2 * b, 0.01 * b};
    trial.moves()[static_cast<std::size_t>(system.block(b).equation)] =
        BlockMove(d[static_cast<std::size_t>(b)], RotationKind::exact, system.block(b).radius);
  }
  for (std::size_t c = 0; c < trial.size(); ++c) {
    const Contact& contact = column.problem.contacts[c];
    const auto of = [&](int b) { return d[static_cast<std::size_t>(b)]; };
    const ContactKinematics now(system, contact, of(contact.vertex_block), of(contact.edge_block));
    const ContactKinematics before(system, contact, Motion::Unknowns::Zero(), Motion::Unknowns::Zero());
    CHECK(trial.pose(c).normal == now.normal);
    CHECK(trial.pose(c).vertex_arm == now.vertex_arm);
    CHECK(trial.pose(c).edge_arm == now.edge_arm);
    CHECK(trial.pose_at_start(c).normal == before.normal);
    CHECK(trial.pose_at_start(c).edge_arm == before.edge_arm);
  }
}

TEST_CASE("slack belongs to its contact and to its step", "[integrator][trial]") {
  Column column;
  ContactTrial& trial = column.trial;
  trial.set_slack(0, 0.25);
  CHECK(trial.slack(0) == 0.25);
  CHECK(trial.slack(1) == 0.0);
  column.prepare();
  CHECK(trial.slack(0) == 0.0);
}

TEST_CASE("a copy of a trial keeps what it had", "[integrator][trial]") {
  Column column;
  ContactTrial& trial = column.trial;
  for (std::size_t c = 0; c < trial.size(); ++c) trial.set(c, forces(c), 1.0, 2.0);
  trial.keep_start_forces();
  const ContactTrial copy = trial;
  std::vector<ContactSprings> stiffer;
  for (std::size_t c = 0; c < trial.size(); ++c) {
    stiffer.push_back(trial.springs(c));
    stiffer.back().normal *= 2.0;
  }
  trial.set_springs(stiffer);
  CHECK(trial.start_forces().empty());
  for (std::size_t c = 0; c < copy.size(); ++c) {
    CHECK(2.0 * copy.normal_stiffness(c) == trial.normal_stiffness(c));
    check_same(copy.forces(c), forces(c));
    check_same(copy.start_forces()[c], forces(c));
  }
}

TEST_CASE("a step reports of each contact what its law says of it", "[integrator][trial]") {
  const std::string integrator = GENERATE("shi", "theta", "path_average");
  Scene scene = test::column_of_blocks(6);
  scene.method.integrator = integrator;
  if (integrator == "theta") scene.method.theta = 0.6;
  scene.method.residual_tolerance = 1e-9;
  Simulation simulation(scene);
  std::vector<Contact> contacts = simulation.change_contacts();
  const StepProblem present = simulation.problem(1e-4, false);
  // Every third contact is far away and open, the others carry something.
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const bool open = c % 3 == 1;
    contacts[c].status = open ? ContactStatus::open : ContactStatus::sticking;
    contacts[c].gap = open ? 1e-3 : -1e-6 * static_cast<double>(c + 1);
    contacts[c].length *= 1.0 + 0.01 * static_cast<double>(c);
  }
  StepProblem problem{present.system, present.external, present.joints, contacts, present.method, present.dt, false, present.inertia};
  problem.end_weight = present.end_weight;
  problem.scheme = present.scheme;
  std::vector<ContactSprings> springs;
  for (const Contact& c : contacts) springs.push_back(joint_springs(problem, c));
  Newton newton;
  StepSolution solution;
  solution.d = drift(problem);
  newton.solve(problem, springs, solution);
  REQUIRE(solution.converged);
  REQUIRE(solution.contacts.size() == contacts.size());
  int open = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Contact& contact = contacts[c];
    const auto move = [&](int b) { return BlockMove(solution.of(problem.system, b), RotationKind::exact, problem.system.block(b).radius); };
    const ContactPose pose(ContactStart(problem.system, contact), move(contact.vertex_block), move(contact.edge_block));
    const ContactStrength strength(problem.joints.joint(contact.joint), contact);
    const ContactForces law = spring_slider(springs[c], strength, pose.gap_change, pose.slip_change);
    const ContactOutcome o = solution.contacts[c];
    CHECK(o.normal_stiffness == springs[c].normal);
    CHECK(o.pose.gap_change == pose.gap_change);
    CHECK(o.pose.vertex_arm == pose.vertex_arm);
    CHECK(o.forces.status == law.status);
    CHECK(std::abs(o.forces.normal - law.normal) <= 1e-12 * law.normal);  // means over a path round otherwise
    CHECK(solution.contacts.status(c) == law.status);
    open += law.status == ContactStatus::open;
    if (!solution.contacts.start_forces().empty())
      CHECK(solution.contacts.start_forces()[c].normal == std::max(0.0, -springs[c].normal * contact.gap));
    if (!solution.contacts.paths().empty())
      CHECK(solution.contacts.paths()[c].pose.vertex_arm == mean_pose(ContactStart(problem.system, contact), pose).vertex_arm);
  }
  CHECK(open == static_cast<int>(contacts.size()) / 3);
  CHECK(solution.contacts.start_forces().empty() == (problem.end_weight == 1.0));
  CHECK(solution.contacts.paths().empty() == (integrator != "path_average"));
}
