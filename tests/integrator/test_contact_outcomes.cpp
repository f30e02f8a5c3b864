#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/contact_outcomes.h"
#include "openclose/integrator/newton.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// Numbers that tell contact and member.
ContactOutcome outcome(int c) {
  const double at = 100.0 * c;
  ContactOutcome o;
  o.normal_stiffness = at + 1.0;
  o.shear_stiffness = at + 2.0;
  const ContactStatus status = c % 3 == 0 ? ContactStatus::open : (c % 3 == 1 ? ContactStatus::sticking : ContactStatus::sliding);
  o.forces = {status, at + 3.0, c % 2 == 0 ? at + 4.0 : -at - 4.0, at + 5.0, at + 6.0};
  o.pose.normal = {at + 7.0, at + 8.0};
  o.pose.vertex_arm = {at + 9.0, at + 10.0};
  o.pose.edge_arm = {at + 11.0, at + 12.0};
  o.pose.gap_change = at + 13.0;
  o.pose.slip_change = at + 14.0;
  return o;
}

void check_same(const ContactOutcome& a, const ContactOutcome& b) {
  CHECK(a.normal_stiffness == b.normal_stiffness);
  CHECK(a.shear_stiffness == b.shear_stiffness);
  CHECK(a.forces.status == b.forces.status);
  CHECK(a.forces.normal == b.forces.normal);
  CHECK(a.forces.shear == b.forces.shear);
  CHECK(a.forces.elastic_normal == b.forces.elastic_normal);
  CHECK(a.forces.elastic_shear == b.forces.elastic_shear);
  CHECK(a.pose.normal == b.pose.normal);
  CHECK(a.pose.vertex_arm == b.pose.vertex_arm);
  CHECK(a.pose.edge_arm == b.pose.edge_arm);
  CHECK(a.pose.gap_change == b.pose.gap_change);
  CHECK(a.pose.slip_change == b.pose.slip_change);
}

constexpr int count = 2 * batch_size + 1;  // batches that are full and one that is not

ContactOutcomes some_outcomes() {
  ContactOutcomes outcomes;
  for (int c = 0; c < count; ++c) outcomes.push_back(outcome(c));
  return outcomes;
}

}  // namespace

TEST_CASE("what contacts did comes back as it was put in, whole and in parts", "[integrator][outcomes]") {
  ContactOutcomes outcomes = some_outcomes();
  for (int round = 0; round < 2; ++round) {
    REQUIRE(outcomes.size() == count);
    for (int c = 0; c < count; ++c) {
      const ContactOutcome expected = outcome(c);
      check_same(outcomes[c], expected);
      CHECK(outcomes.status(c) == expected.forces.status);
      CHECK(outcomes.gap_change(c) == expected.pose.gap_change);
      CHECK(outcomes.slip_change(c) == expected.pose.slip_change);
      CHECK(outcomes.normal_stiffness(c) == expected.normal_stiffness);
      CHECK(outcomes.shear_stiffness(c) == expected.shear_stiffness);
      CHECK(outcomes.slack(c) == 0.0);
    }
    // Again in the same memory.
    outcomes.clear();
    CHECK(outcomes.empty());
    for (int c = 0; c < count; ++c) outcomes.push_back(outcome(c));
  }
}

TEST_CASE("slack belongs to its contact and to its step", "[integrator][outcomes]") {
  ContactOutcomes outcomes = some_outcomes();
  outcomes.set_slack(0, 0.25);
  CHECK(outcomes.slack(0) == 0.25);
  CHECK(outcomes.slack(1) == 0.0);
  outcomes.clear();
  outcomes.push_back(outcome(0));
  CHECK(outcomes.slack(0) == 0.0);
}

TEST_CASE("batches are lent with where their contacts start, and given back", "[integrator][outcomes]") {
  auto starts = std::make_shared<ContactStarts>();
  starts->count = 2;
  starts->batches.resize(1);
  std::vector<BlockMove> moves{BlockMove({0.1, 0.2, 0.3}, RotationKind::exact, 1.0), BlockMove({-0.3, 0.1, -0.2}, RotationKind::exact, 1.0)};
  std::vector<TrialBatch> trials(1);
  std::vector<ElasticBatch> elastic(1);
  std::vector<Branch> branches(batch_size, 0);
  std::vector<ContactOutcome> expected;
  for (int c = 0; c < 2; ++c) {
    ContactPlace at;
    at.vertex_arm = {1.0 + c, 2.0};
    at.end_arm = {3.0, -1.0 - c};
    at.lever = {0.5, 0.25};
    at.edge = {0.0, 2.0};
    ContactOutcome o = outcome(c);
    o.pose = ContactPose(ContactStart(at), moves[c], moves[1 - c]);
    expected.push_back(o);
    starts->batches[0].set_places(c, c, 1 - c);
    starts->batches[0].set_geometry(c, at);
    starts->batches[0].normal[c] = o.normal_stiffness;
    starts->batches[0].shear[c] = o.shear_stiffness;
    trials[0].gap_change[c] = o.pose.gap_change;
    trials[0].slip_change[c] = o.pose.slip_change;
    trials[0].normal[c] = o.forces.normal;
    trials[0].shear[c] = o.forces.shear;
    elastic[0].normal[c] = o.forces.elastic_normal;
    elastic[0].shear[c] = o.forces.elastic_shear;
    branches[c] = branch(o.forces);
  }
  openclose::begin(starts->batches);
  const TrialBatch* const where = trials.data();
  ContactOutcomes copy, outcomes;
  copy.copy(starts, moves, trials, branches, elastic);
  outcomes.borrow(starts, moves, trials, branches, elastic);
  CHECK(trials.empty());
  CHECK(moves.empty());
  for (int c = 0; c < 2; ++c) {
    check_same(outcomes[c], expected[c]);
    check_same(copy[c], expected[c]);
    CHECK(outcomes.gap_change(c) == expected[c].pose.gap_change);
    CHECK(outcomes.slip_change(c) == expected[c].pose.slip_change);
    CHECK(outcomes.status(c) == expected[c].forces.status);
  }
  outcomes.give_back(moves, trials, branches);
  CHECK(outcomes.empty());
  CHECK(trials.data() == where);
  CHECK(moves.size() == 2);
  CHECK(copy.size() == 2);
}

TEST_CASE("a step reports of each contact what its law says of it", "[integrator][outcomes]") {
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
    if (!solution.start_contacts.empty()) CHECK(solution.start_contacts.forces(c).normal == std::max(0.0, -springs[c].normal * contact.gap));
    if (!solution.paths.empty()) CHECK(solution.paths[c].pose.vertex_arm == mean_pose(ContactStart(problem.system, contact), pose).vertex_arm);
  }
  CHECK(open == static_cast<int>(contacts.size()) / 3);
  CHECK(solution.start_contacts.empty() == (problem.end_weight == 1.0));
  CHECK(solution.paths.empty() == (integrator != "path_average"));
}
