#include <cmath>
#include <limits>

#include "openclose/analysis/run.h"
#include "openclose/analysis/watch.h"
#include "openclose_traps.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::all_methods;

namespace {

/// A simulation that has taken one step under the eyes of a watch.
struct Watched {
  explicit Watched(const Scene& scene) : simulation(scene) {
    prepare_start(simulation);
    REQUIRE(watch.begin(simulation).empty());
    REQUIRE(simulation.advance(scene.step.dt));
    REQUIRE(watch.check(simulation).empty());
  }

  Simulation simulation;
  Watch watch;
};

Scene dropped_block(double height) {
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v.y() += height;
  scene.end_time = 1.0;
  return scene;
}

long checks_of(long steps) {
  long checks = 0;
  for (long step = 1; step <= steps; ++step) checks += Watch::is_due(step) ? 1 : 0;
  return checks;
}

}  // namespace

TEST_CASE("a run has a hundred checks, or one a step", "[analysis][watch]") {
  CHECK(checks_of(7) == 7);
  CHECK(checks_of(128) == 128);
  for (long steps : {100L, 129L, 257L, 1000L, 123456L}) {
    INFO(steps);
    CHECK(checks_of(steps) >= 100);
    CHECK(static_cast<double>(checks_of(steps)) <= 128.0 + 64.0 * std::log2(static_cast<double>(steps) / 128.0 + 1.0) + 1.0);
  }
}

TEST_CASE("right runs are not refused, and the report says how right they are", "[analysis][watch]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = dropped_block(0.3);
    SECTION("dropped, " + method) {
      scene.method.contact = method;
      scene.joints[0].normal_stiffness = 1e7;  // so that most of the energy is in the springs for some hundredths of a second
      if (method == "shi") test::use_joint_springs_as_penalty(scene);
    }
    SECTION("at rest, " + method) {
      scene = test::block_on_incline(0.3);
      scene.method.contact = method;
      scene.method.start = Start::settled;
      scene.end_time = 0.2;
    }
    SECTION("without gravity, " + method) {
      scene.method.contact = method;
      scene.gravity = Vec2::Zero();
    }
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    INFO(result.reason);
    CHECK(result.converged);
    CHECK_FALSE(result.refused);
    CHECK(result.watch.checks >= 100);
    CHECK(result.watch.created_energy <= watch_bound::created_energy);
    CHECK(result.watch.penetration < 0.2);
    CHECK(result.watch.reach < 1.001);
  }
}

TEST_CASE("an undamped bounce of dem keeps the energy that the watch reads", "[analysis][watch]") {
  Scene scene = dropped_block(0.3);
  scene.method.contact = "dem";
  scene.method.step_fraction = 0.5;
  scene.joints[0].normal_stiffness = 1e7;
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  CHECK(result.converged);
  // With kinetic energy and springs half a step apart it would rise and fall by a quarter.
  CHECK(result.watch.created_energy < 2e-3);
  CHECK(result.watch.penetration > 0.02);
}

TEST_CASE("motion from nowhere is found by the energy ledger", "[analysis][watch]") {
  for (const std::string method : {"soft", "hard", "dem"}) {
    INFO(method);
    Scene scene = dropped_block(0.3);
    scene.method.contact = method;
    Watched w(scene);
    for (int i = 0; i < 20; ++i) REQUIRE(w.simulation.advance(scene.step.dt));
    REQUIRE(w.watch.check(w.simulation).empty());
    BlockSystem& system = w.simulation.change_system();
    system.set_velocity(1, 1.02 * system.velocity(1));  // 4 % more kinetic energy
    REQUIRE(w.simulation.advance(scene.step.dt));
    CHECK_THAT(w.watch.check(w.simulation), ContainsSubstring("energy was created") && ContainsSubstring("step.dt_s = "));
    CHECK(w.watch.report().created_energy == Approx(0.04).epsilon(0.25));
  }
}

TEST_CASE("motion from nowhere is found whatever moves elsewhere", "[analysis][watch]") {
  for (const std::string method : {"soft", "hard"}) {
    for (const double gravity : {9.81, 0.0}) {
      CAPTURE(method, gravity);
      Scene scene = dropped_block(3.0);
      scene.gravity = {0.0, -gravity};
      scene.blocks[1].velocity = {0.0, -1.0};
      scene.method.contact = method;
      scene.blocks.push_back(test::free_block("boulder", test::rectangle(100.0, 1e3, 20.0, 10.0)));
      scene.blocks.back().velocity = {30.0, 0.0};
      Watched w(scene);
      for (int i = 0; i < 20; ++i) REQUIRE(w.simulation.advance(scene.step.dt));
      REQUIRE(w.watch.check(w.simulation).empty());
      CHECK(w.watch.report().created_energy < 1e-9);
      BlockSystem& system = w.simulation.change_system();
      system.set_velocity(1, 1.02 * system.velocity(1));  // 4 % more kinetic energy of the block, 1e-4 of all
      REQUIRE(w.simulation.advance(scene.step.dt));
      CHECK(w.watch.warnings(w.simulation).empty());
      REQUIRE(w.watch.check(w.simulation).empty());
      CHECK(w.watch.report().created_energy == Approx(0.04).epsilon(0.25));
      REQUIRE(w.watch.warnings(w.simulation).size() == 1);
      CHECK_THAT(w.watch.warnings(w.simulation)[0],
                 ContainsSubstring("energy was created: ") && ContainsSubstring("J were there to move \"block\", "));
      system.set_velocity(1, 1.05 * system.velocity(1));
      REQUIRE(w.simulation.advance(scene.step.dt));
      CHECK_THAT(w.watch.check(w.simulation), ContainsSubstring("energy was created") && ContainsSubstring("to move \"block\" ("));
    }
  }
}

TEST_CASE("a block that another one strikes has its energy from there", "[analysis][watch]") {
  for (const std::string method : {"soft", "hard"}) {
    INFO(method);
    Scene scene = test::scene_with({test::fixed_block("wall", test::rectangle(-60.0, 0.0, 1.0, 1.0)),
                                    test::free_block("struck", test::rectangle(0.0, 0.0, 1.0, 1.0)),
                                    test::free_block("striking", test::rectangle(3.0, 0.0, 1.0, 1.0)),
                                    test::free_block("alone", test::rectangle(0.0, 60.0, 1.0, 1.0))});  // so that the others are not all
    scene.gravity.setZero();
    scene.blocks[1].velocity = {-0.1, 0.0};  // what has no energy at all is no group by which energy is measured
    scene.blocks[2].velocity = {-5.0, 0.0};
    scene.blocks[3].velocity = {-0.1, 0.0};
    scene.method.contact = method;
    scene.joints[0].normal_stiffness = 1e7;
    scene.end_time = 2.0;
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    REQUIRE(result.converged);
    CHECK(simulation.velocity(1).x() < -1.0);
    CHECK(result.watch.created_energy < watch_bound::created_energy);
  }
}

TEST_CASE("friction that drives what slides is found", "[analysis][watch]") {
  // A square that turns hits the base with one corner; in the second step the open-close iteration leaves it a friction of four times what its spring
  // carries, which pulls it along.
  Scene scene = test::block_on_base();
  scene.gravity.setZero();
  scene.joints[0].friction_angle = 25.0 * test::degree;
  scene.blocks[1].vertices = {{-0.06331088896601456, 0.001},
                              {0.7042668040865855, 0.6419559151205709},
                              {0.06331088896601456, 1.4095336081731709},
                              {-0.7042668040865855, 0.7685776930526}};
  scene.blocks[1].velocity = {-0.4684640182873636, -1.0454886708824054};
  scene.blocks[1].angular_velocity = 3.2651451307831376;
  scene.method.contact = GENERATE("shi", "soft");
  if (scene.method.contact == "soft") scene.method.integrator = "shi";
  scene.end_time = 0.06;
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  std::string said = result.reason;
  for (const std::string& words : result.warnings) said += words;
  INFO(said);
  CHECK((said.find("friction drove what slides by ") != std::string::npos) == (scene.method.contact == "shi"));
  CHECK((said.find("method.contact = \"soft\" would be a remedy") != std::string::npos) == (scene.method.contact == "shi"));
  CHECK(result.converged == (result.watch.created_energy <= watch_bound::created_energy_of_part));
}

TEST_CASE("a block faster than all energy could make it is found without the ledger", "[analysis][watch]") {
  Watched w(dropped_block(0.3));
  const Motion::Unknowns fast(0.0, 5.0, 0.0);
  w.simulation.change_system().set_velocity(1, fast);
  w.simulation.set_velocity(1, fast);
  CHECK_THAT(w.watch.check(w.simulation), ContainsSubstring("block \"block\" moves at 5 m/s"));
}

TEST_CASE("numbers that are none are found", "[analysis][watch]") {
  Watched w(dropped_block(0.3));
  w.simulation.set_velocity(1, Motion::Unknowns::Constant(std::numeric_limits<double>::quiet_NaN()));
  CHECK_THAT(w.watch.check(w.simulation), ContainsSubstring("no finite position or velocity"));
}

TEST_CASE("energies that are no numbers are found, whichever entry of the ledger it is", "[analysis][watch]") {
  const NonStop non_stop;
  const auto ledger_with = [](double EnergyLedger::*entry, double value) {
    Scene scene = dropped_block(0.3);
    Watched w(scene);
    // The steps are the stepper's; what is asked here is what the watch makes of their ledger.
    const_cast<EnergyLedger&>(w.simulation.ledger()).*entry = value;
    return w.watch.check(w.simulation);
  };
  for (double EnergyLedger::*entry : {&EnergyLedger::kinetic, &EnergyLedger::friction, &EnergyLedger::impact, &EnergyLedger::scheme,
                                      &EnergyLedger::redefinition, &EnergyLedger::turnover}) {
    CHECK_THAT(ledger_with(entry, std::numeric_limits<double>::quiet_NaN()), ContainsSubstring("the energies are no finite numbers any more"));
    CHECK_THAT(ledger_with(entry, -std::numeric_limits<double>::infinity()), ContainsSubstring("the energies are no finite numbers any more"));
    CHECK(ledger_with(entry, 0.0).find("finite") == std::string::npos);
  }
}

TEST_CASE("blocks that have passed into each other are found without a contact", "[analysis][watch]") {
  Watched w(dropped_block(0.05));
  for (double depth : {0.1, 0.3}) {
    w.simulation.change_system().move_to(1, {0.0, -0.05 - depth, 0.0});
    CHECK(w.watch.check(w.simulation).empty());  // not yet the turn of this pair
    // The width of the block is 2/3 m.
    const std::string found = w.watch.check_at_end(w.simulation);
    INFO(found);
    CHECK(found.empty() == (depth < 0.25 * 2.0 / 3.0));
    if (!found.empty())
      CHECK_THAT(found,
                 ContainsSubstring("blocks have passed into each other: \"base\" and \"block\" are 0.3 m deep in each other, at most 0.167 m"));
  }
}

TEST_CASE("every pair of blocks is looked at where both are", "[analysis][watch]") {
  Watched w(test::scene_with({test::fixed_block("base", test::rectangle(-10.0, -1.0, 20.0, 1.0)),
                              test::free_block("left", test::rectangle(0.0, 0.0, 1.0, 1.0)),
                              test::free_block("right", test::rectangle(1.0005, 0.0, 1.0, 1.0))}));
  REQUIRE(w.simulation.state().detector.candidate_pairs().size() == 3);
  CHECK(w.watch.check_at_end(w.simulation).empty());
  w.simulation.change_system().move_to(2, {-0.3005, 0.0, 0.0});
  CHECK_THAT(w.watch.check_at_end(w.simulation), ContainsSubstring("\"left\" and \"right\" are 0.3 m deep in each other"));
}

TEST_CASE("springs too soft for their blocks are refused, with the stiffness that would do", "[analysis][watch]") {
  Scene scene = test::block_on_base();
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = 1e5;  // closure of 0.25 m at rest, 0.37 of the width
  scene.end_time = 1.0;
  SECTION("at rest") {
    scene.method.start = Start::settled;
  }
  SECTION("in motion") {}
  Simulation simulation(scene);
  const RunResult result = run(simulation, {});
  CHECK_FALSE(result.converged);
  CHECK(result.refused);
  CHECK(result.ended_by.empty());
  CHECK(result.watch.penetration > watch_bound::penetration);
  CHECK_THAT(result.reason,
             ContainsSubstring("the springs are too soft for these blocks") && ContainsSubstring("joint[0].normal_stiffness_pa_per_m = "));
  const std::size_t at = result.reason.find("per_m = ") + 8;
  scene.joints[0].normal_stiffness = std::stod(result.reason.substr(at));
  Simulation stiffer(scene);
  CHECK(run(stiffer, {}).converged);
}

TEST_CASE("rigid contacts that are loaded at once and not held name a start that serves", "[analysis][watch]") {
  // A weight of 1e6 blocks on a column of ten.
  Scene scene = test::column_of_blocks(11);
  for (std::size_t b = 1; b < scene.blocks.size(); ++b) scene.blocks[b].vertices = test::rectangle(0.0, static_cast<double>(b - 1), 2.0, 1.0);
  scene.materials.push_back(scene.materials[0]);
  scene.materials[1].density *= 1e6;
  scene.blocks.back().material = 1;
  scene.joints.push_back(scene.joints[0]);
  scene.joints[1].materials = {0, 1};
  scene.method.contact = "hard";
  scene.end_time = 0.02;
  {
    Simulation simulation(scene);
    const RunResult result = run(simulation, {});
    CHECK(result.refused);
    CHECK_THAT(result.reason, ContainsSubstring("method.start = \"settled\" would be a remedy if the blocks rest at first"));
    CHECK_THAT(result.reason, !ContainsSubstring("step.dt_s"));  // halved again and again, it is refused as well
  }
  scene.method.start = Start::settled;
  Simulation simulation(scene);
  CHECK(run(simulation, {}).converged);
}

TEST_CASE("with rigid contacts the watch looks after every step", "[analysis][watch]") {
  constexpr long some_step = 1000001;  // between the checks of other methods
  Scene scene = test::block_on_base();
  for (const std::string method : {"soft", "hard"}) {
    scene.method.contact = method;
    const Simulation simulation(scene);
    CHECK(Watch().is_due(simulation, some_step) == (method == "hard"));
  }
}

TEST_CASE("what has moved since it was looked at is looked at again", "[analysis][watch]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "hard";
  scene.method.start = Start::settled;
  Watched w(scene);
  for (int i = 0; i < 10; ++i) {
    REQUIRE(w.simulation.advance(scene.step.dt));
    REQUIRE(w.watch.check(w.simulation).empty());
  }
  REQUIRE(w.simulation.state().counters.still > 3);
  SECTION("by a step") {
    // As steps do: of all others it would be told. While none is counted, nothing can have moved.
    const_cast<BlockSystem&>(w.simulation.system()).move_to(1, {0.0, -0.01, 0.0});
    CHECK(w.watch.check(w.simulation).empty());
    ++const_cast<StepCounters&>(w.simulation.state().counters).steps;
  }
  SECTION("otherwise") {
    w.simulation.change_system().move_to(1, {0.0, -0.01, 0.0});
  }
  CHECK_THAT(w.watch.check(w.simulation), ContainsSubstring("blocks have passed into each other"));
}
