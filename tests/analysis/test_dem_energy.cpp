// `dem` at its defaults creates no energy and lets nothing through: impacts, slides, thin plates, blocks far away.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "openclose/analysis/run.h"
#include "openclose/integrator/crossing_energy.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

Scene explicit_scene(Scene scene, double dt) {
  scene.method.contact = "dem";
  scene.step.dt = dt;
  return scene;
}

/// What can become motion [J]: it may only fall.
double mechanical_energy(const Simulation& simulation) {
  const EnergyLedger& l = simulation.ledger();
  return l.kinetic + l.gravity + l.contact_springs + l.support_springs + l.loads;
}

/// [-] Rise of the mechanical energy above the least it has been, over the largest change of the kinetic energy or of the height.
double created_energy(const Scene& scene, double duration) {
  Simulation simulation(scene);
  double least = 0.0, rise = 0.0, scale = simulation.system().kinetic_energy();
  for (int i = 0; i < static_cast<int>(std::lround(duration / scene.step.dt)); ++i) {
    REQUIRE(simulation.advance(scene.step.dt));
    const double energy = mechanical_energy(simulation);
    least = std::min(least, energy);
    rise = std::max(rise, energy - least);
    scale = std::max({scale, std::abs(simulation.ledger().kinetic), std::abs(simulation.ledger().gravity)});
  }
  CHECK(std::abs(simulation.ledger().imbalance()) < 1e-9 * simulation.ledger().turnover);
  return rise / scale;
}

Scene above_ground(std::vector<Vec2> vertices, const Vec2& velocity, double dt) {
  Scene scene = explicit_scene(test::empty_scene(), dt);
  scene.blocks = {test::fixed_block("ground", test::rectangle(-1000.0, -5.0, 2000.0, 5.0)), test::free_block("block", std::move(vertices))};
  scene.blocks[1].velocity = velocity;
  return scene;
}

/// A polygon that falls, or a block that slides, of any size, stiffness and step.
Scene random_scene(std::mt19937& generator) {
  const auto between = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator); };
  const auto decades = [&](double low, double high) { return std::pow(10.0, between(low, high)); };
  const double size = decades(-1.3, 1.0), dt = decades(-4.0, -1.0), flat = between(0.3, 1.0);
  Scene scene;
  if (between(0.0, 1.0) < 0.5) {
    scene = above_ground(test::rectangle(0.0, 0.0, size, flat * size), {between(0.0, 2.0), 0.0}, dt);
    const double slope = between(5.0, 50.0) * test::degree;
    scene.gravity = {9.81 * std::sin(slope), -9.81 * std::cos(slope)};
  } else {
    const int corners = std::uniform_int_distribution<int>(3, 6)(generator);
    const double turn = between(0.0, 6.0), height = size + between(0.0, 2.0);
    std::vector<Vec2> vertices;
    for (int i = 0; i < corners; ++i) {
      const double angle = turn + 2.0 * std::numbers::pi * i / corners;
      vertices.emplace_back(0.5 * size * std::cos(angle), height + 0.5 * flat * size * std::sin(angle));
    }
    scene = above_ground(vertices, {between(-2.0, 2.0), between(-10.0, 2.0)}, dt);
  }
  scene.joints[0].normal_stiffness = decades(8.0, 11.0);
  scene.joints[0].shear_stiffness = decades(-1.3, 0.0) * scene.joints[0].normal_stiffness;
  scene.joints[0].friction_angle = between(10.0, 50.0) * test::degree;
  return scene;
}

}  // namespace

TEST_CASE("one mass on one spring returns from a bounce no faster, and hardly slower, at any step", "[integrator][dem][energy]") {
  const double fraction = GENERATE(0.1, 0.25, 0.35, 0.45, 0.5, 0.7, 0.9), k = 4.0 * fraction * fraction;  // step and mass of 1
  double lost = 0.0;
  for (int phase = 0; phase < 100; ++phase) {
    double gap = 1.0 - (phase + 0.5) / 100.0, velocity = -1.0, force = 0.0, owed = 0.0;
    bool closed = false;
    for (int step = 0; step < 1000 && !(gap > 0.0 && velocity > 0.0 && force == 0.0); ++step) {
      velocity += force;
      const double before = gap;
      gap += velocity;
      if (gap < 0.0) {
        if (!closed) owed = closing_energy(k, before, gap);
        force = -k * gap;
      } else if (closed) {
        force = settling_force(k, owed - 0.5 * k * before * gap, gap - before, fraction * fraction);
      } else {
        force = 0.0;
      }
      closed = gap < 0.0;
    }
    CHECK(velocity <= 1.0 + 1e-12);
    lost += 0.01 * (1.0 - velocity * velocity);
  }
  if (fraction <= 0.5) CHECK(lost < 3e-3);
}

TEST_CASE("random slides and drops create no energy", "[analysis][dem][energy]") {
  std::mt19937 generator(20261122);
  for (int i = 0; i < 40; ++i) {
    const Scene scene = random_scene(generator);
    INFO("scene " << i << ", dt " << scene.step.dt << ", kn " << scene.joints[0].normal_stiffness);
    CHECK(created_energy(scene, 0.6) < 1e-2);
  }
}

TEST_CASE("a block that is dropped never comes higher than it was", "[analysis][dem][energy]") {
  Scene scene = above_ground(test::rectangle(0.0, 1.0, 1.0, 1.0), Vec2::Zero(), 0.01);
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = GENERATE(1e8, 1e10);
  CHECK(created_energy(scene, 5.0) < 1e-10);
}

TEST_CASE("a plate stops what it can and the run ends where it cannot", "[analysis][dem]") {
  // A block of 10 mm meets a plate; its closure is v sqrt(m/k).
  const double thickness = 1e-3, speed = 100.0, size = 0.01;
  const double closure = GENERATE(0.1, 0.03, 3.0) * thickness, mass = 2500.0 * size * size;
  Scene scene = above_ground(test::rectangle(0.0, 0.3, size, size), {GENERATE(0.0, 30.0), -speed}, 0.01);
  scene.blocks[0].vertices = test::rectangle(-3.0, -thickness, 8.0, thickness);
  scene.joints[0].normal_stiffness = mass * speed * speed / (closure * closure) / size;
  scene.joints[0].shear_stiffness = 0.5 * scene.joints[0].normal_stiffness;
  Simulation simulation(scene);
  const bool arrived = simulation.advance(0.01);
  if (closure > thickness) {
    CHECK_FALSE(arrived);
    CHECK_THAT(simulation.reason(), Catch::Matchers::ContainsSubstring("joint[0].normal_stiffness_pa_per_m"));
    return;
  }
  REQUIRE(arrived);
  CHECK(simulation.system().centroid(1).y() + simulation.system().origin().y() > 0.0);
  CHECK(simulation.velocity(1)[1] > 0.0);
}

TEST_CASE("dashpots shorten the step of local damping, too", "[analysis][dem]") {
  Scene scene = explicit_scene(test::block_on_base(), 1e-3);
  scene.joints[0].damping_ratio = 0.5;
  Simulation simulation(scene);
  const double plain = simulation.explicit_stepper()->longest_stable_step(MassDamping::none),
               damped = simulation.explicit_stepper()->longest_stable_step(MassDamping::local);
  // a h^2 + 2 b h = 4 with a and b 1 + alpha times as large: shorter by more than the root, by less than the factor itself.
  const double share = 1.0 + scene.method.local_damping;
  CHECK(damped < plain / std::sqrt(share));
  CHECK(damped > plain / share);
}

TEST_CASE("a block far away changes no digit", "[analysis][dem]") {
  Scene alone = explicit_scene(test::tumbling_blocks(), 1e-3);
  Scene with = alone;
  with.blocks.push_back(test::fixed_block("far ground", test::rectangle(500.0, -1.0, 20.0, 1.0)));
  with.blocks.push_back(test::free_block("far", test::rectangle(505.0, 0.0, 2.0, 1.0)));
  Simulation one(alone), two(with);
  for (int i = 0; i < 600; ++i) {
    REQUIRE(one.advance(alone.step.dt));
    REQUIRE(two.advance(with.step.dt));
  }
  for (std::size_t b = 0; b < alone.blocks.size(); ++b)
    CHECK((one.system().displacement(static_cast<int>(b)).array() == two.system().displacement(static_cast<int>(b)).array()).all());
}
