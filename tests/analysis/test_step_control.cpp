#include <cmath>

#include "openclose/analysis/simulation.h"
#include "openclose/analysis/step_control.h"
#include "openclose/geometry/polygon.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

TEST_CASE("step control: the longest step first, then what the error allows", "[analysis][step_control]") {
  StepControl control(1e-4);
  CHECK(control.step(0.1) == 0.1);
  control.refused(0.1, 8e-4);
  CHECK(control.step(0.1) == Approx(0.1 * std::cbrt(1.0 / 16.0)));
  control.accepted(0.039, 1e-5);
  CHECK(control.step(0.1) > 0.039);
  CHECK(control.step(0.02) == 0.02);
}

TEST_CASE("step control: finds the step that has half the error asked for", "[analysis][step_control]") {
  StepControl control(1e-4);
  for (int i = 0; i < 40; ++i) {
    const double dt = control.step(1.0), error = 3.0 * dt * dt * dt;
    if (error > control.tolerance()) {
      control.refused(dt, error);
    } else {
      control.accepted(dt, error);
    }
  }
  const double dt = control.step(1.0);
  CHECK(3.0 * dt * dt * dt > 0.3e-4);
  CHECK(3.0 * dt * dt * dt < 1e-4);
}

TEST_CASE("step control: a step cut short by an output time does not shorten the next", "[analysis][step_control]") {
  StepControl control(1e-4);
  control.accepted(0.1, 0.5e-4);
  const double meant = control.step(1.0);
  control.accepted(1e-6, 1e-12);
  CHECK(control.step(1.0) >= meant);
}

TEST_CASE("adaptive steps: the error goes with the tolerance, and falls are taken in long steps", "[analysis][step_control]") {
  Scene scene = test::block_on_base();
  scene.method.integrator = "path_average";
  scene.step.dt = 0.05;
  scene.step.adaptive = true;
  scene.gravity = {0.0, -9.81};
  // Dropped, so that it bounces; the reference has steps far below the period of the contacts.
  const auto height = [&](double tolerance, bool adaptive, double dt, long* steps) {
    Scene trial = scene;
    trial.step.error_tolerance = tolerance;
    trial.step.adaptive = adaptive;
    Simulation simulation(trial);
    simulation.change_system().advance(1, {0.0, 0.05, 0.0});
    simulation.positions_changed();
    simulation.restart_clock();
    for (int i = 0; i < std::lround(0.4 / dt); ++i) REQUIRE(simulation.advance(dt));
    if (steps) *steps = simulation.state().counters.steps;
    return simulation.system().centroid(1).y();
  };
  const double exact = height(1.0, false, 1e-5, nullptr);
  long coarse_steps = 0, fine_steps = 0;
  const double coarse = std::abs(height(1e-6, true, 0.05, &coarse_steps) - exact);
  const double fine = std::abs(height(1e-8, true, 0.05, &fine_steps) - exact);
  CHECK(fine < 0.3 * coarse);
  CHECK(fine < 2e-4);
  CHECK(fine_steps < 4000);
  CHECK(coarse_steps < fine_steps);
}

TEST_CASE("adaptive steps: a support alone has an error, too", "[analysis][step_control]") {
  // A block that swings on a spring, w = 20/s, and touches nothing: x = (v/w) sin(w t). Every step is off by the tolerance at most.
  Scene scene = test::block_on_base();
  scene.method.integrator = "path_average";
  scene.gravity = {0.0, 0.0};
  scene.step.dt = 0.05;
  scene.step.adaptive = true;
  scene.step.error_tolerance = 1e-6;
  scene.blocks.erase(scene.blocks.begin());
  const Vec2 centre = polygon_properties(scene.blocks[0].vertices).centroid;
  const double w = 20.0, speed = 0.5;
  const double stiffness = w * w * scene.materials[0].density * std::abs(signed_area(scene.blocks[0].vertices));
  scene.blocks[0].velocity = {speed, 0.0};
  scene.supports = {{0, centre, {stiffness, stiffness}}};
  Simulation simulation(scene);
  for (int i = 0; i < 20; ++i) REQUIRE(simulation.advance(0.05));
  const auto steps = static_cast<double>(simulation.state().counters.steps);
  CHECK(std::abs(simulation.system().displacement(0).x() - speed / w * std::sin(w)) < steps * scene.step.error_tolerance);
  CHECK(steps > 20);
}

TEST_CASE("adaptive steps are for soft", "[analysis][step_control]") {
  Scene scene = test::block_on_base();
  scene.step.adaptive = true;
  scene.step.adaptive_where = {"scene.toml", 7};
  for (const char* contact : {"hard", "shi", "dem"}) {
    scene.method.contact = contact;
    CHECK_THROWS_AS(Simulation(scene), InputError);
    CHECK_THROWS_WITH(Simulation(scene), Catch::Matchers::ContainsSubstring("scene.toml:7: step.adaptive: true has no meaning"));
  }
}
