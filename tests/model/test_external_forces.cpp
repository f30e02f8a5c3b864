#include <cmath>
#include <limits>
#include <random>

#include "openclose/model/external_forces.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using test::empty_scene;
using test::fixed_block;
using test::free_block;
using test::rectangle;

namespace {

using System = BlockSystem;
using Forces = ExternalForces;
using Unknowns = System::Unknowns;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// 2 m x 1 m about (1, 0.5), 5000 kg.
Scene one_block() {
  Scene scene = empty_scene();
  scene.blocks = {fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))};
  return scene;
}

/// Energy of gravity, loads and springs, from the positions alone.
double energy(const Scene& scene, const System& system) {
  double total = -system.block(1).mass[0] * scene.gravity.dot(system.centroid(1));
  const auto moved = [&](const Vec2& point) {
    return Motion::displacement(system.displacement(1), point - system.origin() - system.block(1).reference_centroid, scene.method.rotation);
  };
  for (const Load& load : scene.loads) total -= load.force.dot(moved(load.point));
  for (const Support& support : scene.supports) total += 0.5 * support.stiffness.dot(moved(support.point).cwiseAbs2());
  return total;
}

double energy_after(const Scene& scene, System system, const Unknowns& d) {
  system.advance(1, d);
  return energy(scene, system);
}

}  // namespace

TEST_CASE("weight pulls at the centroid", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity = {1.5, -9.81};
  System system(scene);
  const Forces forces(scene, system);
  CHECK(forces.gravity() == scene.gravity);
  CHECK((forces.weight(system, 1) - Unknowns(7500.0, -49050.0, 0.0)).norm() <= 49050.0 * 10.0 * epsilon);
  CHECK(forces.force(system, 1, Unknowns::Zero()) == forces.weight(system, 1));
  // However far it turns.
  CHECK(forces.force(system, 1, {1.0, 2.0, 3.0}) == forces.weight(system, 1));
  CHECK(forces.stiffness(system, 1, {1.0, 2.0, 3.0}).isZero(0.0));
}

TEST_CASE("a load keeps its direction and its lever turns with the block", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity.setZero();
  scene.loads = {{1, {2.0, 0.5}, {0.0, 100.0}}, {0, {0.0, 0.0}, {7.0, 7.0}}};
  System system(scene);
  const Forces forces(scene, system);
  CHECK((forces.force(system, 1, Unknowns::Zero()) - Unknowns(0.0, 100.0, 100.0)).norm() <= 1e-13);
  const Unknowns turned(3.0, -1.0, 60.0 * test::degree);
  CHECK((forces.force(system, 1, turned) - Unknowns(0.0, 100.0, 50.0)).norm() <= 1e-12);
  system.advance(1, turned);
  CHECK((forces.force(system, 1, Unknowns::Zero()) - Unknowns(0.0, 100.0, 50.0)).norm() <= 1e-12);
}

TEST_CASE("a support pulls back to where its point was", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity.setZero();
  scene.supports = {{1, {2.0, 1.0}, {1000.0, 500.0}}};
  System system(scene);
  const Forces forces(scene, system);
  CHECK(forces.force(system, 1, Unknowns::Zero()).isZero(0.0));
  // Moved by (0.1, 0.2): force (-100, -100) at the arm (1, 0.5).
  CHECK((forces.force(system, 1, {0.1, 0.2, 0.0}) - Unknowns(-100.0, -100.0, -50.0)).norm() <= 1e-12);
  system.advance(1, {0.1, 0.2, 0.0});
  CHECK((forces.force(system, 1, Unknowns::Zero()) - Unknowns(-100.0, -100.0, -50.0)).norm() <= 1e-12);
  CHECK((forces.force(system, 1, {-0.1, -0.2, 0.0})).norm() <= 1e-12);
}

TEST_CASE("only the loads and supports of a block act on it", "[model][external_forces]") {
  Scene scene = one_block();
  scene.blocks.push_back(free_block("other", rectangle(5.0, 0.0, 1.0, 1.0)));
  scene.gravity.setZero();
  scene.loads = {{2, {5.5, 0.5}, {3.0, 4.0}}};
  scene.supports = {{1, {1.0, 0.5}, {100.0, 0.0}}, {2, {5.5, 0.5}, {0.0, 20.0}}};
  System system(scene);
  const Forces forces(scene, system);
  const Unknowns d(0.5, 0.5, 0.0);
  CHECK((forces.force(system, 1, d) - Unknowns(-50.0, 0.0, 0.0)).norm() <= 1e-12);
  CHECK((forces.force(system, 2, d) - Unknowns(3.0, -6.0, 0.0)).norm() <= 1e-12);
}

TEST_CASE("forces are minus the gradient of the energy, stiffness is its second derivative", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity = {0.3, -1.0};
  scene.materials[0].density = 1.0;
  scene.loads = {{1, {0.3, 0.9}, {2.0, -1.5}}, {1, {1.8, 0.1}, {-0.5, 1.0}}};
  scene.supports = {{1, {0.0, 0.0}, {3.0, 0.0}}, {1, {2.0, 1.0}, {1.0, 2.0}}};
  System system(scene);
  const Forces forces(scene, system);
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto unknowns = [&] { return Unknowns(number(generator), number(generator), 2.0 * number(generator)); };
  // Energy, force, stiffness and their derivatives are of some 10 J, N, N/m: h^2/6 of the third derivative, epsilon/h of the value.
  const double h = 6e-6, quotient_error = 50.0 * (h * h + 4.0 * epsilon / h);
  for (int trial = 0; trial < 100; ++trial) {
    system.advance(1, 0.3 * unknowns());
    const Unknowns d = unknowns();
    for (int k = 0; k < 3; ++k) {
      Unknowns up = d, down = d;
      up[k] += h;
      down[k] -= h;
      const double slope = (energy_after(scene, system, up) - energy_after(scene, system, down)) / (2.0 * h);
      CHECK(std::abs(forces.force(system, 1, d)[k] + slope) <= quotient_error);
      const Unknowns column = (forces.force(system, 1, up) - forces.force(system, 1, down)) / (2.0 * h);
      CHECK((forces.stiffness(system, 1, d).col(k) + column).cwiseAbs().maxCoeff() <= quotient_error);
    }
    CHECK(forces.stiffness(system, 1, d).isApprox(forces.stiffness(system, 1, d).transpose(), 1e-14));
  }
}

TEST_CASE("the mean force does the work of the way, its stiffness is its difference quotient", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity = {0.3, -1.0};
  scene.materials[0].density = 1.0;
  scene.loads = {{1, {0.3, 0.9}, {2.0, -1.5}}, {1, {1.8, 0.1}, {-0.5, 1.0}}};
  scene.supports = {{1, {0.0, 0.0}, {3.0, 0.0}}, {1, {2.0, 1.0}, {1.0, 2.0}}};
  System system(scene);
  const Forces forces(scene, system);
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto unknowns = [&] { return Unknowns(number(generator), number(generator), number(generator)); };
  const double h = 6e-6, quotient_error = 50.0 * (h * h + 4.0 * epsilon / h);
  for (int trial = 0; trial < 100; ++trial) {
    system.advance(1, 0.3 * unknowns());
    CHECK((forces.mean_force(system, 1, Unknowns::Zero()) - forces.force(system, 1, Unknowns::Zero())).norm() <= 100.0 * epsilon);
    const Unknowns d = unknowns();
    for (int k = 0; k < 3; ++k) {
      Unknowns up = d, down = d;
      up[k] += h;
      down[k] -= h;
      const Unknowns column = (forces.mean_force(system, 1, up) - forces.mean_force(system, 1, down)) / (2.0 * h);
      CHECK((forces.mean_stiffness(system, 1, d).col(k) + column).cwiseAbs().maxCoeff() <= quotient_error);
    }
    const auto rest = [&](const Unknowns& way) {
      return std::abs(forces.mean_force(system, 1, way).dot(way) + energy_after(scene, system, way) - energy(scene, system));
    };
    const Unknowns straight(d[0], d[1], 0.0);
    CHECK(rest(straight) <= 200.0 * epsilon);
    // Third order in the rotation, times some 20 N m.
    CHECK(rest(Unknowns(0.0, 0.0, 0.01)) <= 20.0 * 1e-6);
  }
}

TEST_CASE("a trial displacement and an accepted one give the same force", "[model][external_forces]") {
  Scene scene = one_block();
  scene.method.rotation = GENERATE(RotationKind::exact, RotationKind::linear);
  scene.loads = {{1, {0.3, 0.9}, {2e4, -1.5e4}}};
  scene.supports = {{1, {2.0, 1.0}, {1e5, 2e5}}};
  System system(scene);
  const Forces forces(scene, system);
  system.advance(1, {0.1, 0.0, 0.3});
  const Unknowns d(0.2, -0.1, 0.4), trial = forces.force(system, 1, d);
  system.advance(1, d);
  CHECK((forces.force(system, 1, Unknowns::Zero()) - trial).norm() <= 50.0 * epsilon * trial.norm());
}

TEST_CASE("a surcharge turns with its block", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity.setZero();
  // On the right half of the top, from right to left: 1 m, 0.5 m to the right of the centroid and above it.
  scene.surcharges = {{1, {2.0, 1.0}, {1.0, 1.0}, 100.0, 30.0}};
  System system(scene);
  const Forces forces(scene, system);
  CHECK((forces.force(system, 1, Unknowns::Zero()) - Unknowns(-30.0, -100.0, 0.5 * -100.0 + 0.5 * 30.0)).norm() <= 1e-12);
  const Unknowns quarter(3.0, -1.0, 90.0 * test::degree), turned(100.0, -30.0, -35.0);
  CHECK((forces.force(system, 1, quarter) - turned).norm() <= 1e-12);
  system.advance(1, quarter);
  CHECK((forces.force(system, 1, Unknowns::Zero()) - turned).norm() <= 1e-12);
  CHECK(forces.magnitude(system, 1, Unknowns::Zero()) == Approx(std::hypot(100.0, 30.0)).epsilon(1e-14));
}

TEST_CASE("the derivatives of a surcharge are its difference quotients, and its mean force does its work", "[model][external_forces]") {
  Scene scene = one_block();
  scene.gravity.setZero();
  scene.surcharges = {{1, {2.0, 1.0}, {0.5, 1.0}, 1.5, -0.7}, {1, {2.0, 0.0}, {2.0, 1.0}, -0.4, 0.9}};
  System system(scene);
  const Forces forces(scene, system);
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const double h = 6e-6, quotient_error = 50.0 * (h * h + 4.0 * epsilon / h);
  for (int trial = 0; trial < 100; ++trial) {
    system.advance(1, {number(generator), number(generator), number(generator)});
    const Unknowns d(number(generator), number(generator), number(generator));
    for (int k = 0; k < 3; ++k) {
      Unknowns up = d, down = d;
      up[k] += h;
      down[k] -= h;
      const Unknowns column = (forces.force(system, 1, up) - forces.force(system, 1, down)) / (2.0 * h);
      CHECK((forces.stiffness(system, 1, d).col(k) + column).cwiseAbs().maxCoeff() <= quotient_error);
      const Unknowns mean_column = (forces.mean_force(system, 1, up) - forces.mean_force(system, 1, down)) / (2.0 * h);
      CHECK((forces.mean_stiffness(system, 1, d).col(k) + mean_column).cwiseAbs().maxCoeff() <= quotient_error);
    }
    // The work along the straight way in a thousand pieces, each with the force in its middle; of the third order in the rotation.
    const Unknowns small = 0.01 * d;
    double work = 0.0;
    for (int i = 0; i < 1000; ++i) work += forces.force(system, 1, (i + 0.5) / 1000.0 * small).dot(small) / 1000.0;
    CHECK(std::abs(forces.mean_force(system, 1, small).dot(small) - work) <= 1e-6);
    double change = 0.0;
    for (const auto& element : forces.elements()) change += element->energy_change(element->path(system, small));
    CHECK(std::abs(change + work) <= 1e-6);
  }
}
