// Joints of the drawing: which there are, and how far they have opened and slipped after known motions.
#include <cmath>

#include "openclose/analysis/drawn_joints.h"
#include "openclose/analysis/measured_contacts.h"
#include "openclose/analysis/run.h"
#include "openclose/geometry/polygon.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

TEST_CASE("drawn joints are the stretches along which edges face each other", "[analysis][drawn_joints]") {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base", test::rectangle(-10.0, -1.0, 20.0, 1.0)), test::free_block("left", test::rectangle(0.0, 0.0, 2.0, 1.0)),
                  test::free_block("right", test::rectangle(2.0, 0.0, 2.0, 3.0)), test::free_block("top", test::rectangle(0.5, 1.0, 1.5, 1.0)),
                  test::fixed_block("other base", test::rectangle(10.0, -1.0, 5.0, 1.0))};
  const std::vector<DrawnJoint> joints = drawn_joints(scene);
  // base-left, base-right, left-right, left-top, right-top; the two fixed blocks have none between them.
  REQUIRE(joints.size() == 5);
  const auto length = [&](std::size_t i) { return (joints[i].to_b - joints[i].from_b).norm(); };
  const double lengths[] = {2.0, 2.0, 1.0, 1.5, 1.0};
  const int first[] = {0, 0, 1, 1, 2}, second[] = {1, 2, 2, 3, 3};
  for (std::size_t i = 0; i < joints.size(); ++i) {
    CHECK(joints[i].block_a == first[i]);
    CHECK(joints[i].block_b == second[i]);
    CHECK(length(i) == Approx(lengths[i]).epsilon(1e-12));
    CHECK((joints[i].from_a - joints[i].from_b).norm() < 1e-12);
  }
}

TEST_CASE("drawn gaps of a millimetre are joints, wider ones are not", "[analysis][drawn_joints]") {
  for (const double gap : {9e-4, 1.6e-3}) {
    Scene scene = test::block_on_base();
    for (Vec2& v : scene.blocks[1].vertices) v.y() += gap;
    const std::vector<DrawnJoint> joints = drawn_joints(scene);
    // A thousandth of the root of 2 m2 is 1.4 mm.
    REQUIRE(joints.size() == (gap < 1.4e-3 ? 1 : 0));
    if (joints.empty()) continue;
    const BlockSystem system(scene);
    CHECK(joint_motion(joints[0], system).from.opening == Approx(gap).epsilon(1e-9));
  }
}

TEST_CASE("edges that gape are a joint if their far ends are no farther apart", "[analysis][drawn_joints]") {
  for (const double angle : {4e-4, 0.05}) {
    Scene scene = test::block_on_base();
    scene.blocks[1].vertices = test::placed(scene.blocks[1].vertices, angle);
    const std::vector<DrawnJoint> joints = drawn_joints(scene);
    // 2 m long: 0.8 mm apart at the far end, or 0.1 m.
    REQUIRE(joints.size() == (angle < 1e-3 ? 1 : 0));
    if (joints.empty()) continue;
    const JointMotion m = joint_motion(joints[0], BlockSystem(scene));
    CHECK(std::abs(m.from.opening) + std::abs(m.to.opening) == Approx(2.0 * std::sin(angle)).epsilon(1e-3));
  }
}

TEST_CASE("a lifted and turned block opens its joint by the closed form, however far it goes", "[analysis][drawn_joints]") {
  for (const double slope : {0.0, 0.4}) {
    const Scene scene = test::block_on_incline(slope);
    const std::vector<DrawnJoint> joints = drawn_joints(scene);
    REQUIRE(joints.size() == 1);
    REQUIRE(joints[0].block_a == 0);
    for (const double lift : {1e-9, 1e-3, 7.0}) {
      for (const double angle : {0.0, 0.3, 2.5}) {
        BlockSystem system(scene);
        const Vec2 shift = lift * test::off_slope(slope) + 0.25 * test::downhill(slope);
        system.advance(1, {shift.x(), shift.y(), angle});
        const JointMotion m = joint_motion(joints[0], system);
        // The edge of the block: from (0, 0) to (2, 0) along the slope, its centroid at (1, 0.5). The normal turns with it; seen from the block the
        // base moves by R(-angle) (p - c - shift) - (p - c) at the point p, in the frame of the slope.
        const auto seen = [&](double x) {
          const Vec2 p(x - 1.0, -0.5), q = p - Vec2(0.25, lift);
          const double c = std::cos(angle), s = std::sin(angle);
          return Vec2(Vec2(c * q.x() + s * q.y(), -s * q.x() + c * q.y()) - p);
        };
        const double rounding = 1e-14 * (10.0 + lift);
        CHECK(m.from.opening == Approx(-seen(0.0).y()).margin(rounding));
        CHECK(m.to.opening == Approx(-seen(2.0).y()).margin(rounding));
        CHECK(m.from.slip == Approx(seen(0.0).x()).margin(rounding));
        CHECK(m.to.slip == Approx(seen(2.0).x()).margin(rounding));
        if (angle == 0.0) CHECK(m.from.opening == Approx(lift).margin(rounding));
      }
    }
  }
}

TEST_CASE("a measured contact carries the block's weight, and slips by the shear force over the joint's stiffness", "[analysis][measured_contacts]") {
  for (const std::string& method : test::all_methods) {
    INFO(method);
    const double slope = 0.3;
    Scene scene = test::block_on_incline(slope);
    scene.method.contact = method;
    scene.method.start = Start::settled;
    const Vec2 middle = test::downhill(slope);
    scene.measured_contacts = {{"foot", 1, 0, middle}, {"other way", 0, 1, middle}};
    Simulation simulation(scene);
    REQUIRE(prepare_start(simulation).converged);
    const std::vector<ContactMotion> motions = MeasuredContacts(scene).motions(simulation);
    REQUIRE(motions.size() == 2);
    for (const ContactMotion& m : motions) {
      CHECK(m.closed == 2);
      CHECK(m.status == ContactStatus::sticking);
      CHECK(m.normal_force == Approx(test::block_weight * std::cos(slope)).epsilon(1e-6));
      // Friction holds the block back, uphill: against the base's edge, which runs downhill to uphill, and for the base along the block's.
      CHECK(std::abs(m.shear_force) == Approx(test::block_weight * std::sin(slope)).epsilon(1e-6));
      if (method != "soft" && method != "dem") continue;
      CHECK(m.gap == Approx(-test::block_weight * std::cos(slope) / (1e9 * test::block_edge)).epsilon(1e-4));
      CHECK(m.slip == Approx(-m.shear_force / (4e8 * test::block_edge)).epsilon(1e-4));
    }
    CHECK(motions[0].shear_force == motions[1].shear_force);
  }
}

TEST_CASE("a measured contact knows its gap beyond the reach of detection", "[analysis][measured_contacts]") {
  Scene scene = test::block_on_base();
  scene.blocks[1].velocity = {0.0, 10.0};
  scene.measured_contacts = {{"foot", 1, 0, {1.0, 0.0}}};
  scene.gravity = Vec2::Zero();
  Simulation simulation(scene);
  REQUIRE(prepare_start(simulation).converged);
  for (int i = 0; i < 100; ++i) REQUIRE(simulation.advance(1e-2));
  const ContactMotion m = MeasuredContacts(scene).motions(simulation).front();
  CHECK(m.status == ContactStatus::open);
  CHECK(m.closed == 0);
  CHECK(m.normal_force == 0.0);
  CHECK(m.gap == Approx(10.0).epsilon(1e-9));
}

TEST_CASE("the measured angular velocity is that of the block", "[analysis][run]") {
  Scene scene = test::falling_block();
  scene.blocks[0].angular_velocity = 1.75;
  scene.measured_points = {{"corner", 0, {2.0, 1.0}}};
  for (const std::string& method : test::all_methods) {
    INFO(method);
    scene.method.contact = method;
    Simulation simulation(scene);
    MeasuredPoints points(simulation);
    for (int i = 0; i < 40; ++i) REQUIRE(simulation.advance(1e-2));
    const PointMotion m = points.motions().front();
    CHECK(m.angular_velocity == Approx(1.75).epsilon(1e-9));
    CHECK(m.rotation == Approx(0.4 * 1.75).epsilon(1e-9));
  }
}
