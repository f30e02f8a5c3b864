#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/analysis/settle.h"
#include "openclose/analysis/simulation.h"
#include "openclose/core/error.h"
#include "openclose/core/tolerance.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::all_methods;

namespace {

void append(std::vector<double>& list, const Contact& c) {
  list.insert(list.end(),
              {static_cast<double>(c.vertex), static_cast<double>(c.edge), c.length, c.gap, static_cast<double>(c.status),
               static_cast<double>(c.joint_state.bonded), c.joint_state.slip, c.elastic_slip, c.normal_force, c.shear_force, c.stored_energy});
}

void append(std::vector<double>& list, const EnergyLedger& l) {
  list.insert(list.end(), {l.kinetic, l.gravity, l.base_motion, l.contact_springs, l.support_springs, l.loads, l.friction, l.contact_damping,
                           l.mass_damping, l.impact, l.scheme, l.redefinition, l.turnover});
}

/// Everything that a step may change, as numbers to be compared bit for bit.
std::vector<double> everything(Simulation& simulation) {
  std::vector<double> list{simulation.time(), simulation.max_penetration(), static_cast<double>(simulation.state().counters.steps)};
  for (const Contact& c : simulation.change_contacts()) append(list, c);
  append(list, simulation.ledger());
  const auto& state = simulation.system().state();
  for (const auto& d : state.displacement) list.insert(list.end(), d.begin(), d.end());
  for (const auto& v : state.velocity) list.insert(list.end(), v.begin(), v.end());
  for (const auto& a : state.arm) list.insert(list.end(), a.begin(), a.end());
  for (const auto& a : state.point_arm) list.insert(list.end(), a.begin(), a.end());
  for (int b = 0; b < simulation.system().block_count(); ++b) {
    const auto v = simulation.velocity(b);
    list.insert(list.end(), v.begin(), v.end());
  }
  return list;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

Scene tumbling(const std::string& method) {
  Scene scene = test::tumbling_blocks();
  scene.method.contact = method;
  scene.step.dt = 2e-3;
  if (method == "shi") test::use_joint_springs_as_penalty(scene);
  return scene;
}

/// States after each of n advances.
std::vector<std::vector<double>> trajectory(const Scene& scene, int n, int blocks) {
  Simulation simulation(scene);
  std::vector<std::vector<double>> states;
  for (int i = 0; i < n; ++i) {
    REQUIRE(simulation.advance(scene.step.dt));
    std::vector<double> state;
    for (int b = 0; b < blocks; ++b) {
      const auto d = simulation.system().displacement(b), v = simulation.velocity(b);
      state.insert(state.end(), d.begin(), d.end());
      state.insert(state.end(), v.begin(), v.end());
    }
    states.push_back(state);
  }
  return states;
}

/// First step at which two trajectories differ in any bit, or -1.
int first_difference(const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!same_bits(a[i], b.at(i))) return static_cast<int>(i);
  }
  return -1;
}

/// Four steps of each.
void advance_both(Simulation& a, Simulation& b) {
  for (int i = 0; i < 4; ++i) {
    for (Simulation* simulation : {&a, &b}) REQUIRE(simulation->advance(simulation->scene().step.dt));
  }
}

}  // namespace

TEST_CASE("a step that fails leaves no trace", "[analysis][simulation]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = tumbling(method);
    scene.method.skip_factorisation = false;  // what a factor keeps may come from a step that failed
    scene.blocks.push_back(test::free_block("falling", test::rectangle(50.0, 1000.0, 1.0, 1.0)));
    Simulation simulation(scene);
    for (int i = 0; i < 120; ++i) REQUIRE(simulation.advance(2e-3));
    REQUIRE(simulation.ledger().contact_springs + simulation.ledger().impact != 0.0);
    const std::vector<double> before = everything(simulation);
    const long cuts = simulation.state().counters.cuts;

    // Far too long: whether the collisions do not converge or the falling block goes beyond step.max_displacement_m.
    const StepResult result = simulation.step(5.0, false);
    CHECK_FALSE(result.accepted);
    CHECK_FALSE(result.reason.empty());
    CHECK(same_bits(everything(simulation), before));
    CHECK(simulation.state().counters.cuts == cuts + 1);

    // What follows does not know of it either.
    Simulation other(scene);
    for (int i = 0; i < 120; ++i) REQUIRE(other.advance(2e-3));
    everything(other);  // asks for references through which one could change it: the explicit loop takes the state over anew
    for (int i = 0; i < 20; ++i) {
      REQUIRE(simulation.advance(2e-3));
      REQUIRE(other.advance(2e-3));
    }
    CHECK(same_bits(everything(simulation), everything(other)));
  }
}

TEST_CASE("a step that does not converge leaves no trace", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = test::block_on_base();
    scene.method.contact = method;
    scene.method.max_iterations = 1;
    scene.method.max_open_close_iterations = 1;
    scene.loads = {{1, {0.5, 1.0}, {1e4, 0.0}}};
    Simulation simulation(scene);
    const std::vector<double> before = everything(simulation);
    const StepResult result = simulation.step(1.0, true);
    CHECK_FALSE(result.accepted);
    CHECK_THAT(result.reason, ContainsSubstring("converge") || ContainsSubstring("settle"));
    CHECK(same_bits(everything(simulation), before));
  }
}

TEST_CASE("no step moves a vertex farther than allowed", "[analysis][simulation]") {
  Scene scene = test::falling_block();
  scene.step.max_displacement = 0.01;
  SECTION("by translation") {
    scene.blocks[0].velocity = {3.0, 0.0};
  }
  SECTION("by rotation: the corners are 1.118 m from the centroid") {
    scene.gravity = {0.0, 0.0};
    scene.blocks[0].angular_velocity = 3.0;
  }
  Simulation simulation(scene);
  const StepResult far = simulation.step(0.01, false);
  CHECK_FALSE(far.accepted);
  CHECK_THAT(far.reason, ContainsSubstring("step.max_displacement_m"));
  CHECK(simulation.step(0.0029, false).accepted);
}

TEST_CASE("no step turns a block that is in contact farther than its contacts know, one in the air as far as it likes", "[analysis][simulation]") {
  const double height = GENERATE(0.0, 5.0), angle = GENERATE(0.8, 1.2) * tolerance::parallel_none_rad;
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v.y() += height;
  scene.blocks[1].angular_velocity = angle / scene.step.dt;
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = 1.0;  // too soft to slow it down
  scene.step.max_displacement = 100.0;
  Simulation simulation(scene);
  const StepResult result = simulation.step(scene.step.dt, false);
  const bool allowed = height > 0.0 || angle < tolerance::parallel_none_rad;
  CHECK(result.accepted == allowed);
  if (!allowed) CHECK_THAT(result.reason, ContainsSubstring("turned by more than 15 degrees"));
}

TEST_CASE("advance covers its time exactly when steps are cut", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = test::falling_block();
    scene.method.contact = method;
    scene.step.max_displacement = 0.05;
    scene.blocks[0].velocity = {1.0, 2.0};
    const Vec2 v0 = scene.blocks[0].velocity;
    Simulation simulation(scene);
    double t = 0.0;
    for (int i = 0; i < 5; ++i) {
      REQUIRE(simulation.advance(0.1));
      t += 0.1;
      CHECK(simulation.time() == Approx(t).epsilon(1e-14));
      const Vec2 moved = simulation.system().displacement(0).head<2>(), velocity = simulation.velocity(0).head<2>();
      CHECK((moved - (v0 * t + 0.5 * t * t * scene.gravity)).norm() < 1e-12);
      CHECK((velocity - (v0 + t * scene.gravity)).norm() < 1e-12);
    }
    CHECK(simulation.state().counters.cuts > 0);
    CHECK(simulation.state().counters.steps > 5);
  }
}

TEST_CASE("a step that would go too far is divided into equal parts", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard"}) {
    INFO(method);
    Scene scene = test::column_of_blocks(4);
    scene.method.contact = method;
    scene.blocks[4].velocity = {0.4, 0.0};
    scene.step.max_displacement = 4e-3;
    Simulation divided(scene), halves(scene);
    for (Simulation* simulation : {&divided, &halves}) REQUIRE(simulation->advance(1e-3));  // to know the speed
    REQUIRE(divided.advance(0.013));
    for (int i = 0; i < 2; ++i) REQUIRE(halves.advance(0.0065));
    CHECK(divided.state().counters.steps == 3);
    CHECK(divided.state().counters.cuts == 0);
    CHECK(divided.system().displacement(4) == halves.system().displacement(4));
    CHECK(divided.system().displacement(4).x() > 4e-3);
  }
}

TEST_CASE("advance gives up when cutting does not help and says why", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  scene.method.contact = "shi";
  scene.method.max_open_close_iterations = 1;
  scene.method.closing_tolerance = 0.0;
  scene.blocks[1].velocity = {0.0, -1.0};
  Simulation simulation(scene);
  CHECK_FALSE(simulation.advance(0.01));
  CHECK(simulation.reason() == "open-close iterations did not settle");
  CHECK(simulation.time() == 0.0);
  CHECK(simulation.system().displacement(1).isZero(0.0));
}

TEST_CASE("skipping searches changes nothing", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = tumbling(method);
    scene.method.skip_narrow_phase = false;
    const auto skipping = trajectory(scene, 250, 4);
    scene.method.skip_search = false;
    CHECK(first_difference(skipping, trajectory(scene, 250, 4)) == -1);
  }
  Simulation simulation(tumbling("soft"));
  for (int i = 0; i < 250; ++i) REQUIRE(simulation.advance(2e-3));
  CHECK(simulation.state().detector.counters().searches_skipped > 100);
  CHECK(simulation.state().detector.counters().searches > 2);
}

TEST_CASE("iterating only where forces are far from balance changes no more than the tolerance of the iteration", "[analysis][simulation]") {
  // Unbalanced forces of 1e-12 of the largest, about 1e8 N from impacts of 3 m/s, on contacts of 4e8 N/m: 1e-12 m in each of a few steps.
  constexpr double largest_difference = 1e-10;  // [m]
  for (const std::string method : {"soft", "hard"}) {
    INFO(method);
    Scene scene = test::struck_wall();
    scene.method.contact = method;
    // A blow that never makes hard take softer springs, which it would do wherever an iteration gets lost, be it in only one of the two ways.
    if (method == "hard") {
      for (BlockInput& block : scene.blocks) block.velocity *= 0.03;
    }
    scene.method.skip_balanced = false;
    Simulation all(scene);
    scene.method.skip_balanced = true;
    Simulation skipping(scene);
    advance_both(all, skipping);
    double difference = 0.0;
    for (int b = 0; b < all.system().block_count(); ++b) {
      difference = std::max(difference, (all.system().state().displacement[b] - skipping.system().state().displacement[b]).lpNorm<Eigen::Infinity>());
    }
    CHECK(difference < largest_difference);
    CHECK(all.state().counters.parts == 0);
    CHECK(skipping.state().counters.parts > 0);
    CHECK(skipping.state().counters.part_iterations >= skipping.state().counters.parts);
    CHECK(skipping.state().counters.part_rows >= skipping.state().counters.part_iterations);
    CHECK(skipping.state().counters.iterations < all.state().counters.iterations);
  }
}

TEST_CASE("steps in which nothing happens are counted without being solved and leave every bit as it is", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard"}) {
    INFO(method);
    Scene scene = test::column_of_blocks(4);
    scene.method.contact = method;
    scene.method.start = Start::settled;
    Simulation counted(scene);
    scene.method.skip_still_steps = false;
    Simulation solved(scene);
    for (Simulation* s : {&counted, &solved}) REQUIRE(prepare_start(*s).converged);
    const auto go_on = [&] {
      for (int i = 0; i < 100; ++i) {
        REQUIRE(counted.advance(scene.step.dt));
        REQUIRE(solved.advance(scene.step.dt));
      }
    };
    go_on();
    const long still = counted.state().counters.still;
    CHECK(still > 50);
    CHECK(solved.state().counters.still == 0);
    CHECK(same_bits(everything(counted), everything(solved)));
    // Who is pushed is no longer still.
    const Motion::Unknowns push(0.5, 0.0, 0.0);
    for (Simulation* s : {&counted, &solved}) {
      s->set_velocity(4, push);
      s->restart_clock();
    }
    go_on();
    CHECK(same_bits(everything(counted), everything(solved)));
    CHECK(counted.system().displacement(4).x() > 1e-3);
  }
}

TEST_CASE("a base that moves after a rest is felt", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  BaseMotionInput shake;
  shake.pulses = {{0.1, 0.09, {8.0, 0.0}}};
  scene.base_motion = shake;
  scene.method.start = Start::settled;
  Simulation simulation(scene);
  REQUIRE(prepare_start(simulation).converged);
  for (int i = 0; i < 190; ++i) REQUIRE(simulation.advance(scene.step.dt));
  CHECK(simulation.state().counters.still == 0);
  CHECK(std::abs(simulation.system().displacement(1).x()) > 1e-3);
}

TEST_CASE("a block without gravity keeps the smallest velocity", "[analysis][simulation]") {
  Scene scene = test::falling_block();
  scene.gravity.setZero();
  scene.blocks[0].velocity = {1e-15, 0.0};
  Simulation simulation(scene);
  for (int i = 0; i < 10; ++i) REQUIRE(simulation.advance(scene.step.dt));
  CHECK(simulation.system().displacement(0).x() == Approx(1e-15 * simulation.time()).epsilon(1e-12));
}

TEST_CASE("steps that begin before its time are the first integrator's, the others start from where it has got to", "[analysis][simulation]") {
  constexpr int at_first = 60;
  Scene scene = tumbling("soft");
  scene.method.integrator = "path_average";
  Simulation expected(scene);
  scene.method.first_integrator = "path_average";
  scene.method.first_integrator_time = at_first * scene.step.dt;
  scene.method.integrator = "tr_bdf2";
  Simulation changing(scene);
  const auto advance_as_expected = [&] {
    REQUIRE(expected.advance(scene.step.dt));
    REQUIRE(changing.advance(scene.step.dt));
    CHECK(changing.system().state().displacement == expected.system().state().displacement);
  };
  for (int i = 0; i < at_first; ++i) advance_as_expected();
  MethodInput last = scene.method;
  last.first_integrator.reset();
  expected.change_method(last);
  for (int i = 0; i < at_first; ++i) advance_as_expected();
  CHECK(std::abs(changing.ledger().imbalance()) < 1e-9 * changing.ledger().turnover);
}

TEST_CASE("skipping the symbolic part of factorisations changes no bit", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = tumbling(method);
    scene.method.skip_factorisation = false;  // rows are kept for as long as the pattern
    const auto skipping = trajectory(scene, 250, 4);
    scene.method.skip_symbolic = false;
    CHECK(first_difference(skipping, trajectory(scene, 250, 4)) == -1);
    for (const bool skips : {true, false}) {
      scene.method.skip_symbolic = skips;
      Simulation simulation(scene);
      for (int i = 0; i < 50; ++i) REQUIRE(simulation.advance(2e-3));
      const LinearCounters& counters = simulation.enforcement().linear_counters();
      CHECK((counters.symbolic_skipped > 0) == skips);
      CHECK(counters.symbolic + counters.symbolic_skipped == counters.factorisations);
    }
  }
}

TEST_CASE("leaving contacts as they are changes nothing while lengths stay", "[analysis][simulation]") {
  for (const std::string& method : all_methods) {
    INFO(method);
    Scene scene = test::empty_scene();
    scene.blocks = {test::fixed_block("base", test::rectangle(-5.0, -1.0, 20.0, 1.0)),
                    test::free_block("block", test::rectangle(0.0, 0.0, 2.0, 1.0))};
    scene.blocks[1].velocity = {2.0, 0.0};
    scene.method.contact = method;
    std::array<double, 2> way{};
    for (const bool skips : {true, false}) {
      scene.method.skip_narrow_phase = skips;
      Simulation simulation(scene);
      for (int i = 0; i < 500; ++i) REQUIRE(simulation.advance(1e-4));
      way[skips ? 1 : 0] = simulation.system().displacement(1).x();
      CHECK((simulation.state().detector.counters().narrow_phases_skipped > 100) == (skips && simulation.enforcement().follows_gaps()));
    }
    CHECK(way[0] > 0.05);
    // Rounding of gaps of 1e-16 m, times what springs of 1e9 Pa/m make of it in 0.05 s.
    CHECK(way[1] == Approx(way[0]).margin(1e-9));
  }
}

TEST_CASE("contacts are found anew after as much motion as the scene says", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  scene.blocks[1].velocity = {2.0, 0.0};
  scene.method.contact = GENERATE("soft", "dem");
  struct Renewals {
    long of_pairs, of_lists;
    double way;  // [m]
  };
  const auto renewals = [&](double skin) {
    scene.method.contact_skin = skin;
    Simulation simulation(scene);
    for (int i = 0; i < 500; ++i) REQUIRE(simulation.advance(1e-4));
    const DetectionCounters counters = simulation.state().detector.counters();
    return Renewals{counters.narrow_phases, counters.searches + counters.searches_skipped, simulation.system().displacement(1).x()};
  };
  const Renewals often = renewals(1e-3), seldom = renewals(1e-2);
  // 0.1 m: about one renewal a skin, or two, as dem asks for both a way of all blocks and that of the pair, and the first.
  CHECK(static_cast<double>(often.of_pairs) >= 0.4 * often.way / 1e-3);
  CHECK(static_cast<double>(seldom.of_pairs) <= seldom.way / 1e-2 + 2.0);
  // dem counts the way of the fastest block twice, since two may meet, and asks again after half a skin at the least; the others ask in every step.
  if (scene.method.contact == "dem") CHECK(static_cast<double>(seldom.of_lists) <= 4.0 * seldom.way / 1e-2 + 2.0);
  CHECK(seldom.way == Approx(often.way).margin(1e-9));  // lengths stay; see above
}

TEST_CASE("contacts of small blocks are found anew after as much less motion, and nearer by", "[analysis][simulation]") {
  std::vector<BlockInput> blocks{test::fixed_block("base", test::rectangle(-9.0, -9.0, 18.0, 9.0)),
                                 test::free_block("block", test::rectangle(0.0, 0.0, 2.0, 0.5))};
  const auto check = [&](double contact_skin, double search_skin, double longest_displacement) {
    const LengthsOfBlocks lengths(blocks);
    CHECK(lengths.contact_skin == Approx(contact_skin));
    CHECK(lengths.search_skin == Approx(search_skin));
    CHECK(lengths.longest_displacement == Approx(longest_displacement));
  };
  check(tolerance::contact_skin_m, tolerance::search_skin_m, tolerance::longest_displacement_m);
  blocks[1].vertices = test::rectangle(0.0, 0.0, 0.2, 0.05);
  check(tolerance::contact_skin_of_size * 0.1, tolerance::search_skin_of_size * 0.1, tolerance::longest_displacement_of_size * 0.1);
  blocks[1].vertices = test::rectangle(0.0, 0.0, 20.0, 5.0);
  check(tolerance::contact_skin_m, tolerance::search_skin_m, tolerance::longest_displacement_m);
}

TEST_CASE("a model does not care whether its blocks are decimetres or centimetres", "[analysis][simulation]") {
  // Two rows of bricks; their lengths, and with them their candidates and contacts, go with their size.
  const auto counts = [](double size) {
    std::vector<BlockInput> blocks{test::fixed_block("base", test::rectangle(-size, -size, 22.0 * size, size))};
    for (int i = 0; i < 20; ++i)
      blocks.push_back(test::free_block(std::to_string(i), test::rectangle(2.0 * size * (i % 10), size * (i / 10), 2.0 * size, size)));
    Simulation simulation(test::scene_with(blocks));
    simulation.change_contacts();
    return std::pair(simulation.state().detector.candidate_pairs().size(), simulation.contacts().size());
  };
  CHECK(counts(0.01) == counts(0.1));
}

TEST_CASE("the velocity that a step ends with is none of an impact that is over", "[analysis][simulation]") {
  // A block falls flat on a base at 1 m/s, without gravity, and may come back at the same speed at most.
  const std::string method = GENERATE("dem", "hard");
  const double height = GENERATE(0.0101, 0.0123, 0.0142, 0.0179);
  Scene scene = test::block_on_base();
  scene.gravity = Vec2::Zero();
  for (Vec2& v : scene.blocks[1].vertices) v += Vec2(0.0, height);
  scene.blocks[1].velocity = {0.0, -1.0};
  scene.method.contact = method;
  Simulation simulation(scene);
  double fastest = 0.0, slowest = 1.0;
  for (int i = 0; i < 400; ++i) {
    REQUIRE(simulation.step(method == "dem" ? std::min(0.5 * simulation.explicit_stepper()->critical_step(), 1e-3) : 1e-3, false).accepted);
    fastest = std::max(fastest, simulation.velocity(1).norm());
    slowest = std::min(slowest, simulation.velocity(1).norm());
  }
  CHECK(slowest < 0.9);   // it has been there
  CHECK(fastest < 1.01);  // what a spring at its longest step makes of half a step's force
  if (method == "hard") CHECK(simulation.velocity(1).norm() < 1e-6);
}

TEST_CASE("a blow that a contact passes on is over at the end of its step, too", "[analysis][simulation]") {
  // A beam on two supports with a block on it is hit from below: the joint under the block carries the blow although it was closed before.
  Scene scene = test::empty_scene();
  const double speed = 5.0;
  scene.blocks = {test::fixed_block("left", test::rectangle(-3.0, -1.0, 2.0, 1.0)), test::fixed_block("right", test::rectangle(1.0, -1.0, 2.0, 1.0)),
                  test::free_block("beam", test::rectangle(-2.0, 0.0, 4.0, 1.0)), test::free_block("above", test::rectangle(-0.5, 1.0, 1.0, 1.0)),
                  test::free_block("below", test::rectangle(-0.5, -1.2, 1.0, 1.0))};
  scene.blocks[4].velocity = {0.0, speed};
  scene.method.contact = "hard";
  scene.method.start = Start::unloaded;
  Simulation simulation(scene);
  prepare_start(simulation);
  double fastest = 0.0;
  while (simulation.time() < 0.1) {
    REQUIRE(simulation.advance(1e-3));
    fastest = std::max(fastest, simulation.velocity(3)[1]);
  }
  const double together = speed / 6.0;  // one sixth of the mass has brought the momentum, less what gravity takes from it
  CHECK(fastest < 1.001 * together);
  CHECK(fastest > 0.9 * together);
}

TEST_CASE("a blow that lasts for two steps leaves no trace in the velocities that are told", "[analysis][simulation]") {
  // A polygon that turns hits a wall and goes on hitting it in the next step, harder: what is told of it then must not lack energy that comes back.
  Scene scene = test::empty_scene();
  scene.joints[0].friction_angle = 40.3 * test::degree;
  scene.blocks = {
      test::fixed_block("floor", test::rectangle(-9.6, -0.3, 19.2, 0.3)), test::fixed_block("left", test::rectangle(-9.6, 0.0, 0.282859272, 21.0)),
      test::free_block(
          "thrown",
          {{-2.26243619, 5.71366334}, {0.529662589, 3.33936951}, {2.09396977, 2.97093878}, {1.26235958, 3.77561692}, {-0.351152982, 4.98253934}})};
  scene.blocks[2].velocity = {-25.096026, -16.954147};
  scene.blocks[2].angular_velocity = 6.616926738;
  scene.method.contact = "hard";
  Simulation simulation(scene);
  prepare_start(simulation);
  const auto energy = [&] {
    const auto& block = simulation.system().block(2);
    const auto v = simulation.velocity(2);
    return 0.5 * block.mass.dot(v.cwiseAbs2()) + block.mass[0] * 9.81 * simulation.system().displacement(2)[1];
  };
  const double start = energy();
  double least = start;
  while (simulation.time() < 0.2) {
    REQUIRE(simulation.advance(0.003482));
    CHECK(energy() < least + 1e-3 * start);
    least = std::min(least, energy());
  }
  CHECK(least < 0.6 * start);  // it has hit
}

TEST_CASE("a block far away is not felt", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = tumbling(method);
    const auto alone = trajectory(scene, 250, 4);
    scene.blocks.push_back(test::fixed_block("far", test::rectangle(1000.0, 50.0, 0.3, 0.3)));
    CHECK(first_difference(alone, trajectory(scene, 250, 4)) == -1);
    // A free one takes part in the linear solve, whose sums are then rounded in another order; collisions magnify that.
    scene.blocks.back().fixed = false;
    const auto together = trajectory(scene, 250, 4);
    for (std::size_t k = 0; k < alone.back().size(); ++k) CHECK(alone.back()[k] == Approx(together.back()[k]).margin(1e-9));
  }
}

TEST_CASE("saving and restoring repeats a trajectory", "[analysis][simulation]") {
  for (const std::string method : {"soft", "shi"}) {
    INFO(method);
    Simulation simulation(tumbling(method));
    for (int i = 0; i < 150; ++i) REQUIRE(simulation.advance(2e-3));
    const auto snapshot = simulation.save();
    for (int i = 0; i < 50; ++i) REQUIRE(simulation.advance(2e-3));
    const auto first = simulation.system().state();
    simulation.restore(snapshot);
    CHECK(simulation.system().state().displacement == snapshot.blocks.displacement);
    for (int i = 0; i < 50; ++i) REQUIRE(simulation.advance(2e-3));
    CHECK(simulation.system().state().displacement == first.displacement);
    CHECK(simulation.system().state().velocity == first.velocity);
  }
}

TEST_CASE("a restored state is followed with the step that is asked for, not with that of the motion before", "[analysis][simulation]") {
  Scene scene = test::falling_block();
  scene.step.max_displacement = 0.1;
  Simulation simulation(scene);
  const auto at_rest = simulation.save();
  REQUIRE(simulation.advance(1.0));
  // Now at 9.8 m/s, which allows 0.01 s; from rest it is 0.14 s.
  simulation.restore(at_rest);
  const long before = simulation.state().counters.steps;
  REQUIRE(simulation.advance(0.1));
  CHECK(simulation.state().counters.steps == before + 1);
}

TEST_CASE("after a change of the method the motion is that of its time scheme", "[analysis][simulation]") {
  Scene scene = test::falling_block();
  scene.method.integrator = "shi";
  MethodInput of_two_stages = scene.method;
  of_two_stages.integrator = "tr_bdf2";
  Simulation simulation(scene);
  REQUIRE(simulation.advance(1e-2));
  CHECK(simulation.state().counters.steps == 1);
  simulation.change_method(of_two_stages);
  REQUIRE(simulation.advance(1e-2));
  CHECK(simulation.state().counters.steps == 1 + 2);
}

TEST_CASE("the way to an equilibrium is the same without books, which begin with the clock", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = tumbling(method);
    Simulation booked(scene), unbooked(scene);
    unbooked.solved_stepper().book_steps(false);
    for (Simulation* s : {&booked, &unbooked}) REQUIRE(settle(*s).settled);
    CHECK(booked.ledger().turnover > 0.0);
    CHECK(unbooked.ledger().turnover == 0.0);
    for (Simulation* s : {&booked, &unbooked}) {
      s->set_velocity(3, {0.1, 0.0, 0.0});
      s->restart_clock();
      for (int i = 0; i < 20; ++i) REQUIRE(s->advance(2e-3));
    }
    CHECK(unbooked.ledger().turnover > 0.0);
    CHECK(same_bits(everything(unbooked), everything(booked)));
  }
}

TEST_CASE("restarting the clock empties the books and nothing else", "[analysis][simulation]") {
  Simulation simulation(tumbling("soft"));
  for (int i = 0; i < 200; ++i) REQUIRE(simulation.advance(2e-3));
  const auto state = simulation.system().state();
  std::vector<double> contacts, after;
  for (const Contact& c : simulation.change_contacts()) append(contacts, c);
  REQUIRE(simulation.max_penetration() > 0.0);

  simulation.restart_clock();
  CHECK(simulation.time() == 0.0);
  CHECK(simulation.max_penetration() == 0.0);
  CHECK(simulation.ledger().turnover == 0.0);
  CHECK(simulation.ledger().imbalance() == 0.0);
  CHECK(simulation.system().state().displacement == state.displacement);
  CHECK(simulation.system().state().velocity == state.velocity);
  for (const Contact& c : simulation.change_contacts()) append(after, c);
  CHECK(same_bits(contacts, after));
}

TEST_CASE("an account of the memory, by what has it", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi", "dem"}) {
    INFO(method);
    Simulation few(tumbling(method));
    CHECK(few.state().memory.without_factor() == 0);  // nothing yet
    REQUIRE(few.advance(2e-3));
    const Memory of = few.state().memory;
    CHECK(of.blocks > few.system().block_count() * (sizeof(BlockSystem::Block) + sizeof(BlockInput)));
    CHECK(of.contacts > few.change_contacts().size() * (sizeof(Contact) + 100));
    CHECK((of.matrix > 0) == (method != "dem"));
    CHECK((of.factor > of.matrix) == (method != "dem"));
    CHECK(of.krylov == 0);
    // What is in the scene and in the system is in the account, to the byte.
    Scene named = tumbling(method);
    constexpr std::size_t letters = 1000, points = 512;
    for (BlockInput& block : named.blocks) block.name = std::string(letters, 'b');
    Simulation same(named);
    const std::size_t before = same.system().bytes();
    for (std::size_t i = 0; i < points; ++i) same.change_system().follow_point(1, named.blocks[1].vertices[0]);
    const std::size_t of_points = same.system().bytes() - before;
    CHECK(of_points >= points * sizeof(Vec2));
    REQUIRE(same.advance(2e-3));
    std::size_t of_names = 0;
    for (std::size_t b = 0; b < named.blocks.size(); ++b) of_names += named.blocks[b].name.size() - tumbling(method).blocks[b].name.capacity();
    CHECK(same.state().memory.blocks == of.blocks + of_points + of_names);
    // Twice the scene, far from the first, has twice of everything but for the spare room of lists.
    Scene scene = tumbling(method);
    for (BlockInput block : tumbling(method).blocks) {
      for (Vec2& vertex : block.vertices) vertex.x() += 1000.0;
      scene.blocks.push_back(block);
    }
    Simulation many(scene);
    REQUIRE(many.advance(2e-3));
    CHECK(2 * many.state().memory.blocks > 3 * of.blocks);
    CHECK(2 * many.state().memory.contacts > 3 * of.contacts);
    CHECK(10 * many.state().memory.matrix >= 19 * of.matrix);
    CHECK(many.state().memory.blocks + many.state().memory.contacts < 3 * (of.blocks + of.contacts));
  }
}

TEST_CASE("velocities of the scene come back after they were stopped", "[analysis][simulation]") {
  Scene scene = test::tumbling_blocks();
  Simulation simulation(scene);
  simulation.change_system().stop();
  CHECK(simulation.system().kinetic_energy() == 0.0);
  simulation.restore_velocities();
  simulation.restart_clock();
  CHECK(simulation.system().velocity(1) == Eigen::Vector3d(1.5, -1.0, -2.0));
  CHECK(simulation.velocity(1) == Eigen::Vector3d(1.5, -1.0, -2.0));
  CHECK(simulation.velocity(0).isZero(0.0));
}

TEST_CASE("in statics every step starts and ends at rest", "[analysis][simulation]") {
  for (const std::string method : {"soft", "hard", "shi"}) {
    INFO(method);
    Scene scene = test::falling_block();
    scene.method.contact = method;
    scene.method.statics = true;
    scene.blocks[0].velocity = {5.0, 0.0};
    const double dt = 0.01;
    Simulation simulation(scene);
    for (int i = 1; i <= 3; ++i) {
      REQUIRE(simulation.advance(dt));
      CHECK(simulation.velocity(0).isZero(0.0));
      // From rest under gravity: dt^2 g / 2 each time, and no memory of the velocity.
      CHECK((simulation.system().displacement(0) - i * 0.5 * dt * dt * Eigen::Vector3d(0.0, -9.81, 0.0)).norm() < 1e-15);
    }
    // What it had is gone, and the ledger says where to.
    const double dropped = 0.5 * 25.0 * simulation.system().block(0).mass[0];
    CHECK(simulation.ledger().kinetic == -dropped);
    CHECK(simulation.ledger().scheme >= dropped);
    CHECK(std::abs(simulation.ledger().imbalance()) < 1e-14 * dropped);
  }
}

TEST_CASE("statics creeps to the equilibrium of the springs", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  scene.method.statics = true;
  Simulation simulation(scene);
  for (int i = 0; i < 20; ++i) REQUIRE(simulation.advance(1.0));
  CHECK(simulation.system().displacement(1)[1] == Approx(-test::block_weight / (1e9 * test::block_edge)).epsilon(1e-12));
}

TEST_CASE("what a step is measured against", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  CHECK(Simulation(scene).state().force_scale() == Approx(test::block_weight).epsilon(1e-14));
  scene.gravity = {0.0, 0.0};
  CHECK(Simulation(scene).state().force_scale() == 1.0);
  scene.loads = {{1, {1.0, 1.0}, {30.0, -40.0}}};
  CHECK(Simulation(scene).state().force_scale() == Approx(50.0).epsilon(1e-15));
}

TEST_CASE("scenes that cannot be simulated", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  SECTION("unknown enforcement") {
    scene.method.contact = "firm";
    CHECK_THROWS_WITH(Simulation(scene), ContainsSubstring("method.contact") && ContainsSubstring("\"soft\""));
  }
  SECTION("missing joint") {
    scene.joints.clear();
    CHECK_THROWS_WITH(Simulation(scene), ContainsSubstring("joint: none for the materials \"rock\" and \"rock\""));
  }
  SECTION("theta of a method that has none") {
    scene.method.contact = "hard";
    scene.method.theta = 0.5;
    CHECK_THROWS_WITH(Simulation(scene), ContainsSubstring("method.theta"));
  }
  CHECK_THROWS_AS(Simulation(scene), InputError);
}

TEST_CASE("contacts are those of where the blocks will be, their gaps those of now", "[analysis][simulation]") {
  Scene scene = test::empty_scene();
  // On one corner, a centimetre before the seam of two bases.
  scene.blocks = {test::fixed_block("left", test::rectangle(-10.0, -1.0, 10.0, 1.0)),
                  test::fixed_block("right", test::rectangle(0.0, -1.0, 10.0, 1.0)),
                  test::free_block("block", test::placed(test::rectangle(0.0, 0.0, 1.0, 1.0), 0.35, {-0.01, 0.0}))};
  scene.blocks[2].velocity = {2.0, -0.5};
  const double dt = 0.01;  // [s]: 20 mm on, 5 mm deep
  const auto bases_below = [&](double look_ahead) {
    scene.step.look_ahead = look_ahead;
    Simulation simulation(scene);
    // What touches in the drawing is found there, and is what is bonded.
    const auto below = [&] {
      std::vector<int> bases;
      for (const Contact& c : simulation.problem(dt, false).contacts) {
        if (c.vertex_block != 2) continue;  // a base's own corner
        bases.push_back(c.edge_block);
        CHECK(std::abs(c.gap) < 1e-12);
        CHECK(c.joint_state.bonded);  // one base inherits from the other
      }
      return bases;
    };
    CHECK(below() == std::vector<int>{0});
    simulation.positions_changed();
    const std::vector<int> bases = below();
    CHECK(simulation.system().displacement(2).isZero(0.0));
    return bases;
  };
  CHECK(bases_below(0.0) == std::vector<int>{0});
  CHECK(bases_below(0.25) == std::vector<int>{0});
  CHECK(bases_below(0.75) == std::vector<int>{1});
  CHECK(bases_below(1.0) == std::vector<int>{1});
}

TEST_CASE("the second stage of a step looks ahead by its own part of the velocity", "[analysis][simulation]") {
  const double stage = 2.0 - std::sqrt(2.0), speed = 2.0, dt = 0.01;  // [-, m/s, s]: of tr_bdf2 the first is a trapezoid over this part of the step
  Scene scene = test::empty_scene();
  scene.gravity = {0.0, 0.0};
  scene.method.integrator = "tr_bdf2";
  // A corner that flies a millimetre above two bases, 3 mm before their seam when the second stage begins; it goes 8.3 mm in that.
  scene.blocks = {test::fixed_block("left", test::rectangle(-10.0, -1.0, 10.0, 1.0)),
                  test::fixed_block("right", test::rectangle(0.0, -1.0, 10.0, 1.0)),
                  test::free_block("block", test::placed(test::rectangle(0.0, 0.0, 1.0, 1.0), 0.35, {-0.003 - stage * dt * speed, 0.001}))};
  scene.blocks[2].velocity = {speed, 0.0};
  const auto bases_below = [&](double look_ahead) {
    scene.step.look_ahead = look_ahead;
    Simulation simulation(scene);
    REQUIRE(simulation.step(stage * dt, false).accepted);
    std::vector<int> bases;
    for (const Contact& c : simulation.problem((1.0 - stage) * dt, false).contacts) {
      if (c.vertex_block == 2) bases.push_back(c.edge_block);
    }
    return bases;
  };
  CHECK(bases_below(0.0) == std::vector<int>{0});
  CHECK(bases_below(0.01) == std::vector<int>{0});
  CHECK(bases_below(0.3) == std::vector<int>{0});  // 2.5 mm
  CHECK(bases_below(0.4) == std::vector<int>{1});  // 3.3 mm
}

TEST_CASE("only methods that follow gaps in steps of their own look ahead", "[analysis][simulation]") {
  Scene scene = test::block_on_base();
  scene.step.look_ahead = 0.5;
  scene.step.look_ahead_where = {"scene.toml", 7};
  for (const std::string contact : {"soft", "hard"}) {
    scene.method.contact = contact;
    CHECK_NOTHROW(Simulation(scene));
  }
  for (const std::string contact : {"dem", "shi"}) {
    scene.method.contact = contact;
    CHECK_THROWS_WITH(Simulation(scene), ContainsSubstring("scene.toml:7: step.look_ahead: has no meaning for method.contact = \"" + contact + "\""));
  }
}
