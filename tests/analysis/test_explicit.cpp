// The explicit loop against the same steps taken plainly, one by one, and what it does between two detections.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "openclose/analysis/run.h"
#include "openclose_traps.h"
#include "support/catch.h"
#include "support/plain_explicit.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

Scene explicit_scene(Scene scene, double dt) {
  scene.method.contact = "dem";
  scene.step.dt = dt;
  return scene;
}

Scene tumbling() {
  return explicit_scene(test::tumbling_blocks(), 5e-4);
}

Scene sliding() {
  Scene scene = explicit_scene(test::block_on_incline(35.0 * test::degree), 2e-4);
  scene.joints[0].friction_angle = 20.0 * test::degree;
  return scene;
}

/// On its own edge, with a load beside the centroid, a support, cohesion that goes and tension that breaks.
Scene breaking() {
  Scene scene = explicit_scene(test::block_on_base(), 2e-4);
  scene.joints[0].cohesion = 4e4;
  scene.joints[0].tensile_strength = 1e4;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  scene.loads = {{1, {1.5, 1.0}, {1e5, 2e4}}};
  scene.supports = {{1, {0.0, 0.5}, {3e5, 1e5}}};
  return scene;
}

Scene softening() {
  Scene scene = explicit_scene(test::block_on_base(), 2e-4);
  scene.joints[0].residual_friction_angle = 0.5 * scene.joints[0].friction_angle;
  scene.surcharges = {{1, scene.blocks[1].vertices[2], scene.blocks[1].vertices[3], 1e4, 3e4}};
  return scene;
}

Scene weakening() {
  Scene scene = sliding();
  scene.joints[0].cohesion = 1e3;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  scene.joints[0].residual_friction_angle = 0.5 * scene.joints[0].friction_angle;
  scene.joints[0].slip_weakening_distance = 0.1;
  return scene;
}

Scene rocking_column() {
  Scene scene = explicit_scene(test::column_of_blocks(3), 2e-4);
  scene.blocks[3].velocity = {0.05, 0.0};
  return scene;
}

/// Slides over the end of the left floor onto the right one, which is higher by 0.3 mm.
Scene over_a_seam() {
  Scene scene = explicit_scene(test::empty_scene(), 2e-4);
  scene.blocks = {test::fixed_block("left", test::rectangle(-10.0, -1.0, 10.0, 1.0)),
                  test::fixed_block("right", test::rectangle(0.0, -1.0, 10.0, 1.0003)),
                  test::free_block("block", test::rectangle(-2.1, 0.0, 2.0, 1.0))};
  scene.blocks[2].velocity = {2.0, 0.0};
  scene.joints[0].friction_angle = 10.0 * test::degree;
  return scene;
}

Scene locked() {
  Scene scene = explicit_scene(test::block_on_base(), 2e-4);
  scene.blocks[1].rotation_locked = true;
  scene.blocks[1].velocity = {0.3, -0.1};
  return scene;
}

using test::PlainExplicit;

/// Largest difference of positions [m] and of whole-step velocities times 1 s.
template <class A, class B>
double motion_difference(const A& a, const B& b) {
  double largest = 0.0;
  for (int i : a.system().free_blocks()) {
    largest = std::max(largest, (a.system().displacement(i) - b.system().displacement(i)).cwiseAbs().maxCoeff());
    largest = std::max(largest, (a.velocity(i) - b.velocity(i)).cwiseAbs().maxCoeff());
  }
  return largest;
}

double ledger_difference(const EnergyLedger& a, const EnergyLedger& b) {
  double largest = 0.0;
  for (const auto entry :
       {&EnergyLedger::kinetic, &EnergyLedger::gravity, &EnergyLedger::contact_springs, &EnergyLedger::support_springs, &EnergyLedger::loads,
        &EnergyLedger::friction, &EnergyLedger::contact_damping, &EnergyLedger::scheme, &EnergyLedger::redefinition, &EnergyLedger::turnover}) {
    largest = std::max(largest, std::abs(a.*entry - b.*entry));
  }
  return largest / b.turnover;
}

/// What becomes of a change of gravity in its last digits: the measure of what rounding may do.
double rounding_of(const Scene& scene, int steps) {
  Scene changed = scene;
  changed.gravity *= 1.0 + 1e-15;
  PlainExplicit a(scene), b(changed);
  double largest = 0.0;
  for (int i = 0; i < steps; ++i) {
    a.step(scene.step.dt);
    b.step(scene.step.dt);
    largest = std::max(largest, motion_difference(a, b));
  }
  return largest;
}

/// How much the ledgers of two simulations may differ because their motions do. An entry is the sum over the steps of force times way, or momentum
/// times velocity: where positions are apart by d, springs' forces are by stiffness times d, and ways by what d has changed.
class LedgerDifference {
 public:
  /// To be called after every step. Forces are those of `like`, which does about what the two do: asking for contacts would make a loop load anew.
  template <class A>
  void add_step(PlainExplicit& like, const A& a, const Simulation& b, double dt) {
    constexpr double digit = 2.2e-15;  // [m] last one of coordinates of up to 10 m
    double force = 0.0, stiffness = 0.0, apart = digit, way = 0.0, momentum = 0.0;
    for (const Contact& c : like.contacts()) {
      const JointProperties& joint = like.joints().joint(c.joint);
      force += std::abs(c.normal_force) + std::abs(c.shear_force);
      if (c.status != ContactStatus::open) stiffness += c.length * (joint.normal_stiffness + joint.shear_stiffness);
    }
    for (const int i : a.system().free_blocks()) {
      const auto& block = a.system().block(i);
      apart = std::max(apart, Motion::displacement_bound(a.system().displacement(i) - b.system().displacement(i), block.radius) + digit);
      way = std::max(way, dt * Motion::displacement_bound(a.system().velocity(i), block.radius));
      momentum += block.mass.dot(a.system().velocity(i).cwiseAbs());
      force += block.mass[0] * 9.81;
    }
    work_ += force * (std::abs(apart - apart_) + digit) + stiffness * apart * (way + apart);
    kinetic_ = momentum * motion_difference(a, b);
    apart_ = apart;
  }
  double largest() const { return work_ + kinetic_; }  ///< [J]

 private:
  double work_ = 0.0, kinetic_ = 0.0, apart_ = 0.0;
};

}  // namespace

TEST_CASE("the loop moves blocks as the plain steps do, contacts renewed in every step", "[analysis][explicit]") {
  struct Case {
    const char* name;
    Scene scene;
    int steps;
  };
  const Case c = GENERATE(values<Case>({{"sliding", sliding(), 5000},
                                        {"breaking", breaking(), 5000},
                                        {"softening", softening(), 5000},
                                        {"weakening", weakening(), 5000},
                                        {"rocking", rocking_column(), 5000},
                                        {"locked", locked(), 5000},
                                        {"tumbling", tumbling(), 600}}));
  const double damping_ratio = GENERATE(0.0, 0.2);
  INFO(c.name << ", damping ratio " << damping_ratio);
  Scene scene = c.scene;
  scene.method.skip_narrow_phase = false;
  scene.joints[0].damping_ratio = damping_ratio;
  Simulation loop(scene);
  PlainExplicit reference(scene);
  LedgerDifference of_ledger;
  for (int i = 0; i < c.steps; ++i) {
    REQUIRE(loop.step(scene.step.dt, false).accepted);
    loop.positions_changed();
    reference.step(scene.step.dt);
    of_ledger.add_step(reference, reference, loop, scene.step.dt);
  }
  loop.change_contacts();  // found anew, as those of the reference are
  // Gaps are rounded in every step, gravity only once; contacts that rattle or collide multiply both.
  // A gap rounded by 1e-15 m changes a velocity by w^2 dt 1e-15 m = 1e-13 m/s, at random in 5000 steps; collisions multiply it.
  const double rounding = 100.0 * rounding_of(scene, c.steps) + (std::string(c.name) == "tumbling" ? 1e-9 : 1e-11);
  const double allowed = of_ledger.largest() / reference.ledger().turnover, is = ledger_difference(loop.ledger(), reference.ledger());
  INFO("rounding " << rounding << ", ledgers " << is << " of " << allowed);
  CHECK(rounding < 1e-4);
  CHECK(motion_difference(loop, reference) < rounding);
  CHECK(is < allowed);
  CHECK(loop.max_penetration() == Approx(reference.max_penetration()).epsilon(1e-6));
  // The scenes do what their names say.
  CHECK(loop.system().displacement(1).cwiseAbs().maxCoeff() > 1e-5);
}

TEST_CASE("left alone the loop keeps to the plain steps where lengths do not change", "[analysis][explicit]") {
  Scene scene = GENERATE(sliding(), locked());
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.2);
  Scene renewed = scene;
  renewed.method.skip_narrow_phase = false;
  Simulation loop(scene);
  PlainExplicit reference(renewed);
  for (int i = 0; i < 5000; ++i) {
    REQUIRE(loop.step(scene.step.dt, false).accepted);
    reference.step(scene.step.dt);
  }
  CHECK(loop.state().counters.loads < 5000);
  CHECK(motion_difference(loop, reference) < 100.0 * rounding_of(scene, 5000) + 1e-11);
}

TEST_CASE("exchanging only the contacts that were found anew changes nothing", "[analysis][explicit]") {
  struct Case {
    const char* name;
    Scene scene;
    int steps;
    bool goes_far;
  };
  const Case c = GENERATE(values<Case>({{"sliding", sliding(), 5000, true},
                                        {"breaking", breaking(), 5000, false},
                                        {"rocking", rocking_column(), 5000, false},
                                        {"over a seam", over_a_seam(), 5000, true},
                                        {"tumbling", tumbling(), 600, true}}));
  Scene scene = c.scene;
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.2);
  INFO(c.name << ", damping ratio " << scene.joints[0].damping_ratio);
  Scene plainly = scene;
  plainly.method.skip_reload = false;
  Simulation loop(scene), reloaded(plainly);
  PlainExplicit twin(scene);
  LedgerDifference of_ledger;
  for (int i = 0; i < c.steps; ++i) {
    REQUIRE(loop.advance(scene.step.dt));
    REQUIRE(reloaded.advance(scene.step.dt));
    // Looked at through a twin, so that nothing is loaded anew here.
    twin.step(scene.step.dt);
    of_ledger.add_step(twin, loop, reloaded, scene.step.dt);
  }
  // Where the bound of friction falls while the dashpot pushes against the spring, the spring's memory alone does not tell what a contact that was
  // not found anew has carried: one step of the first order in the dashpot, which happens where blocks tumble.
  const double by_dashpots = scene.joints[0].damping_ratio > 0.0 ? 1e-3 : 1e-9;
  // A loop that is loaded anew leaves out what is too far apart by then, and what is left out rests at no gap when it comes back, see history.h: an
  // open contact's offset fades earlier. It shows where blocks rattle and joints break.
  const double by_offsets = std::string(c.name) == "breaking" ? 1e-3 : 1e-11;
  const double rounding = 100.0 * rounding_of(scene, c.steps) + (std::string(c.name) == "tumbling" ? by_dashpots : by_offsets);
  const double allowed = of_ledger.largest() / reloaded.ledger().turnover, is = ledger_difference(loop.ledger(), reloaded.ledger());
  INFO("rounding " << rounding << ", motion " << motion_difference(loop, reloaded) << ", ledgers " << is << " of " << allowed);
  CHECK(motion_difference(loop, reloaded) < rounding);
  CHECK(is < allowed);
  CHECK(reloaded.state().counters.loads_skipped == 0);
  CHECK((loop.state().counters.loads_skipped > 3 * loop.state().counters.loads || !c.goes_far));
}

TEST_CASE("the ledger closes where a contact is closed when it is found", "[analysis][explicit][energy]") {
  Scene scene = over_a_seam();
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.2);
  scene.method.skip_reload = GENERATE(true, false);
  Simulation simulation(scene);
  for (int i = 0; i < 5000; ++i) REQUIRE(simulation.advance(scene.step.dt));
  const EnergyLedger& l = simulation.ledger();
  CHECK(std::abs(l.imbalance()) < 1e-10 * l.turnover);
  CHECK(l.redefinition >= 0.0);
  // What the scene is for: contacts with the right floor come with a closure, which would be energy that was not there before.
  PlainExplicit watched(scene);
  int found_closed = 0;
  std::set<std::pair<int, int>> known;
  for (int i = 0; i < 5000; ++i) {
    watched.step(scene.step.dt);
    std::set<std::pair<int, int>> now;
    for (const Contact& c : watched.contacts()) {
      now.emplace(c.vertex, c.edge);
      const double stiffness = scene.joints[0].normal_stiffness * c.length;
      const bool closed = c.gap < 0.0 && 0.5 * stiffness * c.gap * c.gap > 1e-8 * l.turnover;
      if (c.status != ContactStatus::open || !closed || known.contains({c.vertex, c.edge})) continue;
      ++found_closed;
      CHECK(c.stored_energy == 0.0);
    }
    known.swap(now);
  }
  CHECK(found_closed > 0);
}

TEST_CASE("the ledger closes where a contact is found closed and its dashpot outweighs the spring", "[analysis][explicit][energy]") {
  Scene scene = explicit_scene(test::block_on_base(), 1e-4);
  for (Vec2& v : scene.blocks[1].vertices) v.y() -= 5e-4;
  scene.blocks[1].velocity = {0.0, 0.1};
  scene.joints[0].damping_ratio = GENERATE(0.1, 5.0);
  Simulation simulation(scene);
  for (int i = 0; i < 100; ++i) REQUIRE(simulation.advance(scene.step.dt));
  const EnergyLedger& l = simulation.ledger();
  CHECK(l.redefinition < -1e-3 * l.turnover);  // what the drawing has stored
  CHECK(std::abs(l.imbalance()) < 1e-10 * l.turnover);
}

TEST_CASE("what was asked for once follows the run", "[analysis][explicit]") {
  Scene scene = explicit_scene(test::falling_block(), 1e-2);
  Simulation simulation(scene);
  const auto& system = simulation.system();
  REQUIRE(simulation.advance(scene.step.dt));
  CHECK(system.displacement(0)[1] < 0.0);
  const double before = system.displacement(0)[1];
  REQUIRE(simulation.step(scene.step.dt, false).accepted);
  CHECK(system.displacement(0)[1] < before);
}

TEST_CASE("looking at a run does not change it", "[analysis][explicit]") {
  const Scene scene = rocking_column();
  Simulation alone(scene), watched(scene);
  for (int i = 0; i < 300; ++i) {
    REQUIRE(alone.advance(scene.step.dt));
    REQUIRE(watched.advance(scene.step.dt));
    std::as_const(watched).system();
    watched.velocity(1);
    watched.ledger();
  }
  // Displacements are added up in more parts.
  CHECK(motion_difference(alone, watched) < 1e-12);
  CHECK(alone.state().counters.loads == watched.state().counters.loads);
}

TEST_CASE("the explicit ledger closes, with damping of the motion too", "[analysis][explicit][energy]") {
  Scene scene = GENERATE(tumbling(), breaking(), sliding());
  scene.method.damping = GENERATE(MassDamping::none, MassDamping::local, MassDamping::automatic);
  scene.joints[0].damping_ratio = GENERATE(0.0, 0.3);
  Simulation simulation(scene);
  for (int i = 0; i < 1000; ++i) REQUIRE(simulation.advance(scene.step.dt));
  const EnergyLedger& l = simulation.ledger();
  CHECK(std::abs(l.imbalance()) < 1e-10 * l.turnover);
  CHECK((l.mass_damping > 1e-4 * l.turnover) == (scene.method.damping != MassDamping::none));
}

TEST_CASE("settling explicitly finds the closure under the weight", "[analysis][explicit][settle]") {
  Scene scene = explicit_scene(test::column_of_blocks(4), 1e-3);
  scene.method.damping = GENERATE(MassDamping::none, MassDamping::local, MassDamping::automatic);
  Simulation simulation(scene);
  const SettleResult settled = settle(simulation);
  REQUIRE(settled.settled);
  CHECK(settled.unbalanced_fraction <= scene.settle.unbalanced_fraction);
  // Forces balance to 1e-8 of the weight of one block, closures with them.
  double carried = 0.0;
  for (const Contact& c : simulation.change_contacts()) carried += c.edge_block == 0 || c.vertex_block == 0 ? c.normal_force : 0.0;
  CHECK(carried == Approx(4.0 * test::block_weight).epsilon(1e-7));
  CHECK(simulation.system().kinetic_energy() == 0.0);
  const EnergyLedger& l = simulation.ledger();
  CHECK(std::abs(l.imbalance()) < 1e-10 * l.turnover);
}

TEST_CASE("brittle joints lose at rest what they cannot keep there, not on the way", "[analysis][explicit][settle]") {
  // A column whose weight comes on slack springs is thrown up once; its top block, pushed by more than friction holds, needs its cohesion.
  Scene scene = explicit_scene(test::column_of_blocks(4), 1e-3);
  scene.method.damping = MassDamping::automatic;
  scene.joints[0].friction_angle = 30.0 * test::degree;
  scene.joints[0].cohesion = 0.5 * test::block_weight / test::block_edge;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_opening;
  scene.loads = {{4, {1.0, 3.5}, {0.8 * test::block_weight, 0.0}}};
  scene.settle.failure_displacement = 0.1;
  scene.settle.keep_bonds = GENERATE(true, false);
  Simulation simulation(scene);
  const SettleResult result = settle(simulation);
  INFO("bonds kept: " << scene.settle.keep_bonds << ", " << result.criterion);
  CHECK(result.settled == scene.settle.keep_bonds);
}

TEST_CASE("a corner that has slipped on the way from rest to rest has lost what goes with slip", "[analysis][explicit][settle]") {
  // A block of 2 m x 1 m: its upper corner carries (cos - sin/2)/2 of its weight and half of the shear force sin, until it slips; what it has then,
  // and the lower corner, do not hold the block.
  const double slope = 20.0 * test::degree, first_slip = (std::cos(slope) - 0.5 * std::sin(slope)) / std::sin(slope);
  Scene scene = explicit_scene(test::block_on_incline(slope), 1e-3);
  scene.joints[0].friction_angle = 45.0 * test::degree;
  scene.joints[0].residual_friction_angle = 20.0 * test::degree;
  scene.settle.failure_displacement = 0.1;
  for (const double part : {0.95, 1.05}) {
    INFO(part << " of the factor at the first slip, " << first_slip);
    Simulation simulation(scene);
    REQUIRE(settle(simulation).settled);
    simulation.change_joints().reduce_strength(part * first_slip);
    CHECK(settle(simulation, {}, SettleFrom::rest).settled == (part < 1.0));
  }
}

TEST_CASE("what slides from nobody knows where has lost all that goes with slip", "[analysis][explicit]") {
  Simulation simulation(weakening());
  for (int i = 0; i < 25; ++i) REQUIRE(simulation.step(2e-4, false).accepted);  // before the first corner leaves the plane
  const auto sliding_and_bonded = [&] {
    return std::ranges::count_if(simulation.change_contacts(),
                                 [](const Contact& c) { return c.status == ContactStatus::sliding && c.joint_state.bonded; });
  };
  REQUIRE(sliding_and_bonded() > 0);
  simulation.judge_bonds(nullptr);
  CHECK(sliding_and_bonded() == 0);
}

TEST_CASE("a contact that is open at rest has lost its bond", "[analysis][explicit][settle]") {
  // A block 2 m wide and 1 m high, pushed at its top by more than its weight, stands on its far corner; a spring keeps it from turning over.
  Scene scene = explicit_scene(test::block_on_base(), 1e-3);
  scene.joints[0].cohesion = 1e6;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_opening;
  scene.supports = {{1, {0.0, 1.0}, {0.0, 1e6}}};
  scene.loads = {{1, {0.0, 1.0}, {1.2 * test::block_weight, 0.0}}};
  Simulation simulation(scene);
  REQUIRE(settle(simulation).settled);
  int open = 0;
  for (const Contact& c : simulation.change_contacts()) {
    CHECK(c.joint_state.bonded == (c.status != ContactStatus::open));
    open += c.status == ContactStatus::open;
  }
  CHECK(open == 1);
}

TEST_CASE("what cannot be held fails by displacement, what takes too long by steps", "[analysis][explicit][settle]") {
  Scene scene = sliding();
  scene.settle.failure_displacement = 0.3;
  Simulation slides(scene);
  const SettleResult failed = settle(slides);
  CHECK_FALSE(failed.settled);
  CHECK(failed.criterion == "displacement");
  scene.settle.max_explicit_steps = 10;
  Simulation slow(scene);
  const SettleResult steps = settle(slow);
  CHECK_FALSE(steps.settled);
  CHECK(steps.criterion == "steps");
  CHECK(steps.steps == 10);
}

TEST_CASE("an interval is divided into equal steps below the critical one", "[analysis][explicit]") {
  Scene scene = explicit_scene(test::block_on_base(), 1e-1);
  Simulation simulation(scene);
  const double longest = scene.method.step_fraction * simulation.explicit_stepper()->critical_step();
  REQUIRE(simulation.advance(scene.step.dt));
  const auto steps = static_cast<long>(std::ceil(scene.step.dt / longest));
  CHECK(simulation.state().counters.steps == steps);
  CHECK(simulation.state().counters.longest_step == Approx(scene.step.dt / static_cast<double>(steps)).epsilon(1e-10));
  CHECK(simulation.time() == Approx(scene.step.dt).epsilon(1e-12));
  // A shorter interval is one step.
  REQUIRE(simulation.advance(0.5 * longest));
  CHECK(simulation.state().counters.steps == steps + 1);
}

TEST_CASE("a step that moves a block too far is taken in parts and leaves no trace", "[analysis][explicit]") {
  Scene scene = explicit_scene(test::falling_block(), 1.0);
  scene.blocks[0].velocity = {1.0, 0.0};
  Simulation simulation(scene);
  REQUIRE(simulation.advance(1.0));
  CHECK(simulation.state().counters.cuts > 0);
  CHECK(simulation.system().displacement(0)[0] == Approx(1.0).epsilon(1e-12));
  CHECK(simulation.system().displacement(0)[1] == Approx(-0.5 * 9.81).epsilon(1e-12));
  CHECK(std::abs(simulation.ledger().imbalance()) < 1e-12 * simulation.ledger().turnover);
}

TEST_CASE("a block is thrown as far as it flies, in steps however much shorter than the one that was asked for", "[analysis][explicit]") {
  Scene scene = explicit_scene(test::falling_block(), 10.0);
  scene.blocks[0].velocity = {50.0, 0.0};
  scene.step.max_displacement = 0.02;
  Simulation simulation(scene);
  REQUIRE(simulation.advance(10.0));
  const StepCounters& counters = simulation.state().counters;
  CHECK(simulation.system().displacement(0)[0] == Approx(500.0).epsilon(1e-10));
  CHECK(simulation.system().displacement(0)[1] == Approx(-0.5 * 9.81 * 100.0).epsilon(1e-10));
  // Its speed chooses the steps: they are not found by cutting longer ones each time.
  CHECK(counters.cuts < counters.steps / 100);
}

TEST_CASE("motions that are no numbers end an explicit run", "[analysis][explicit]") {
  const NonStop non_stop;
  Scene scene = explicit_scene(test::falling_block(), 1.0);
  scene.materials[0].density = 1e308;  // its weight is infinite, and its acceleration no number
  Simulation simulation(scene);
  CHECK_FALSE(simulation.advance(1.0));
  CHECK(simulation.system().displacement(0).isZero(0.0));
}

TEST_CASE("springs whose stable step is nothing beside the step end an explicit run", "[analysis][explicit]") {
  Scene scene = explicit_scene(test::block_on_base(), 2e-4);
  scene.joints[0].normal_stiffness = scene.joints[0].shear_stiffness = 1e60;
  Simulation simulation(scene);
  CHECK_FALSE(simulation.advance(scene.step.dt));
  CHECK_THAT(simulation.reason(), Catch::Matchers::ContainsSubstring("is nothing beside step.dt_s"));
}

TEST_CASE("a state that was saved goes on as the original", "[analysis][explicit]") {
  const Scene scene = rocking_column();
  Simulation first(scene);
  for (int i = 0; i < 200; ++i) REQUIRE(first.advance(scene.step.dt));
  const auto saved = first.save();
  first.restore(saved);
  for (int i = 0; i < 200; ++i) REQUIRE(first.advance(scene.step.dt));
  Simulation second(scene);
  second.restore(saved);
  for (int i = 0; i < 200; ++i) REQUIRE(second.advance(scene.step.dt));
  CHECK(motion_difference(first, second) == 0.0);
}

TEST_CASE("dem refuses what has no meaning for it", "[analysis][explicit]") {
  Scene scene = explicit_scene(test::block_on_base(), 1e-3);
  SECTION("statics") {
    scene.method.statics = true;
    CHECK_THROWS_WITH(Simulation(scene), Catch::Matchers::ContainsSubstring("method.statics"));
  }
  SECTION("relaxation") {
    scene.method.static_solver = StaticSolver::relaxation;
    CHECK_THROWS_WITH(Simulation(scene), Catch::Matchers::ContainsSubstring("solver.static_solver"));
  }
  SECTION("linear rotation") {
    scene.method.rotation = RotationKind::linear;
    CHECK_THROWS_WITH(Simulation(scene), Catch::Matchers::ContainsSubstring("method.rotation"));
  }
  SECTION("theta") {
    scene.method.theta = 0.5;
    CHECK_THROWS_WITH(Simulation(scene), Catch::Matchers::ContainsSubstring("method.theta"));
  }
}
