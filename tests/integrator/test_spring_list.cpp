// Springs kept from step to step against springs made anew in every step: the same to the last bit.
#include <algorithm>
#include <random>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/spring_list.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

ContactSprings plain_springs(const StepProblem<3>& problem, const Contact& contact) {
  ContactSprings s = joint_springs(problem, contact);
  add_dashpots(problem, contact, s);
  return s;
}

bool are_same(const ContactSprings& a, const ContactSprings& b) {
  return a.normal == b.normal && a.shear == b.shear && a.gap == b.gap && a.target == b.target && a.shift == b.shift &&
         a.initial_shear == b.initial_shear && a.normal_damping == b.normal_damping && a.shear_damping == b.shear_damping &&
         a.dissipation == b.dissipation;
}

}  // namespace

TEST_CASE("springs kept from step to step are those made anew", "[integrator][springs]") {
  Scene scene = test::column_of_blocks(6);
  scene.joints[0].damping_ratio = 0.1;
  Simulation<3> simulation(scene);
  std::vector<Contact> contacts = simulation.contacts();
  const StepProblem<3> present = simulation.problem(1e-3, false);
  StepProblem<3> problem{present.system, present.external, present.joints, contacts, present.method};
  problem.dt = 1e-3;
  SpringList<3> list;
  std::size_t made = 0;
  const auto renew = [&] {
    made = 0;
    list.renew(problem, [&](const Contact& contact) {
      ++made;
      return plain_springs(problem, contact);
    });
    REQUIRE(list.springs().size() == contacts.size());
    for (std::size_t c = 0; c < contacts.size(); ++c) CHECK(are_same(list.springs()[c], plain_springs(problem, contacts[c])));
  };
  renew();
  CHECK(made == contacts.size());
  std::mt19937 random(3);
  const auto number = [&](double largest) { return std::uniform_real_distribution<double>(-largest, largest)(random); };
  const auto move_on = [&] {
    for (Contact& c : contacts) {
      c.gap = number(1e-3);
      c.elastic_slip = number(1e-3);
    }
  };

  SECTION("gaps and slips are those of the step") {
    move_on();
    renew();
    CHECK(made == 0);
  }
  SECTION("a length has changed") {
    move_on();
    contacts[2].length *= 0.5;
    renew();
    CHECK(made == 1);
  }
  SECTION("contacts have other places, or are gone") {
    std::rotate(contacts.begin(), contacts.begin() + 1, contacts.end());
    contacts.pop_back();
    move_on();
    renew();
    contacts = simulation.contacts();
    renew();
  }
  SECTION("two blocks in the place of two others") {
    contacts[0].vertex_block = contacts.back().vertex_block;
    contacts[0].edge_block = contacts.back().edge_block;
    renew();
    CHECK(made == 1);
  }
  SECTION("another step") {
    problem.dt = 2e-3;
    renew();
    problem.end_weight = 0.6;
    renew();
    problem.statics = true;
    renew();
    CHECK(made == contacts.size());
  }
  SECTION("a dissipation lasts for one step") {
    list.set_dissipation(0.1);
    CHECK(list.springs()[1].dissipation == 0.1);
    renew();
  }
}
