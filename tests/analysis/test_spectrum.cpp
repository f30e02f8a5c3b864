#include <cmath>
#include <numbers>
#include <string>

#include "openclose/analysis/spectrum.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr double dt = 1e-3;      // [s]
constexpr double mass = 5000.0;  // [kg/m] of a block

/// w_j = 2 sqrt(k/m) sin((2j-1) pi/(2(2n+1))) of a chain of n equal masses on equal springs, fixed at one end [rad/s].
double chain_frequency(double stiffness, int n, int j) {
  return 2.0 * std::sqrt(stiffness / mass) * std::sin((2 * j - 1) * std::numbers::pi / (2 * (2 * n + 1)));
}

}  // namespace

TEST_CASE("a column whose blocks do not turn has the frequencies of a chain", "[analysis][spectrum]") {
  constexpr int n = 4;
  for (const std::string method : {"soft", "shi"}) {
    INFO(method);
    Scene scene = test::column_of_blocks(n);
    scene.method.contact = method;
    scene.method.penalty = 4e9;
    scene.method.penalty_shear_ratio = 0.25;
    scene.joints[0].normal_stiffness = 1e9;
    scene.joints[0].shear_stiffness = 0.5e9;
    for (int i = 1; i <= n; ++i) {
      scene.blocks[i].vertices = test::rectangle(0.0, i - 1, test::block_edge, 1.0);
      scene.blocks[i].rotation_locked = true;
    }
    Simulation simulation(scene);
    const Spectrum s = spectrum(simulation, dt);
    const double normal = method == "soft" ? 1e9 : 4e9, shear = method == "soft" ? 0.5e9 : 1e9;
    const double highest = chain_frequency(normal * test::block_edge, n, n), lowest = chain_frequency(shear * test::block_edge, n, 1);
    CHECK(s.highest == Approx(highest).epsilon(1e-12));
    CHECK(s.lowest == Approx(lowest).epsilon(1e-12));
    const double inertia = simulation.problem(dt, false).inertia;
    CHECK(s.condition == Approx((inertia + highest * highest) / (inertia + lowest * lowest)).epsilon(1e-12));
  }
}

TEST_CASE("a block that nothing holds has a frequency of zero, supports add theirs", "[analysis][spectrum]") {
  Scene scene = test::falling_block();
  scene.supports = {{0, {1.0, 0.5}, {0.0, 5e6}}};
  Simulation simulation(scene);
  const Spectrum s = spectrum(simulation, dt);
  CHECK(s.lowest == 0.0);
  CHECK(s.highest == Approx(std::sqrt(5e6 / mass)).epsilon(1e-14));
}

TEST_CASE("contacts without springs and models without free blocks have no spectrum", "[analysis][spectrum]") {
  Scene scene = test::block_on_base();
  SECTION("hard") {
    scene.method.contact = "hard";
  }
  SECTION("all fixed") {
    scene.blocks[1].fixed = true;
  }
  Simulation simulation(scene);
  CHECK_THROWS_AS(spectrum(simulation, dt), InputError);
}
