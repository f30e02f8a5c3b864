// The explicit loop with its links four at a time against the same links one by one: the same to the last bit.
#include <algorithm>
#include <vector>

#include "openclose/analysis/simulation.h"
#include "openclose/integrator/central_difference.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

/// A row of columns that are shaken, pulled apart and sheared: contacts open, close, stick, slide and lose their strength.
Scene shaken_columns() {
  Scene scene = test::column_of_blocks(7);
  for (int i = 1; i <= 7; ++i) {
    scene.blocks[i].velocity = {0.3 * (i % 3 - 1), i % 2 == 0 ? 0.2 : -0.1};
    scene.blocks[i].angular_velocity = 0.1 * (i % 5 - 2);
  }
  scene.joints[0].cohesion = 5e4;
  scene.joints[0].tensile_strength = 2e4;
  return scene;
}

bool same(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Contact& x, const Contact& y) {
    return x.gap == y.gap && x.status == y.status && x.bonded == y.bonded && x.elastic_slip == y.elastic_slip && x.normal_force == y.normal_force &&
           x.shear_force == y.shear_force && x.stored_energy == y.stored_energy;
  });
}

/// With the contacts that the step to come may close.
void load_anew(CentralDifference& loop, Simulation& simulation, const StepProblem& problem) {
  loop.store_blocks(simulation.change_system());
  loop.store_contacts(simulation.change_contacts());
  loop.store_far_gaps(simulation.system(), simulation.change_contacts());
  loop.load(problem);
}

}  // namespace

TEST_CASE("links four at a time do what each does", "[integrator][explicit]") {
  Scene scene = GENERATE(shaken_columns(), test::tumbling_blocks());
  scene.method.contact = "dem";
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.2);
  scene.joints[0].cohesion_behaviour = GENERATE(CohesionBehaviour::ductile, CohesionBehaviour::lost_on_slip);
  Simulation simulation(scene);
  constexpr double h = 1e-4;  // [s]
  std::vector<Contact> by_fours = simulation.change_contacts();
  const StepProblem problem = simulation.problem(h, false);
  CentralDifference fours(tolerance::contact_skin_m, true), ones(tolerance::contact_skin_m, false);
  fours.load(problem);
  ones.load(problem);
  std::vector<Contact> one_by_one = by_fours;
  int changes = 0, lost = 0, wrong = 0, reloads = 0;
  for (int step = 0; step < 2000; ++step) {
    const std::vector<Contact> before = one_by_one;
    for (CentralDifference* loop : {&fours, &ones}) {
      const auto move = [&] { return loop->move(h, h, Vec2(0.3, 0.0), 1.0, 1.0, MassDamping::none, 0.0); };
      Move moved = move();
      if (moved == Move::past_list) {
        load_anew(*loop, simulation, problem);
        ++reloads;
        moved = move();
      }
      REQUIRE(moved == Move::taken);
      loop->follow_contacts();
    }
    fours.store_contacts(by_fours);
    ones.store_contacts(one_by_one);
    wrong += !same(by_fours, one_by_one) || fours.unbalanced_force() != ones.unbalanced_force() || fours.lost_strength() != ones.lost_strength();
    const ExplicitEnergies a = fours.take_energies(), b = ones.take_energies();
    wrong += a.friction != b.friction || a.contact_damping != b.contact_damping || a.scheme != b.scheme || a.redefinition != b.redefinition;
    for (std::size_t c = 0; c < before.size(); ++c) changes += before[c].status != one_by_one[c].status;
    lost += ones.lost_strength();
  }
  CHECK(wrong == 0);
  CHECK(reloads > 0);
  CHECK(fours.max_penetration() == ones.max_penetration());
  if (scene.blocks.size() < 5) return;
  CHECK(changes > 20);
  CHECK(lost > 0);
}
