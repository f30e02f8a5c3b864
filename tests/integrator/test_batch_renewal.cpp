// Contacts with springs kept from step to step against contacts made anew in every step: the same to the last bit.
#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/batch_renewal.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// Springs of the joints, counted as they are made.
class CountedSprings final : public SpringSource {
 public:
  explicit CountedSprings(const StepProblem& problem) : problem_(problem) {}
  ContactSprings make(std::size_t c) const override {
    ++made;
    ContactSprings s = joint_springs(problem_, problem_.contacts[c]);
    add_dashpots(problem_, problem_.contacts[c], s);
    return s;
  }
  bool last() const override { return true; }
  mutable std::size_t made = 0;

 private:
  const StepProblem& problem_;
};

/// With springs made anew for each contact.
std::vector<ContactBatch> made_anew(const StepProblem& problem) {
  const CountedSprings source(problem);
  std::vector<ContactSprings> springs;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) springs.push_back(source.make(c));
  ContactStarts starts;
  BatchRenewal().renew(problem, GivenSprings(springs), starts);
  return starts.batches;
}

}  // namespace

TEST_CASE("springs kept from step to step are those made anew", "[integrator][springs]") {
  Scene scene = test::column_of_blocks(6);
  scene.joints[0].damping_ratio = 0.1;
  scene.joints[0].cohesion = 1e5;
  scene.joints[0].tensile_strength = 1e4;
  Simulation simulation(scene);
  std::vector<Contact> contacts = simulation.change_contacts();
  const StepProblem present = simulation.problem(1e-3, false);
  StepProblem problem{present.system, present.external, present.joints, contacts, present.method};
  problem.dt = 1e-3;
  BatchRenewal renewal;
  ContactStarts starts;
  std::vector<ContactBatch>& batches = starts.batches;
  std::size_t made = 0;
  const auto renew = [&] {
    const CountedSprings source(problem);
    renewal.renew(problem, source, starts);
    made = source.made;
    const std::vector<ContactBatch> expected = made_anew(problem);
    REQUIRE(batches.size() == expected.size());
    CHECK(std::memcmp(batches.data(), expected.data(), sizeof(ContactBatch) * batches.size()) == 0);
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
  SECTION("a bond is lost") {
    move_on();
    contacts[2].bonded = false;
    renew();
    CHECK(made == 1);
    CHECK(batches[0].tension[2] == 0.0);
  }
  SECTION("the strength of joints is reduced") {
    const double before = batches[0].tension[1];
    simulation.change_joints().reduce_strength(2.0);
    renew();
    CHECK(made == contacts.size());
    CHECK(batches[0].tension[1] == 0.5 * before);
  }
  SECTION("others have changed the batches") {
    batches[0].cohesion[1] = 0.0;
    renewal.forget();
    renew();
    CHECK(made == contacts.size());
  }
  SECTION("contacts have other places, or are gone") {
    std::rotate(contacts.begin(), contacts.begin() + 1, contacts.end());
    contacts.pop_back();
    move_on();
    renew();
    contacts = simulation.change_contacts();
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
  SECTION("springs that last for one step") {
    std::vector<ContactSprings> springs(contacts.size());
    for (ContactSprings& s : springs) s.dissipation = 0.1;
    renewal.renew(problem, GivenSprings(springs), starts);
    CHECK(batches[0].dissipation[1] == 0.1);
    renew();
    CHECK(made == contacts.size());
  }
}
