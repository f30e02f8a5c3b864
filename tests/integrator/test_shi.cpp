#include <cmath>
#include <string>

#include "openclose/analysis/run.h"
#include "openclose/integrator/registry.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

namespace {

struct Outcome {
  Eigen::Vector3d displacement;
  long iterations;
  long steps;
};

Outcome outcome(Scene scene, const std::string& method) {
  scene.method.contact = method;
  Simulation simulation(scene);
  REQUIRE(run(simulation, {}).converged);
  return {simulation.system().displacement(1), simulation.state().counters.iterations, simulation.state().counters.steps};
}

StepResult static_step(const Scene& scene) {
  Simulation simulation(scene);
  return simulation.step(1.0, true);
}

}  // namespace

TEST_CASE("shi and soft differ in iterations and answers with the same springs", "[integrator][shi]") {
  Scene scene = test::block_on_incline(30.0 * test::degree);
  test::use_joint_springs_as_penalty(scene);
  scene.joints[0].friction_angle = 20.0 * test::degree;
  scene.end_time = 0.2;
  const Outcome soft = outcome(scene, "soft"), shi = outcome(scene, "shi");
  CHECK(soft.iterations != shi.iterations);
  const double distance = (soft.displacement - shi.displacement).head<2>().norm();
  const double travelled = soft.displacement.head<2>().norm();
  CHECK(travelled > 0.01);
  CHECK(distance > 1e-6 * travelled);
  // Both are the same physics: friction that lags by one pass costs no more than some steps' worth.
  CHECK(distance < 0.1 * travelled);
}

TEST_CASE("shi and soft agree where nothing slides, opens or turns", "[integrator][shi]") {
  Scene scene = test::block_on_base();
  test::use_joint_springs_as_penalty(scene);
  scene.method.start = Start::settled;
  scene.loads = {{1, {1.0, 0.5}, {3000.0, -20000.0}}};
  scene.blocks[1].rotation_locked = true;
  scene.end_time = 0.1;
  scene.blocks[1].velocity = {0.0, -1e-4};
  const Outcome soft = outcome(scene, "soft"), shi = outcome(scene, "shi");
  CHECK((soft.displacement - shi.displacement).norm() < 1e-9 * soft.displacement.norm());
}

TEST_CASE("shi takes ten times the joint's stiffness where no penalty is given", "[integrator][shi]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.method.start = Start::settled;
  scene.end_time = scene.step.dt;
  CHECK(outcome(scene, "shi").displacement[1] == Approx(-test::block_weight / (10.0 * 1e9 * test::block_edge)).epsilon(1e-7));
  scene.method.penalty = 3e8;
  CHECK(outcome(scene, "shi").displacement[1] == Approx(-test::block_weight / (3e8 * test::block_edge)).epsilon(1e-7));
}

TEST_CASE("a penetration beyond the tolerance names both keys that could help", "[integrator][shi]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.method.penetration_tolerance = 1e-6;
  const StepResult result = static_step(scene);
  CHECK_FALSE(result.accepted);
  CHECK_THAT(result.reason, ContainsSubstring("solver.penetration_tolerance_m") && ContainsSubstring("method.penalty_pa_per_m"));
  scene.method.penetration_tolerance = 1e-5;
  CHECK(static_step(scene).accepted);
}

TEST_CASE("shi gives up when its open-close iterations do not settle", "[integrator][shi]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.method.max_open_close_iterations = 1;
  const StepResult result = static_step(scene);
  CHECK_FALSE(result.accepted);
  CHECK(result.reason == "open-close iterations did not settle");
  scene.method.max_open_close_iterations = 6;
  CHECK(static_step(scene).accepted);
}

TEST_CASE("an open contact of shi closes beyond its tolerance only", "[integrator][shi]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.gravity = {0.0, 0.0};
  scene.blocks[1].velocity = {0.0, -1e-6};
  scene.step.dt = 0.1;
  scene.end_time = 0.1;
  scene.method.closing_tolerance = 2e-7;
  CHECK(outcome(scene, "shi").displacement[1] == Approx(-1e-7).epsilon(1e-12));
  scene.method.closing_tolerance = 0.5e-7;
  CHECK(std::abs(outcome(scene, "shi").displacement[1]) < 0.9e-7);
}

TEST_CASE("what contacts of shi may penetrate by default goes with the blocks, not with the model", "[integrator][shi]") {
  // A block a hundred times as large on the same closure over its size.
  const auto steps_on = [](double size, double closure_of_size) {
    Scene scene = test::block_on_base();
    for (BlockInput& block : scene.blocks) {
      for (Vec2& v : block.vertices) v *= size;
    }
    scene.method.contact = "shi";
    scene.step.max_displacement = size;
    const double weight = test::block_weight * size * size;
    scene.method.penalty = weight / (closure_of_size * size * test::block_edge * size);
    return static_step(scene).accepted;
  };
  CHECK(steps_on(1.0, 0.9e-2));
  CHECK_FALSE(steps_on(1.0, 1.5e-2 * std::sqrt(2.0)));
  CHECK(steps_on(100.0, 0.9e-2));
  CHECK_FALSE(steps_on(100.0, 1.5e-2 * std::sqrt(2.0)));
  CHECK(steps_on(0.01, 0.05));  // 0.5 mm
}
