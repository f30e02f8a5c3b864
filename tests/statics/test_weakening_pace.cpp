#include <cmath>

#include "openclose/statics/relaxation.h"
#include "openclose/statics/weakening_pace.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr double slope = 20.0 * test::degree;

Scene weakening_incline(double distance) {
  Scene scene = test::block_on_incline(slope);
  scene.joints[0].friction_angle = 45.0 * test::degree;
  scene.joints[0].residual_friction_angle = 20.0 * test::degree;
  scene.joints[0].slip_weakening_distance = distance;
  return scene;
}

/// A state of two contacts that have slipped.
struct Slips {
  explicit Slips(double distance) : scene(weakening_incline(distance)), system(scene), strength(system, scene), state(system) {
    pace.restart(state.contacts.size());
  }
  /// What is counted of two slips.
  std::pair<double, double> prolonged(double first, double second, bool is_balanced = true) {
    state.contacts[0].slip = first;
    state.contacts[1].slip = second;
    for (FrozenContactState& s : state.contacts) s.status = ContactStatus::sliding;
    pace.prolong(strength, state, is_balanced);
    return {state.contacts[0].slip, state.contacts[1].slip};
  }
  Scene scene;
  FrozenSystem system;
  FrozenStrength strength;
  FrozenState state;
  WeakeningPace pace;
};

}  // namespace

TEST_CASE("slips that fall like a geometric series are taken to its end at once, and counted once", "[statics][weakening]") {
  Slips slips(1e-3);
  REQUIRE(slips.state.contacts.size() == 2);
  CHECK(slips.prolonged(1.0, -2.0) == std::pair(1.0, 2.0));
  // A half and three fifths of the last ones: at least as much again is still to come.
  const auto [first, second] = slips.prolonged(0.5, 1.2);
  CHECK(first == Approx(1.0).epsilon(1e-14));
  CHECK(second == Approx(2.4).epsilon(1e-14));
  // The second one slips on by more than that.
  const auto [nothing, rest] = slips.prolonged(0.25, 1.3);
  CHECK(nothing == 0.0);
  CHECK(rest == Approx(0.1).epsilon(1e-12));
}

TEST_CASE("slips are prolonged no farther than to where a joint has nothing more to lose", "[statics][weakening]") {
  // Slips of 0.9 of the one before would be followed by nine times as much.
  const auto prolonged = [](double distance_in_closures) {
    const double closure = FrozenSystem(weakening_incline(1.0)).closure_unit();
    Slips slips(distance_in_closures * closure);
    slips.prolonged(1.0, 1.0);
    return slips.prolonged(0.9, 0.9).first;
  };
  CHECK(prolonged(100.0) == Approx(9.0).epsilon(1e-12));
  CHECK(prolonged(6.0) == Approx(0.9 * (1.0 + 4.5)).epsilon(1e-12));  // half of it
  CHECK(prolonged(1.5) == 0.9);                                       // what is left would save no increment
}

TEST_CASE("at rest joints have lost no more than what they have slipped", "[statics][weakening]") {
  Slips slips(1e-3);
  const double closure = slips.system.closure_unit();
  slips.prolonged(1.0, 1.0);
  slips.prolonged(0.5, 0.5);  // as much again is taken in advance
  lose_strength(slips.strength, slips.state);
  REQUIRE(slips.state.contacts[0].joint_state.slip == Approx(1.0 * closure).epsilon(1e-12));
  slips.pace.give_back(closure, slips.state);
  CHECK(slips.state.contacts[0].joint_state.slip == Approx(0.5 * closure).epsilon(1e-12));
  slips.state.contacts[1].joint_state.bonded = false;
  const JointState broken = slips.state.contacts[1].joint_state;
  slips.pace.give_back(closure, slips.state);
  CHECK(slips.state.contacts[1].joint_state == broken);
}

TEST_CASE("slips without a common pace are counted as they are", "[statics][weakening]") {
  Slips slips(1e-3);
  const auto stays = [&](double first, double second, bool is_balanced = true) {
    return slips.prolonged(first, second, is_balanced) == std::pair(first, second);
  };
  CHECK(stays(1.0, 1.0));
  CHECK(stays(0.95, 0.55));       // one falls nearly twice as fast as the other
  CHECK(stays(1.2, 0.7));         // they run away
  CHECK(stays(0.9, 0.5, false));  // blocks move
  CHECK(stays(0.6, 0.35));
  Slips at_once(0.0);
  CHECK(at_once.prolonged(1.0, 1.0) == std::pair(1.0, 1.0));
  CHECK(at_once.prolonged(0.5, -0.5) == std::pair(0.5, -0.5));
}

TEST_CASE("a joint that weakens nearly as fast as its springs are stiff comes to rest in few increments", "[statics][weakening]") {
  // The upper corner slides, the lower one's spring k holds: less strength by q lets the upper one slip by 2 q/k, and weakens it by h times that.
  // With h = 0.45 k/F every slip is 0.9 of the one before at F = 1, less at more.
  const double weight = test::block_weight, pull = weight * std::sin(slope), upper = 0.5 * weight * std::cos(slope) - 0.25 * pull;
  const Scene probe = weakening_incline(0.0);
  const double k = probe.joints[0].shear_stiffness, first_slip = 2.0 * upper / pull;
  const double drop = upper * (1.0 - std::tan(20.0 * test::degree)) / first_slip;
  const Scene scene = weakening_incline(drop / (0.45 * k));
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  Relaxation relaxation(system, strength, IncrementRule::newton);
  strength.reduce(1.0);
  RelaxationResult result = relaxation.bonded_state();
  REQUIRE(result.end == RelaxationEnd::stable);
  strength.reduce(1.005 * first_slip);
  result = relaxation.relax(result.state);
  REQUIRE(result.end == RelaxationEnd::stable);
  CHECK(result.steps < 40);  // 0.9^175 = 1e-8
  // The fixed point: T_u = u - h s, T_l = pull - T_u, s = (T_l - T_u)/k.
  const double peak = upper / (1.005 * first_slip), h = drop / 1.005 / (drop / (0.45 * k));
  const double slip = (pull - 2.0 * peak) / (k - 2.0 * h);
  double counted = 0.0;
  for (const FrozenContactState& s : result.state.contacts) counted = std::max(counted, s.joint_state.slip);
  CHECK(counted == Approx(slip).epsilon(1e-5));
}
