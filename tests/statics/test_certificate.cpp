#include <cmath>

#include "openclose/statics/certificate.h"
#include "openclose/statics/explicit_relaxation.h"
#include "openclose/statics/relaxation.h"
#include "openclose_traps.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr double slope = 30.0 * test::degree;
constexpr double friction = 40.0 * test::degree;

Scene incline() {
  Scene scene = test::block_on_incline(slope);
  scene.joints[0].friction_angle = friction;
  return scene;
}

/// Relaxed from the bonded state at a factor.
RelaxationResult relaxed(const FrozenSystem& system, FrozenStrength& strength, double factor) {
  strength.reduce(factor);
  Relaxation relaxation(system, strength, IncrementRule::newton);
  const RelaxationResult bonded = relaxation.bonded_state();
  REQUIRE(bonded.end == RelaxationEnd::stable);
  return relaxation.relax(bonded.state);
}

}  // namespace

TEST_CASE("forces that balance within the strength prove that a block stands, others do not", "[statics]") {
  const Scene scene = incline();
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  const double limit = std::tan(friction) / std::tan(slope);
  const RelaxationResult stands = relaxed(system, strength, 0.999 * limit);
  REQUIRE(stands.end == RelaxationEnd::stable);
  CHECK(check_equilibrium(system, strength, stands.state).holds());
  // Normal and shear forces of the whole base are the components of the weight.
  double normal = 0.0, shear = 0.0;
  for (const FrozenContactState& s : stands.state.contacts) normal += s.normal, shear += std::abs(s.shear);
  CHECK(normal == Approx(std::cos(slope)).epsilon(1e-9));
  CHECK(shear == Approx(std::sin(slope)).epsilon(1e-9));

  SECTION("a force that is off by a millionth of the weight") {
    FrozenState other = stands.state;
    other.contacts[0].normal += 1e-6;
    CHECK_FALSE(check_equilibrium(system, strength, other).in_balance());
  }
  SECTION("a strength that is too small by a thousandth") {
    strength.reduce(1.001 * limit);
    const EquilibriumCheck check = check_equilibrium(system, strength, stands.state);
    CHECK(check.in_balance());
    CHECK_FALSE(check.within_strength);
  }
  SECTION("no number") {
    const NonStop non_stop;
    FrozenState other = stands.state;
    other.contacts[0].normal = std::nan("");
    CHECK_FALSE(check_equilibrium(system, strength, other).holds());
  }
}

TEST_CASE("forces and accelerations prove that a block starts to slide", "[statics]") {
  const Scene scene = incline();
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  const RelaxationResult slides = relaxed(system, strength, 1.001 * std::tan(friction) / std::tan(slope));
  REQUIRE(slides.end == RelaxationEnd::mechanism);
  CHECK(is_mechanism(system, strength, slides.state, slides.mechanism));
  const Vec2 direction = slides.mechanism.head<2>();
  CHECK(direction.normalized().dot(test::downhill(slope)) == Approx(1.0).epsilon(1e-6));

  SECTION("also where the joint could bear a pull that is larger than what presses it") {
    Scene bonded = scene;
    bonded.joints[0].tensile_strength = 2.0 * test::block_weight / test::block_edge;
    FrozenStrength with_tension(system, bonded);
    with_tension.reduce(1.001 * std::tan(friction) / std::tan(slope));
    CHECK(is_mechanism(system, with_tension, slides.state, slides.mechanism));
  }
  SECTION("uphill is none") {
    CHECK_FALSE(is_mechanism(system, strength, slides.state, -slides.mechanism));
  }
  SECTION("into the base is none") {
    Eigen::VectorXd into = slides.mechanism;
    into.head<2>() -= 1e-3 * test::off_slope(slope);
    CHECK_FALSE(is_mechanism(system, strength, slides.state, into));
  }
  SECTION("with more strength it is none") {
    strength.reduce(0.99 * std::tan(friction) / std::tan(slope));
    CHECK_FALSE(is_mechanism(system, strength, slides.state, slides.mechanism));
  }
}

TEST_CASE("a motion into another block, or one that no load drives, is no mechanism", "[statics]") {
  Scene ground = test::block_on_base();
  ground.joints[0].friction_angle = 0.0;
  const Scene falling = test::falling_block();
  const FrozenSystem system(ground), air(falling);
  FrozenStrength strength(system, ground);
  const Eigen::VectorXd down = Eigen::Vector3d(0.0, -1.0, 0.0), sideways = Eigen::Vector3d(1.0, 0.0, 0.0);
  // Contacts that carry nothing leave the block its weight.
  CHECK_FALSE(is_mechanism(system, strength, FrozenState(system), down));
  CHECK(is_mechanism(air, FrozenStrength(air, falling), FrozenState(air), down));
  const RelaxationResult stands = relaxed(system, strength, 1.0);
  REQUIRE(stands.end == RelaxationEnd::stable);
  CHECK_FALSE(is_mechanism(system, strength, stands.state, sideways));
}

TEST_CASE("a block in the air is beyond all strength, one on the ground is not", "[statics]") {
  const Eigen::VectorXd down = Eigen::Vector3d(0.0, -1.0, 0.0);
  const Scene air = test::falling_block(), ground = test::block_on_base();
  for (const Scene& scene : {air, ground}) {
    const FrozenSystem system(scene);
    FrozenStrength strength(system, scene);
    const bool falls = scene.blocks.size() == 1;
    CHECK(is_beyond_all_strength(system, strength, down) == falls);
    CHECK_FALSE(is_beyond_all_strength(system, strength, -down));
    Relaxation relaxation(system, strength, IncrementRule::newton);
    CHECK((relaxation.bonded_state().end == RelaxationEnd::mechanism) == falls);
  }
}

TEST_CASE("explicit relaxation knows that a corner which sticks at rest has slipped on the way there", "[statics]") {
  // A block of 2 m x 1 m: its upper corner carries (cos - sin/2)/2 of its weight and half of the shear force sin, until it slips; what it has then,
  // and the lower corner, do not hold the block.
  Scene scene = test::block_on_incline(20.0 * test::degree);
  scene.joints[0].friction_angle = 45.0 * test::degree;
  scene.joints[0].residual_friction_angle = 20.0 * test::degree;
  const double sine = std::sin(20.0 * test::degree), cosine = std::cos(20.0 * test::degree);
  const double first_slip = (cosine - 0.5 * sine) / sine;
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  ExplicitRelaxation loop(system, strength, 0.8, 100000);
  for (const double part : {0.99, 1.01}) {
    INFO(part << " of the factor at the first slip, " << first_slip);
    strength.reduce(part * first_slip);
    const RelaxationResult bonded = loop.bonded_state();
    REQUIRE(bonded.end == RelaxationEnd::stable);
    CHECK(loop.relax(bonded.state).end == (part < 1.0 ? RelaxationEnd::stable : RelaxationEnd::mechanism));
  }
}

TEST_CASE("joints that weaken along their slip stand up to more than those that break at the first one", "[statics]") {
  // The same block, and its factor by hand: at the lower corner's first slip both corners carry what pulls.
  Scene scene = test::block_on_incline(20.0 * test::degree);
  JointProperties& joint = scene.joints[0];
  joint.friction_angle = 45.0 * test::degree;
  joint.residual_friction_angle = 20.0 * test::degree;
  joint.slip_weakening_distance = 1.5e-4;
  const double weight = test::block_weight, pull = weight * std::sin(20.0 * test::degree), normal = weight * std::cos(20.0 * test::degree);
  const double upper = 0.5 * normal - 0.25 * pull, lower = 0.5 * normal + 0.25 * pull, drop = 1.0 - std::tan(20.0 * test::degree);
  const auto carried = [&](double factor) {
    const double way = lower / factor / joint.shear_stiffness;  // corners of one metre
    double slip = 0.0, by_upper = 0.0;
    for (int i = 0; i < 200; ++i) {
      by_upper = upper / factor * (1.0 - drop * slip / joint.slip_weakening_distance);
      slip = std::max(0.0, way - by_upper / joint.shear_stiffness);
    }
    return by_upper + lower / factor;
  };
  double limit = normal / pull;  // without weakening
  while (carried(limit) < pull) limit -= 1e-6 * normal / pull;
  REQUIRE(limit < 0.99 * normal / pull);
  REQUIRE(limit > 1.05 * 2.0 * upper / pull);  // at the first slip
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  Relaxation newton(system, strength, IncrementRule::newton), open_close(system, strength, IncrementRule::open_close);
  ExplicitRelaxation loop(system, strength, 0.8, 1000000);
  for (FrozenSolver* solver : {static_cast<FrozenSolver*>(&newton), static_cast<FrozenSolver*>(&open_close), static_cast<FrozenSolver*>(&loop)}) {
    strength.reduce(1.0);
    RelaxationResult stands = solver->bonded_state();
    REQUIRE(stands.end == RelaxationEnd::stable);
    for (const double part : {0.8, 0.9, 0.98, 0.999}) {
      strength.reduce(part * limit);
      stands = solver->relax(stands.state);
      INFO(part << " of " << limit);
      REQUIRE(stands.end == RelaxationEnd::stable);
    }
    strength.reduce(1.01 * limit);
    CHECK(solver->relax(stands.state).end == RelaxationEnd::mechanism);
  }
}

TEST_CASE("every way to relax finds the state in which a block stands", "[statics]") {
  const Scene scene = incline();
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  strength.reduce(1.4);
  const RelaxationResult newton = relaxed(system, strength, 1.4);
  Relaxation open_close(system, strength, IncrementRule::open_close, 200);
  ExplicitRelaxation loop(system, strength, 0.8, 100000);
  for (FrozenSolver* solver : {static_cast<FrozenSolver*>(&open_close), static_cast<FrozenSolver*>(&loop)}) {
    const RelaxationResult bonded = solver->bonded_state();
    REQUIRE(bonded.end == RelaxationEnd::stable);
    const RelaxationResult result = solver->relax(bonded.state);
    REQUIRE(result.end == RelaxationEnd::stable);
    // How the corners share the shear force depends on the way; all together carry the weight's.
    double shear = 0.0, expected = 0.0;
    for (std::size_t i = 0; i < result.state.contacts.size(); ++i) {
      CHECK(result.state.contacts[i].normal == Approx(newton.state.contacts[i].normal).margin(1e-7));
      shear += result.state.contacts[i].shear, expected += newton.state.contacts[i].shear;
    }
    CHECK(shear == Approx(expected).margin(1e-7));
  }
}
