// Contacts in batches of four against the contacts they are made of.
#include <algorithm>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/contact_layout.h"
#include "openclose/integrator/enforcement.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

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

TEST_CASE("batches have the places, the springs and the strength of their contacts", "[integrator][springs]") {
  Scene scene = test::column_of_blocks(6);
  scene.joints[0].damping_ratio = 0.1;
  scene.joints[0].cohesion = 1e5;
  scene.joints[0].tensile_strength = 1e4;
  Simulation simulation(scene);
  std::vector<Contact> contacts = simulation.change_contacts();
  contacts[1].bonded = false;
  contacts[2].gap = -1e-4;
  contacts[2].elastic_slip = 2e-5;
  simulation.change_joints().reduce_strength(2.0);
  const StepProblem present = simulation.problem(1e-3, false);
  StepProblem problem{present.system, present.external, present.joints, contacts, present.method};
  problem.dt = 1e-3;
  const std::vector<ContactSprings> springs = springs_of(problem);
  std::vector<ContactBatch> batches;
  lay_out(problem, GivenSprings(springs), batches);

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
  lay_out(problem, GivenSprings(springs), batches);
  REQUIRE(batches.size() == 1);
  for (int k = 1; k < batch_size; ++k) {
    CHECK(batches[0].vertex_place(k) == problem.system.free_count());
    CHECK(batches[0].springs(k).normal == 0.0);
    CHECK(batches[0].strength(k).tension == 0.0);
  }
}
