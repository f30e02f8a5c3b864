// Places of contacts in their batches: each has its own, near where it is in the list, closed ones first; and nothing but the last bits depends on
// it.
#include <cmath>
#include <random>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/contact_order.h"
#include "openclose/integrator/newton.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr std::size_t group = 64;

std::vector<Contact> random_contacts(std::size_t count) {
  std::mt19937 random(5);
  const auto chance = [&](double probability) { return std::bernoulli_distribution(probability)(random); };
  std::vector<Contact> contacts(count);
  for (Contact& c : contacts) {
    c.status = chance(0.5) ? ContactStatus::open : (chance(0.5) ? ContactStatus::sliding : ContactStatus::sticking);
    c.gap = chance(0.2) ? -1e-6 : 1e-6;
  }
  return contacts;
}

bool is_likely_closed(const Contact& c) {
  return c.status != ContactStatus::open || c.gap <= 0.0;
}

}  // namespace

TEST_CASE("contacts that are closed come first in their group, in the order of the list", "[integrator][order]") {
  const std::size_t count = GENERATE(0, 1, 63, 64, 65, 300);
  const std::vector<Contact> contacts = random_contacts(count);
  ContactOrder order;
  order.keep(5);
  order.pack(contacts);
  REQUIRE(order.size() == count);
  std::vector<int> contact_at(count, -1);
  for (std::size_t c = 0; c < count; ++c) {
    REQUIRE(order[c] < count);
    CHECK(order[c] / group == c / group);
    CHECK(contact_at[order[c]] == -1);
    contact_at[order[c]] = static_cast<int>(c);
  }
  for (std::size_t at = 1; at < count; ++at) {
    if (at % group == 0) continue;
    const bool before = is_likely_closed(contacts[contact_at[at - 1]]), now = is_likely_closed(contacts[contact_at[at]]);
    CHECK((before || !now));
    if (before == now) CHECK(contact_at[at - 1] < contact_at[at]);
  }
}

TEST_CASE("contacts in the order of the list", "[integrator][order]") {
  ContactOrder kept;
  kept.keep(130);
  REQUIRE(kept.size() == 130);
  for (std::size_t c = 0; c < 130; ++c) CHECK(kept[c] == c);
}

TEST_CASE("a step reports of each contact what its law says of it, wherever it is in its batches", "[integrator][order]") {
  const std::string integrator = GENERATE("shi", "theta", "path_average");
  Scene scene = test::column_of_blocks(6);
  scene.method.integrator = integrator;
  if (integrator == "theta") scene.method.theta = 0.6;
  scene.method.residual_tolerance = 1e-9;
  Simulation simulation(scene);
  std::vector<Contact> contacts = simulation.contacts();
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
