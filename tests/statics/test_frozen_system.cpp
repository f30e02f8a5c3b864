#include <cmath>
#include <utility>

#include "openclose/statics/explicit_relaxation.h"
#include "openclose/statics/frozen_state.h"
#include "openclose/statics/frozen_system.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

Scene scaled(Scene scene, double size, const Vec2& shift) {
  for (BlockInput& block : scene.blocks) {
    for (Vec2& v : block.vertices) v = size * v + shift;
  }
  return scene;
}

}  // namespace

TEST_CASE("a frozen system has the scene's weights and contacts in numbers of the order of one", "[statics]") {
  const Scene scene = test::block_on_base();
  const FrozenSystem system(scene);
  REQUIRE(system.rows() == 1);
  CHECK(system.length_unit() == Approx(std::sqrt(2.0)));
  CHECK(system.force_unit() == Approx(test::block_weight));
  CHECK(system.blocks()[0].load.isApprox(Eigen::Vector3d(0.0, -1.0, 0.0)));
  REQUIRE(system.contacts().size() == 2);
  for (const FrozenContact& c : system.contacts()) {
    CHECK(c.normal_stiffness == Approx(1.0));
    CHECK(c.source.length == Approx(0.5 * test::block_edge));
  }
}

TEST_CASE("the same scene at another size and place is the same frozen system", "[statics]") {
  const Scene scene = test::block_on_incline(20.0 * test::degree);
  const FrozenSystem system(scene);
  for (const double size : {1e-3, 1.0, 1e3}) {
    const Vec2 shift(size == 1.0 ? 5e6 : 0.0, 0.0);
    const FrozenSystem other(scaled(scene, size, shift));
    REQUIRE(other.contacts().size() == system.contacts().size());
    // Coordinates of 5e6 m are known to 1e-9 m.
    for (std::size_t i = 0; i < system.contacts().size(); ++i) {
      CHECK((other.contacts()[i].normal_a - system.contacts()[i].normal_a).norm() < 1e-8);
      CHECK((other.contacts()[i].shear_b - system.contacts()[i].shear_b).norm() < 1e-8);
      CHECK(other.contacts()[i].normal_stiffness == Approx(system.contacts()[i].normal_stiffness).epsilon(1e-8));
    }
  }
}

TEST_CASE("joints drawn a little open are closed, unless something lies in them", "[statics]") {
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v.y() += 5e-4;
  CHECK(FrozenSystem(scene).contacts().size() == 2);
  for (Vec2& v : scene.blocks[1].vertices) v.y() += 5e-3;
  CHECK(FrozenSystem(scene).contacts().empty());
}

TEST_CASE("cohesion acts where faces touch", "[statics]") {
  SECTION("on the whole of a joint") {
    const FrozenSystem flat(test::block_on_base());
    for (const FrozenContact& c : flat.contacts()) CHECK(c.joined_length == Approx(c.source.length));
  }
  SECTION("not where they open like a wedge") {
    Scene scene = test::empty_scene();
    const double opening = std::tan(4.0 * test::degree);
    scene.blocks = {test::fixed_block("base", test::rectangle(-5.0, -1.0, 10.0, 1.0)),
                    test::free_block("block", {{0.0, 0.0}, {2.0, 2.0 * opening}, {2.0, 2.0}, {0.0, 2.0}})};
    const FrozenSystem system(scene);
    REQUIRE(system.contacts().size() == 1);
    CHECK(system.contacts()[0].source.length > 0.5);
    CHECK(system.contacts()[0].joined_length == 0.0);
    scene.joints[0].cohesion = 1e5;
    CHECK(FrozenStrength(system, scene).of(0, {}).cohesion == 0.0);
  }
}

TEST_CASE("beside a joint of the same blocks a corner that is drawn open touches nothing", "[statics]") {
  // A millimetre above the step at the lower end of the joint.
  Scene scene = test::empty_scene();
  scene.blocks = {
      test::fixed_block("slope", {{4.02, -3.34}, {7.9, -2.36}, {3.3, 0.84}, {0.0007, 0.001}, {0.0, 0.0}, {-0.0032, 0.0}, {-0.567, -0.143}}),
      test::free_block("block", {{0.0007, 0.001}, {3.3, 0.84}, {1.47, 2.12}})};
  const FrozenSystem system(scene);
  REQUIRE(system.contacts().size() == 2);
  for (const FrozenContact& c : system.contacts()) CHECK(std::abs(c.normal.y()) < 0.99);
}

TEST_CASE("the load that a scene increases is apart from the others, and away until it is multiplied", "[statics]") {
  Scene scene = test::block_on_base();
  const Vec2 top(1.0, 1.0);
  scene.loads = {{1, top, {3000.0, 0.0}, "push"}, {1, top, {0.0, -5000.0}}};
  const auto load_at = [&](const std::string& what, double multiplier) -> Eigen::Vector3d {
    scene.strength_reduction.increase = what;
    FrozenSystem system(scene);
    const Eigen::Vector3d begin = system.blocks()[0].load;
    system.multiply_live_load(0.0);
    CHECK(system.blocks()[0].load == begin);
    CHECK(system.has_live_load());
    CHECK(system.force_unit() == Approx(test::block_weight));
    system.multiply_live_load(multiplier);
    // Force, and moment about the centroid, half a metre below.
    const Eigen::Vector3d& load = system.blocks()[0].load;
    return Eigen::Vector3d(load[0], load[1], load[2] * system.blocks()[0].radius * system.length_unit()) * system.force_unit();
  };
  const double down = -test::block_weight - 5000.0;
  const auto differs = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm() / test::block_weight; };
  CHECK(differs(load_at("push", 0.0), {0.0, down, 0.0}) < 1e-14);
  CHECK(differs(load_at("push", 2.0), {6000.0, down, -3000.0}) < 1e-14);
  CHECK(differs(load_at("-push", 2.0), {-6000.0, down, 3000.0}) < 1e-14);
  // The body force acts in the centroid; the load stays.
  CHECK(differs(load_at("gravity_x", 0.5), {3000.0 + 0.5 * test::block_weight, down, -1500.0}) < 1e-14);
  CHECK(differs(load_at("-gravity_x", 0.5), {3000.0 - 0.5 * test::block_weight, down, -1500.0}) < 1e-14);
  CHECK(differs(load_at("gravity_y", 1.0), {3000.0, -5000.0, -1500.0}) < 1e-14);
}

TEST_CASE("a corner that stands alone has no cohesion and no tension to lose", "[statics]") {
  Scene scene = test::block_on_base();
  scene.blocks.push_back(test::fixed_block("nose", {{2.0, 0.5}, {4.0, 0.25}, {4.0, 0.9}}));
  scene.joints[0].tensile_strength = 1e3;
  const FrozenSystem system(scene);
  const FrozenStrength strength(system, scene);
  int corners = 0;
  for (std::size_t i = 0; i < system.contacts().size(); ++i) {
    const bool is_corner = system.contacts()[i].joined_length == 0.0;
    corners += is_corner;
    CHECK(strength.can_lose(i, {}) == !is_corner);
  }
  CHECK(corners == 1);
}

TEST_CASE("the joints between two blocks are sections, each along one line", "[statics]") {
  const auto size = [](const FrozenSystem& system, const JointSection& section) {
    double length = 0.0, joined = 0.0;
    for (const PlaceInJoint& place : section) {
      length += (place.high - place.low) * system.length_unit();
      joined += system.contacts()[place.contact].joined_length;
    }
    CHECK(joined == Approx(length));
    return length;
  };
  SECTION("an upper block that stands back by half, and the nose of a third one that touches it") {
    Scene scene = test::block_on_base();
    scene.blocks.push_back(test::free_block("upper", test::rectangle(1.0, 1.0, 2.0, 1.0)));
    scene.blocks.push_back(test::fixed_block("nose", {{3.0, 1.5}, {5.0, 1.25}, {5.0, 1.9}}));
    const FrozenSystem system(scene);
    REQUIRE(system.sections().size() == 2);
    CHECK(system.contacts().size() == 5);
    CHECK(system.sections()[0].size() == 2);
    CHECK(size(system, system.sections()[0]) == Approx(2.0));
    CHECK(size(system, system.sections()[1]) == Approx(1.0));
  }
  SECTION("a corner in a face, out of it or in it by what drawings are rounded to, divides no joint") {
    for (const double off : {-1e-3, -1e-6, 0.0, 1e-6, 1e-3}) {
      CAPTURE(off);
      Scene scene = test::block_on_base();
      auto& corners = scene.blocks[1].vertices;
      corners.insert(corners.begin() + 1, Vec2(0.4, off));
      const FrozenSystem system(scene);
      REQUIRE(system.sections().size() == 1);
      CHECK(system.sections()[0].size() == (off > 0.0 ? 2 : 3));
      CHECK(size(system, system.sections()[0]) == Approx(2.0).epsilon(1e-5));
    }
  }
  const auto corners_on_corners = [] {
    Scene scene = test::block_on_base();
    scene.blocks[0].vertices = {{-10.0, -1.0}, {10.0, -1.0}, {10.0, 0.0}, {1.3, 0.0}, {0.4, 0.0}, {-10.0, 0.0}};
    scene.blocks[1].vertices = {{0.0, 0.0}, {0.4, 0.0}, {1.3, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}};
    return scene;
  };
  SECTION("where both blocks have a corner the halves of two pairs of faces meet, and nothing is missing") {
    Scene scene = corners_on_corners();
    JointProperties bridge = scene.joints[0];
    bridge.name = "bridge";
    bridge.materials = {JointProperties::no_material, JointProperties::no_material};
    scene.joints.push_back(bridge);
    constexpr int none = BlockInput::by_materials;
    scene.blocks[0].edge_joints = {none, none, none, 1, none, none};
    scene.blocks[1].edge_joints = {none, 1, none, none, none, none};
    const FrozenSystem system(scene);
    double of_bridge = 0.0;
    for (const FrozenContact& c : system.contacts()) of_bridge += c.source.joint == 1 ? c.joined_length : 0.0;
    CHECK(of_bridge == Approx(0.9));
    REQUIRE(system.sections().size() == 1);
    CHECK(size(system, system.sections()[0]) == Approx(2.0));
    for (const PlaceInJoint& place : system.sections()[0]) CHECK(place.filled == 0.0);
  }
  SECTION("the same where all is one joint, whichever of the two contacts at a corner comes first") {
    Scene scene = corners_on_corners();
    const bool is_swapped = GENERATE(false, true);  // which turns the order of the two
    CAPTURE(is_swapped);
    if (is_swapped) std::swap(scene.blocks[0], scene.blocks[1]);
    const FrozenSystem system(scene);
    REQUIRE(system.sections().size() == 1);
    CHECK(size(system, system.sections()[0]) == Approx(2.0));
    for (const PlaceInJoint& place : system.sections()[0]) CHECK(place.filled == 0.0);
  }
  SECTION("the two legs of a gate are one section with a hole, a step in a floor makes two") {
    Scene scene = test::block_on_base();
    scene.blocks[1].vertices = {{0.0, 0.0}, {0.5, 0.0}, {0.5, 1.0}, {1.5, 1.0}, {1.5, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
    const FrozenSystem gate(scene);
    REQUIRE(gate.sections().size() == 1);
    CHECK(gate.sections()[0].size() == 4);
    CHECK(size(gate, gate.sections()[0]) == Approx(1.0));
    scene.blocks[0].vertices = {{-10.0, -1.0}, {10.0, -1.0}, {10.0, 0.5}, {1.0, 0.5}, {1.0, 0.0}, {-10.0, 0.0}};
    scene.blocks[1].vertices = {{0.0, 0.0}, {0.9, 0.0}, {0.9, 0.5}, {2.0, 0.5}, {2.0, 2.0}, {0.0, 2.0}};
    const FrozenSystem step(scene);
    REQUIRE(step.sections().size() == 2);
    CHECK(size(step, step.sections()[0]) + size(step, step.sections()[1]) == Approx(1.9));
  }
}

TEST_CASE("a joint cracks at the end where stress that is linear along it reaches the tensile strength", "[statics]") {
  Scene scene = test::block_on_base();
  scene.joints[0].tensile_strength = 1e4;
  scene.joints[0].cohesion = 1e5;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_opening;
  const FrozenSystem system(scene);
  REQUIRE(system.contacts().size() == 2);
  const FrozenStrength strength(system, scene);
  const double bears = 1e4 * 0.5 * test::block_edge / system.force_unit();
  const auto cracked = [&](double left, double right) {
    FrozenState state(system);
    state.contacts[0].normal = left * bears;
    state.contacts[1].normal = right * bears;
    lose_strength(strength, state);
    return std::pair(!state.contacts[0].joint_state.bonded, !state.contacts[1].joint_state.bonded);
  };
  // N/L + -6 M/L^2, against the strength: 2 N1 - N2 over what an end bears.
  CHECK(cracked(-0.33, 0.33) == std::pair(false, false));
  CHECK(cracked(-0.34, 0.34) == std::pair(true, false));
  CHECK(cracked(0.34, -0.34) == std::pair(false, true));
  CHECK(cracked(-0.99, -0.99) == std::pair(false, false));
  // Pressed beyond the middle third: the far edge is pulled though its end carries nothing.
  CHECK(cracked(0.0, 0.99) == std::pair(false, false));
  CHECK(cracked(0.0, 1.01) == std::pair(true, false));
  CHECK(cracked(2.0, 4.9) == std::pair(false, false));
  // What has cracked at the left is a part of the joint while it presses there; half a joint that hangs at its edge bears a quarter of its strength.
  const auto right_cracks = [&](double left, double right) {
    FrozenState state(system);
    state.contacts[0].joint_state.bonded = false;
    state.contacts[0].normal = left * bears;
    state.contacts[1].normal = right * bears;
    lose_strength(strength, state);
    return !state.contacts[1].joint_state.bonded;
  };
  CHECK_FALSE(right_cracks(0.33, -0.33));
  CHECK(right_cracks(0.34, -0.34));
  CHECK_FALSE(right_cracks(0.0, -0.24));
  CHECK(right_cracks(0.0, -0.26));
}

TEST_CASE("dem: the travel of a state is at least the way from where it began", "[statics]") {
  // Gravity first shears the joint, which then breaks: two legs.
  Scene scene = test::block_on_base();
  scene.blocks[1].vertices = test::rectangle(0.0, 0.0, 2.0, 4.0);
  scene.gravity = {4.5, -10.0};
  scene.joints[0].friction_angle = 38.66 * test::degree;
  scene.joints[0].cohesion = 5e3;
  scene.joints[0].cohesion_behaviour = CohesionBehaviour::lost_on_slip;
  const FrozenSystem system(scene);
  FrozenStrength strength(system, scene);
  ExplicitRelaxation dem(system, strength, 0.8, 1000000);
  for (const double factor : {1.0, 1.5, 1.7}) {
    INFO(factor);
    strength.reduce(factor);
    const RelaxationResult bonded = dem.bonded_state();
    REQUIRE(bonded.end == RelaxationEnd::stable);
    const RelaxationResult rest = dem.relax(bonded.state, Effort::full);
    REQUIRE(rest.end == RelaxationEnd::stable);
    CHECK(rest.travel >= farthest_between(rest.state, bonded.state));
  }
}
