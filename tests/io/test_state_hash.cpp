// The hash of a state: the same where all bits are, and only there.
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "openclose/io/state_hash.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string hash_after(const std::string& method, int steps) {
  Scene scene = test::tumbling_blocks();
  scene.method.contact = method;
  Simulation simulation(std::move(scene));
  for (int i = 0; i < steps; ++i) REQUIRE(simulation.advance(1e-3));
  return state_hash(simulation);
}

}  // namespace

TEST_CASE("state hash: repeats have the same, one step more has another one", "[io][hash]") {
  for (const std::string method : {"soft", "hard", "shi", "dem"}) {
    INFO(method);
    const std::string hash = hash_after(method, 40);
    CHECK(hash.size() == 16);
    CHECK(hash == hash_after(method, 40));
    CHECK(hash != hash_after(method, 41));
  }
}

TEST_CASE("state hash: one bit of a velocity, a place or a contact shows, the sign of zero does not", "[io][hash]") {
  Simulation simulation(test::block_on_base());
  simulation.change_contacts();
  const std::string hash = state_hash(simulation);
  const int block = simulation.system().free_blocks()[0];

  Motion::Unknowns velocity = Motion::Unknowns::Zero();
  velocity[0] = -0.0;
  simulation.set_velocity(block, velocity);
  CHECK(state_hash(simulation) == hash);
  velocity[0] = std::numeric_limits<double>::denorm_min();
  simulation.set_velocity(block, velocity);
  CHECK(state_hash(simulation) != hash);
  simulation.set_velocity(block, Motion::Unknowns::Zero());
  CHECK(state_hash(simulation) == hash);

  for (double Contact::*number : {&Contact::gap, &Contact::normal_force, &Contact::shear_force}) {
    Contact& contact = simulation.change_contacts().at(0);
    const double before = contact.*number;
    contact.*number = std::nextafter(before, infinity);
    CHECK(state_hash(simulation) != hash);
    contact.*number = before;
  }
  simulation.change_contacts().at(0).status = ContactStatus::sliding;
  CHECK(state_hash(simulation) != hash);
  simulation.change_contacts().at(0).status = ContactStatus::open;
  CHECK(state_hash(simulation) == hash);

  simulation.change_system().advance(block, 1e-300 * Motion::Unknowns::Ones());
  CHECK(state_hash(simulation) != hash);
}

TEST_CASE("state hash: the order of contacts does not matter, their blocks do", "[io][hash]") {
  Simulation simulation(test::block_on_base());
  REQUIRE(simulation.change_contacts().size() >= 2);
  Contact& first = simulation.change_contacts()[0];
  Contact& second = simulation.change_contacts()[1];
  first.normal_force = 1.0;
  second.normal_force = 2.0;
  const std::string hash = state_hash(simulation);
  std::swap(simulation.change_contacts()[0], simulation.change_contacts()[1]);
  CHECK(state_hash(simulation) == hash);
  std::swap(simulation.change_contacts()[0].normal_force, simulation.change_contacts()[1].normal_force);
  CHECK(state_hash(simulation) != hash);
}

TEST_CASE("state hash of a search: states and trials count", "[io][hash]") {
  const Simulation simulation(test::block_on_base());
  FactorOfSafety safety;
  safety.states.push_back({"stable", simulation.system(), simulation.contacts()});
  StrengthTrial trial;
  trial.srf = 1.5;
  safety.trials.push_back(trial);
  const std::string hash = state_hash(safety, simulation.scene());
  CHECK(hash == state_hash(safety, simulation.scene()));
  safety.trials[0].srf = std::nextafter(1.5, infinity);
  CHECK(state_hash(safety, simulation.scene()) != hash);
  safety.trials[0].srf = 1.5;
  BlockSystem& system = safety.states[0].system;
  system.advance(system.free_blocks()[0], 1e-300 * Motion::Unknowns::Ones());
  CHECK(state_hash(safety, simulation.scene()) != hash);
}
