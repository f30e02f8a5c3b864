#include <cmath>
#include <string>

#include "openclose/analysis/run.h"
#include "openclose/analysis/start.h"
#include "openclose/core/error.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::all_methods;
using openclose::test::block_weight;

namespace {

const double slope = 30.0 * test::degree;

Scene sliding_scene(const std::string& method) {
  Scene scene = test::block_on_incline(slope);
  scene.method.contact = method;
  scene.joints[0].friction_angle = 20.0 * test::degree;
  scene.blocks[1].velocity = {1.0, 2.0};
  return scene;
}

/// Force and moment of the contacts on block 1, about its centroid, from their forces and places.
Eigen::Vector3d contact_forces(Simulation& simulation) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Vector3d still = Eigen::Vector3d::Zero();
  for (const Contact& c : simulation.change_contacts()) {
    const ContactKinematics k(simulation.system(), c, still, still);
    const double sign = c.vertex_block == 1 ? 1.0 : -1.0;
    const Vec2 force = sign * (c.normal_force * k.normal + c.shear_force * k.tangent);
    const Vec2 arm = simulation.system().position(c.vertex_block, c.vertex) - simulation.system().centroid(1);
    sum += Eigen::Vector3d(force.x(), force.y(), cross(arm, force));
  }
  return sum;
}

}  // namespace

TEST_CASE("normal forces and moments are in balance, shear springs relaxed or mobilised", "[analysis][start]") {
  for (const std::string& method : all_methods) {
    for (const bool mobilised : {false, true}) {
      INFO(method << (mobilised ? ", mobilised" : ", relaxed"));
      Simulation simulation(sliding_scene(method));
      balance_normal_forces(simulation, mobilised);
      const Eigen::Vector3d sum = contact_forces(simulation);
      const double mu = std::tan(20.0 * test::degree), normal = block_weight * std::cos(slope);
      CHECK(sum.head<2>().dot(test::off_slope(slope)) == Approx(normal).epsilon(1e-12));
      CHECK(-sum.head<2>().dot(test::downhill(slope)) == Approx(mobilised ? mu * normal : 0.0).epsilon(1e-12).margin(1e-9));
      // Rigid contacts carry the forces of springs that closed by some nanometres, without the closure.
      CHECK(std::abs(sum[2]) < (method == "hard" ? 1e-8 : 1e-11) * block_weight);
      for (const Contact& c : simulation.change_contacts()) {
        if (c.status == ContactStatus::open) continue;
        CHECK(c.status == (mobilised ? ContactStatus::sliding : ContactStatus::sticking));
        CHECK(std::abs(c.shear_force) == Approx(mobilised ? mu * c.normal_force : 0.0).epsilon(1e-12));
      }
      // Nothing has been moved along the slope, and rigid contacts need no closure.
      const Vec2 moved = simulation.system().displacement(1).head<2>();
      CHECK(std::abs(moved.dot(test::downhill(slope))) < 1e-15);
      if (method == "hard") CHECK(simulation.system().displacement(1).isZero(0.0));
    }
  }
}

TEST_CASE("a steadily sliding start slides steadily", "[analysis][start]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = sliding_scene(method);
    scene.blocks[1].velocity = {0.0, 0.0};
    scene.method.start = Start::steady_sliding;
    scene.end_time = 0.3;
    Simulation simulation(scene);
    REQUIRE(prepare_start(simulation).converged);
    const auto start = simulation.system().displacement(1);
    for (int i = 1; i <= 300; ++i) {
      REQUIRE(simulation.advance(scene.step.dt));
      if (i % 50 != 0) continue;
      const double t = simulation.time();
      const Eigen::Vector3d moved = simulation.system().displacement(1) - start;
      const double exact = 0.5 * 9.81 * (std::sin(slope) - std::tan(20.0 * test::degree) * std::cos(slope)) * t * t;
      CHECK(moved.head<2>().dot(test::downhill(slope)) == Approx(exact).epsilon(1e-9));
      CHECK(std::abs(moved.head<2>().dot(test::off_slope(slope))) < 1e-11);
      CHECK(std::abs(moved[2]) < 1e-11);
    }
  }
}

TEST_CASE("a start with loads and supports counts them in", "[analysis][start]") {
  Scene scene = test::block_on_base();
  scene.loads = {{1, {0.5, 1.0}, {0.0, -20000.0}}};
  Simulation simulation(scene);
  balance_normal_forces(simulation, false);
  const Eigen::Vector3d sum = contact_forces(simulation);
  CHECK(sum[1] == Approx(block_weight + 20000.0).epsilon(1e-12));
  const Eigen::Vector3d external = simulation.external().force(simulation.system(), 1, Eigen::Vector3d::Zero());
  CHECK(external[2] == Approx(20000.0 * 0.5).epsilon(1e-4));
  CHECK(std::abs(sum[2] + external[2]) < 1e-11 * block_weight);
}

TEST_CASE("a locked block is balanced along the normal alone", "[analysis][start]") {
  Scene scene = test::block_on_base();
  scene.loads = {{1, {0.5, 1.0}, {0.0, -20000.0}}};
  scene.blocks[1].rotation_locked = true;
  Simulation simulation(scene);
  balance_normal_forces(simulation, false);
  CHECK(contact_forces(simulation)[1] == Approx(block_weight + 20000.0).epsilon(1e-12));
  CHECK(simulation.system().displacement(1)[2] == 0.0);
}

TEST_CASE("starts that cannot be made are refused", "[analysis][start]") {
  const auto refusal = [](const Scene& scene) {
    Simulation simulation(scene);
    try {
      balance_normal_forces(simulation, true);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  SECTION("on a free block") {
    Scene scene = test::column_of_blocks(2);
    scene.blocks[1].line = 11;
    CHECK_THAT(refusal(scene), ContainsSubstring("scene.toml:11: block: \"block 0\" rests on a block that is not fixed"));
  }
  SECTION("on nothing") {
    Scene scene = test::falling_block();
    CHECK_THAT(refusal(scene), ContainsSubstring("\"block\" rests on nothing"));
  }
  SECTION("above the base, not on it") {
    Scene scene = test::block_on_base();
    scene.blocks[1].vertices = test::rectangle(0.0, 0.01, 2.0, 1.0);
    CHECK_THAT(refusal(scene), ContainsSubstring("\"block\" rests on nothing"));
  }
  SECTION("between two walls") {
    Scene scene = test::block_on_base();
    scene.blocks.push_back(test::fixed_block("wall", test::rectangle(-1.0, 0.0, 1.0, 3.0)));
    CHECK_THAT(refusal(scene), ContainsSubstring("\"block\" rests on edges of different directions"));
  }
}
