// Which vertices touch which edges, and nothing else.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "contacts.h"
#include "openclose/contact/detection.h"
#include "support/catch.h"

using namespace openclose;
using namespace openclose::test;

namespace {

/// 4 m x 2 m with a notch of 1 m x 1 m in the middle of its top; the inner corners are vertices 4 and 5.
const std::vector<Vec2> notched{{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {2.5, 2.0}, {2.5, 1.0}, {1.5, 1.0}, {1.5, 2.0}, {0.0, 2.0}};

/// All blocks turned about the origin and shifted.
Scene turned(Scene scene, double angle, const Vec2& shift) {
  for (BlockInput& block : scene.blocks) block.vertices = placed(block.vertices, angle, shift);
  return scene;
}

/// A point seen from the origin in a direction [deg].
Vec2 at(double length, double angle) {
  return length * Vec2(std::cos(angle * degree), std::sin(angle * degree));
}

double overlap_of(double low_a, double high_a, double low_b, double high_b) {
  return std::max(0.0, std::min(high_a, high_b) - std::max(low_a, low_b));
}

}  // namespace

TEST_CASE("a block on a wide base touches with both its corners, half its width each", "[contact][detection]") {
  const double angle = GENERATE(0.0, 0.4, 2.0, -2.5);
  const Vec2 shift = angle == 0.0 ? Vec2(0.0, 0.0) : Vec2(300.0, -200.0);
  Detection d(
      turned(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))}), angle, shift));
  REQUIRE(d.contacts.size() == 2);
  for (const int corner : {4, 5}) {
    const Contact* c = d.find(corner, 2);
    REQUIRE(c != nullptr);
    CHECK(c->vertex_block == 1);
    CHECK(c->edge_block == 0);
    CHECK(c->joint == 0);
    CHECK(c->length == Approx(1.0).epsilon(1e-12));
    // Rounding of coordinates of 360 m.
    CHECK(std::abs(c->gap) <= 1e-12);
  }
}

TEST_CASE("the order of the blocks does not matter", "[contact][detection]") {
  Detection d(scene_with({free_block("block", rectangle(0.0, 0.0, 2.0, 1.0)), fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  CHECK(d.length(0, 4 + 2) == Approx(1.0).epsilon(1e-14));
  CHECK(d.length(1, 4 + 2) == Approx(1.0).epsilon(1e-14));
}

TEST_CASE("a block that hangs over touches with its corner and with the base's", "[contact][detection]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 6.0, 1.0)), free_block("block", rectangle(0.5, 0.0, 1.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  CHECK(d.length(4, 2) == Approx(0.25).epsilon(1e-14));
  const Contact* base_corner = d.find(2, 4);
  REQUIRE(base_corner != nullptr);
  CHECK(base_corner->length == Approx(0.25).epsilon(1e-14));
  CHECK(base_corner->vertex_block == 0);
  CHECK(base_corner->edge_block == 1);
}

TEST_CASE("a corner above a thin plate is not behind the plate's lower side", "[contact][detection]") {
  const double thickness = 4e-4;
  Detection d(
      scene_with({fixed_block("lower", rectangle(0.0, 0.0, 2.0, thickness)), free_block("upper", rectangle(0.5, thickness, 1.0, thickness))}));
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) CHECK(std::abs(c.gap) < 1e-15);
}

TEST_CASE("a wide block on a narrow base touches with the base's corners only", "[contact][detection]") {
  Detection d(scene_with({fixed_block("base", rectangle(0.5, -1.0, 1.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  CHECK(d.length(2, 4) == Approx(0.5).epsilon(1e-14));
  CHECK(d.length(3, 4) == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("gaps are kept up to the reach, penetrations are negative", "[contact][detection]") {
  const double gap = GENERATE(-1e-3, -1e-5, 1e-6, 0.0499, 0.0501);
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, gap, 2.0, 1.0))}), 0.05);
  if (gap > 0.05) {
    CHECK(d.contacts.empty());
  } else {
    REQUIRE(d.contacts.size() == 2);
    for (const Contact& c : d.contacts) CHECK(c.gap == Approx(gap).margin(1e-15));
  }
}

TEST_CASE("fixed blocks have no contact with each other", "[contact][detection]") {
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), fixed_block("wall", rectangle(0.0, 0.0, 2.0, 1.0)),
                          free_block("block", rectangle(2.0, 0.0, 1.0, 1.0))}));
  CHECK(d.contacts.size() == 4);
  for (const Contact& c : d.contacts) CHECK((c.vertex_block == 2 || c.edge_block == 2));
}

TEST_CASE("a distant block adds nothing", "[contact][detection]") {
  Scene scene = scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0))});
  const std::size_t alone = Detection(scene).contacts.size();
  scene.blocks.push_back(free_block("distant", rectangle(0.0, 1.4, 2.0, 1.0)));
  CHECK(Detection(scene).contacts.size() == alone);
  CHECK(Detection(scene).detector.candidate_pairs().size() == 1);
  scene.blocks.back().vertices = rectangle(0.0, 1.04, 2.0, 1.0);
  CHECK(Detection(scene).contacts.size() == alone + 2);
}

TEST_CASE("a block in a notch of its width stands on the floor between both walls", "[contact][detection]") {
  const double height = GENERATE(0.5, 1.0, 1.7), angle = GENERATE(0.0, 0.9);
  const bool block_first = GENERATE(false, true);
  std::vector<BlockInput> blocks{fixed_block("base", notched), free_block("block", rectangle(1.5, 1.0, 1.0, height))};
  if (block_first) std::swap(blocks[0], blocks[1]);
  Detection d(turned(scene_with(blocks), angle, {0.0, 0.0}));
  const int base = block_first ? 4 : 0, block = block_first ? 0 : 8;
  const double wall = std::min(height, 1.0);
  CHECK(d.contacts.size() == 6);
  // Floor is the edge from 4, walls are those from 3 (right) and 5 (left).
  CHECK(d.length(block + 0, base + 4) == Approx(0.5).epsilon(1e-12));
  CHECK(d.length(block + 1, base + 4) == Approx(0.5).epsilon(1e-12));
  CHECK(d.length(block + 1, base + 3) == Approx(0.5 * wall).epsilon(1e-12));
  CHECK(d.length(block + 0, base + 5) == Approx(0.5 * wall).epsilon(1e-12));
  CHECK(d.total_length() == Approx(1.0 + 2.0 * wall).epsilon(1e-12));
  for (const Contact& c : d.contacts) {
    CHECK_FALSE(d.system.is_reflex(c.vertex));
    CHECK(std::abs(c.gap) <= 1e-14);
  }
}

TEST_CASE("a block pressed into a notch keeps floor and walls", "[contact][detection]") {
  const double deep = GENERATE(1e-7, 1e-5, 9e-4);
  Detection d(scene_with({fixed_block("base", notched), free_block("block", rectangle(1.5 - deep, 1.0 - deep, 1.0 + 2.0 * deep, 0.5))}));
  CHECK(d.contacts.size() == 6);
  CHECK(d.length(8, 4) == Approx(0.5).epsilon(1e-2));
  CHECK(d.length(9, 4) == Approx(0.5).epsilon(1e-2));
  CHECK(d.length(9, 3) == Approx(0.25).epsilon(1e-2));
  CHECK(d.length(8, 5) == Approx(0.25).epsilon(1e-2));
  for (const Contact& c : d.contacts) CHECK(c.gap == Approx(-deep).epsilon(1e-6));
}

TEST_CASE("an L over a step rests on the step and against its side", "[contact][detection]") {
  // The step's corner (vertex 2, at the origin) lies in the inner corner (vertex 3) of the L.
  const std::vector<Vec2> l_shape{{0.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-2.0, 1.0}, {-2.0, 0.0}, {0.0, 0.0}};
  Detection d(scene_with({fixed_block("step", rectangle(-5.0, -3.0, 5.0, 3.0)), free_block("block", l_shape)}));
  CHECK(d.contacts.size() == 4);
  const int arm_end = 4 + 4, foot = 4 + 0, under_arm = 4 + 4, side_of_foot = 4 + 5;
  CHECK(d.length(arm_end, 2) == Approx(1.0).epsilon(1e-14));
  CHECK(d.length(2, under_arm) == Approx(1.0).epsilon(1e-14));
  CHECK(d.length(foot, 1) == Approx(0.5).epsilon(1e-14));
  CHECK(d.length(2, side_of_foot) == Approx(0.5).epsilon(1e-14));
  for (const Contact& c : d.contacts) CHECK_FALSE(d.system.is_reflex(c.vertex));
}

TEST_CASE("a hollow underside rests on its two ends, its blunt inner corner touches nothing", "[contact][detection]") {
  Detection d(scene_with({fixed_block("base", rectangle(-10.0, -1.0, 20.0, 1.0)),
                          free_block("block", {{-1.0, 0.0}, {0.0, 0.02}, {1.0, 0.0}, {1.0, 1.0}, {-1.0, 1.0}})}));
  REQUIRE(d.system.is_reflex(5));
  CHECK(d.contacts.size() == 2);
  CHECK(d.length(4, 2) == Approx(0.5).epsilon(1e-3));
  CHECK(d.length(6, 2) == Approx(0.5).epsilon(1e-3));
}

TEST_CASE("diagonal blocks of a four-block corner do not touch", "[contact][detection]") {
  const double joint_angle = GENERATE(90.0, 60.0, 35.0) * degree, turn = GENERATE(0.0, 0.5, 2.0), disturbance = GENERATE(0.0, 1e-8, 1e-4);
  const Vec2 u(1.0, 0.0), v(std::cos(joint_angle), std::sin(joint_angle));
  Scene scene = test::empty_scene();
  for (const double y : {-1.0, 0.0}) {
    for (const double x : {-1.0, 0.0}) {
      scene.blocks.push_back(free_block("block", {x * u + y * v, (x + 1.0) * u + y * v, (x + 1.0) * u + (y + 1.0) * v, x * u + (y + 1.0) * v}));
    }
  }
  Detection d(turned(scene, turn, {10.0, 20.0}));
  std::mt19937 generator(12);
  std::uniform_real_distribution<double> number(-disturbance, disturbance);
  for (int trial = 0; trial < 100; ++trial) {
    const auto start = d.system.state();
    for (Contact& c : d.contacts) c.status = ContactStatus::sticking;  // the joints carry load
    for (int b = 0; b < 4; ++b) d.move(b, number(generator), number(generator), number(generator));
    d.update();
    double across = 0.0, neighbours = 0.0;
    for (const Contact& c : d.contacts) (c.vertex_block + c.edge_block == 3 ? across : neighbours) += c.length;
    // Corners that have moved past each other overlap by that much, on two pairs of edges of two pairs of blocks, and have no more length.
    CHECK(across <= 4.0 * 4.0 * disturbance);
    CHECK(neighbours == Approx(4.0).margin(1e-12 + 40.0 * disturbance));
    d.system.restore(start);
    if (disturbance == 0.0) break;
  }
}

namespace {

/// A block (blocks' vertices 8 to 11, front corner 9) on a plane of two fixed ones (vertices 0 to 3, 4 to 7) whose joint comes up under its front
/// corner at the origin; angles from the plane, uphill. The wall of the joint is edge 4 of the lower block, `drop` is the angle by which the top of
/// that block (edge 7) lies below the plane.
Detection corner_over_joint(double joint, double front, double drop) {
  const double lean = 1.0 / std::tan(joint), front_lean = 1.0 / std::tan(front);
  return Detection(scene_with({fixed_block("up", {{-8.0, 0.0}, {-8.0, -1.0}, {-lean, -1.0}, {0.0, 0.0}}),
                               fixed_block("down", {{0.0, 0.0}, {-lean, -1.0}, {8.0, -8.0}, {8.0, -8.0 * std::tan(drop)}}),
                               free_block("block", {{-2.0, 0.0}, {0.0, 0.0}, {front_lean, 1.0}, {-2.0, 1.0}})}));
}

}  // namespace

TEST_CASE("a block whose front corner stands on a joint is held neither by its wall nor at its front", "[contact][detection]") {
  const double joint = GENERATE(45.0, 60.0, 90.0, 110.0, 135.0) * degree, front = GENERATE(70.0, 90.0, 105.0) * degree;
  const double drop = GENERATE(-20.0, -8.0, 0.0, 8.0, 20.0, 40.0) * degree, closure = GENERATE(0.0, 1e-4);
  Detection d = corner_over_joint(joint, front, drop);
  double slid = 0.0;
  const auto require_free = [&] {
    for (const Contact& c : d.contacts) {
      if (c.vertex_block == 0 || c.edge_block == 0) continue;
      CAPTURE(joint / degree, front / degree, drop / degree, closure, c.vertex, c.edge, c.length);
      // Where joint and front face each other they overlap by what they have slid, and have no more length.
      CHECK(((c.vertex == 9 && c.edge == 7) || (c.vertex == 4 && c.edge == 8) || c.length <= closure + slid));
    }
  };
  require_free();
  d.move(2, 0.0, -closure);
  for (Contact& c : d.contacts) c.gap -= closure;
  for (int step = 0; step < 100; ++step) {
    for (Contact& c : d.contacts) c.status = c.gap <= 1e-12 ? ContactStatus::sliding : ContactStatus::open;
    d.update();
    require_free();
    // Down the plane, or up the top of the lower block where that rises.
    const double slip = closure == 0.0 ? 1e-3 : 0.1 * closure, rise = std::max(0.0, -std::tan(drop));
    d.move(2, slip, slip * rise);
    slid += slip;
  }
}

TEST_CASE("a step is no seam: the corner is met by its face", "[contact][detection]") {
  const double step = GENERATE(1.1e-3, 0.01, 0.3), deep = GENERATE(0.0, 1e-5);
  Detection d(scene_with({fixed_block("floor", rectangle(-5.0, -1.0, 5.0, 1.0)), fixed_block("step", rectangle(0.0, -1.0, 5.0, 1.0 + step)),
                          free_block("block", placed(rectangle(-1.0, 0.0, 1.0, 1.0), 30.0 * degree, {-0.2, 0.5}))}));
  for (Contact& c : d.contacts) c.status = ContactStatus::sliding;
  const Vec2 corner = d.system.position(2, 9), foot = d.system.position(1, 4);
  d.move(2, foot.x() - corner.x() + deep, foot.y() + 1.0 - corner.y());
  d.update();
  REQUIRE(d.find(9, 7) != nullptr);
  CHECK(d.find(9, 7)->gap == Approx(-deep).margin(1e-12));
}

TEST_CASE("of two feet tip to tip on one floor one of which hangs a little higher, one meets the other", "[contact][detection]") {
  // The lower tip lies in front of the upper one's face but for a hair, and farther beyond its end than corners may; the upper tip is before the
  // lower one's face. They are no corners that coincide.
  const Vec2 hangs(8.4e-8, 2e-6);
  Detection d(scene_with({fixed_block("floor", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("lower", {{0.0, 0.0}, {-0.253, 0.638}, {-1.523, 1.193}}),
                          free_block("upper", {hangs, hangs + Vec2(0.0535, 0.00926), hangs + Vec2(0.0835, 1.997)})}));
  for (Contact& c : d.contacts) c.status = c.vertex == 4 && c.edge_block == 0 ? ContactStatus::sliding : ContactStatus::open;
  d.update();
  CHECK(d.find(7, 4) != nullptr);
  CHECK(d.find(4, 9) == nullptr);
}

TEST_CASE("a corner that stands on another one stays there, one that falls on it is caught", "[contact][detection]") {
  // Tilted so far that only the corner touches.
  const double tilt = 20.0 * degree;
  Detection d(scene_with(
      {fixed_block("pillar", rectangle(-1.0, -1.0, 1.0, 1.0)), free_block("block", placed(rectangle(-1.0, 0.0, 1.0, 2.0), -tilt, {-1e-3, 0.0}))}));
  REQUIRE(d.find(5, 2) != nullptr);
  SECTION("standing") {
    d.find(5, 2)->status = ContactStatus::sticking;
    d.move(1, 1e-3, 0.0);
    d.update();
    CHECK(d.find(5, 2) != nullptr);
  }
  SECTION("falling") {
    d.move(1, 1e-3, -2e-5);
    d.update();
    CHECK_FALSE(d.contacts.empty());
  }
}

TEST_CASE("a corner above a thin slab is not in contact with its underside", "[contact][detection]") {
  const double thickness = GENERATE(1e-2, 1e-3, 1e-4);
  const double gap = GENERATE(1e-5, -1e-5, -6e-5);
  Detection d(scene_with({fixed_block("slab", rectangle(-5.0, -thickness, 10.0, thickness)), free_block("block", rectangle(0.0, gap, 2.0, 1.0)),
                          free_block("tip", placed(rectangle(0.0, 0.0, 1.0, 1.0), 45.0 * degree, {-2.0, gap}))}));
  CHECK(d.contacts.size() == 3);
  for (const Contact& c : d.contacts) {
    CHECK(c.edge == 2);
    CHECK(c.gap == Approx(gap).epsilon(1e-9));
  }
}

TEST_CASE("corners touch only edges they come to from outside", "[contact][detection]") {
  // Left block beside the right one: none of its corners touches top or bottom of the other, however near they are.
  Detection d(scene_with({free_block("left", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("right", rectangle(1.0, 0.0, 1.0, 1.0))}), 0.5);
  REQUIRE(d.contacts.size() == 2);
  for (const Contact& c : d.contacts) CHECK((c.edge == 1 || c.edge == 7));
  CHECK(d.total_length() == Approx(1.0).epsilon(1e-14));
}

TEST_CASE("boxes at random places on a line touch over their overlap", "[contact][detection]") {
  std::mt19937 generator(13);
  std::uniform_real_distribution<double> place(-2.0, 2.0), width(0.1, 3.0);
  int touching = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const double xa = place(generator), wa = width(generator), xb = place(generator), wb = width(generator);
    const double overlap = overlap_of(xa, xa + wa, xb, xb + wb);
    const double angle = place(generator);
    const std::vector<BlockInput> blocks{free_block("below", rectangle(xa, -1.0, wa, 1.0)), free_block("above", rectangle(xb, 0.0, wb, 1.0))};
    Detection one(turned(scene_with({blocks[0], blocks[1]}), angle, {0.0, 0.0})),
        other(turned(scene_with({blocks[1], blocks[0]}), angle, {0.0, 0.0}));
    CHECK(one.total_length() == Approx(overlap).margin(1e-12));
    REQUIRE(one.contacts.size() == other.contacts.size());
    for (const Contact& c : one.contacts) CHECK(other.length((c.vertex + 4) % 8, (c.edge + 4) % 8) == Approx(c.length).margin(1e-12));
    touching += one.contacts.size() == 2 ? 1 : 0;
  }
  CHECK(touching > 200);
}

TEST_CASE("corners that are left out because they are too far from the other block would have touched nothing", "[contact][detection]") {
  // Every corner of a pair that was in contact is looked at.
  Contact known;
  known.vertex_block = 1;
  known.vertex = 4;
  const double reach = GENERATE(0.02, 0.2, 1.0);
  std::mt19937 generator(17);
  std::uniform_real_distribution<double> size(0.2, 3.0), corner_angle(20.0 * degree, 160.0 * degree), place(-3.0, 3.0), share(-0.1, 1.2),
      tilt(-16.0 * degree, 16.0 * degree);
  const auto leaning = [&] {
    const double width = size(generator), angle = corner_angle(generator);
    const Vec2 up = size(generator) * Vec2(std::cos(angle), std::sin(angle));
    return std::vector<Vec2>{{0.0, 0.0}, {width, 0.0}, Vec2(width, 0.0) + up, up};
  };
  std::size_t contacts = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::vector<Vec2> below = leaning();
    const std::vector<Vec2> above = placed(leaning(), tilt(generator), Vec2(place(generator), below[2].y() + reach * share(generator)));
    const Detection all_new(turned(scene_with({fixed_block("below", below), free_block("above", above)}), place(generator), {0.0, 0.0}), reach);
    ContactSet set{{known}, {}};
    Detector detector(reach, {true, false, true, 0.0});
    REQUIRE(detector.update(all_new.system, all_new.joints, set));
    const std::vector<Contact>& found = set.moving;
    REQUIRE(found.size() == all_new.contacts.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      CHECK(found[i].vertex == all_new.contacts[i].vertex);
      CHECK(found[i].edge == all_new.contacts[i].edge);
      CHECK(found[i].length == all_new.contacts[i].length);
    }
    contacts += found.size();
  }
  CHECK(contacts > 1000);
}

TEST_CASE("a joint that has closed under one of two corners stays closed for the other one, through however thin a slab", "[contact][detection]") {
  // What has gone 20 mm into a slab of 2 mm is farther behind its underside than any new corner that could touch it.
  Scene scene = scene_with({fixed_block("slab", rectangle(0.0, -0.002, 5.0, 0.002)), free_block("block", rectangle(0.5, -0.02, 2.0, 1.0))});
  const Detection all_new(scene, 1e-3);
  CHECK(all_new.contacts.empty());
  Contact known;  // of the slab's corner, while it was the nearer one
  known.vertex_block = 0;
  known.vertex = 3;
  known.edge_block = 1;
  known.edge = 4;
  known.gap = -0.02;
  known.status = ContactStatus::sticking;
  ContactSet set{{known}, {}};
  Detector detector(1e-3, {true, false, true, 0.0});
  REQUIRE(detector.update(all_new.system, all_new.joints, set));
  const std::vector<Contact>& found = set.moving;
  REQUIRE(found.size() == 1);
  CHECK(found[0].vertex == 4);
  CHECK(found[0].edge == 2);
  CHECK(found[0].gap == Approx(-0.02));
}

TEST_CASE("a corner that leans on one block is opposite to another one's edge up to twice its closure beyond the end, in steps however short",
          "[contact][detection]") {
  constexpr double closure = 1e-3;
  const double beyond = GENERATE(0.5, 1.9, 2.1) * closure;
  // The side that leans over the wall by 10 degrees is neither quite parallel to it nor turned away.
  const double lean = std::tan(10.0 * degree);
  const Scene scene = scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)),
                                  free_block("block", {{0.0, -closure}, {2.0, -closure}, {2.0, 1.0 - closure}, {lean, 1.0 - closure}}),
                                  fixed_block("wall", rectangle(-1.0001, beyond - closure, 1.0, 1.0))});
  Contact known;
  known.vertex_block = 1;
  known.vertex = 4;
  known.edge_block = 0;
  known.edge = 2;
  known.gap = -closure;
  known.status = ContactStatus::sticking;
  ContactSet set{{known}, {}};
  const BlockSystem system(scene);
  const JointTable joints(scene);
  constexpr double reach = 2e-4;  // [m] of steps of 0.1 mm
  Detector detector(reach, {true, false, true, 0.0});
  REQUIRE(detector.update(system, joints, set));
  const bool meets = std::ranges::any_of(set.moving, [](const Contact& c) { return c.vertex == 4 && c.edge == 9; });
  CHECK(meets == (beyond < 2.0 * closure));
}

TEST_CASE("a block does not catch on a flush seam that leans towards it, before it is there", "[contact][detection]") {
  // Its front face and the far side of the seam are not parallel, so that along the line between them they overlap by a part of what is between them.
  const double lean = GENERATE(-10.0, -5.0, -1.0, 1.0, 5.0, 10.0) * degree;
  const double sunk = GENERATE(0.0, 1e-8, 1e-4);
  const double before = GENERATE(0.01, 0.04);  // [m] from the seam
  const double back = std::tan(lean);
  const bool is_ground = GENERATE(true, false);  // in one body of fixed blocks the seam's ends are no corners
  const std::vector<Vec2> near{{-5.0, -1.0}, {-back, -1.0}, {0.0, 0.0}, {-5.0, 0.0}}, far{{-back, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {0.0, 0.0}};
  Detection d(scene_with({is_ground ? fixed_block("near", near) : free_block("near", near),
                          is_ground ? fixed_block("far", far) : free_block("far", far), free_block("block", rectangle(-1.5, -sunk, 1.0, 0.3))}),
              0.05);
  for (Contact& c : d.contacts) c.status = ContactStatus::sliding;
  d.move(2, 0.5 - before, 0.0);
  d.update();
  CAPTURE(lean, sunk, before, is_ground);
  CHECK(d.find(9, 7) == nullptr);  // its front corner on the far side
  CHECK(d.find(7, 9) == nullptr);  // the far one's corner on its front
  CHECK(d.find(9, 2) != nullptr);
}

TEST_CASE("tips that meet where joints cross at a small angle do not touch while there are wedges between them", "[contact][detection]") {
  // Below both joints (0), above both (1), the wedge behind (2) and what is ahead.
  const auto [steep, shallow] = GENERATE(std::pair(12.0, 4.0), std::pair(17.0, 3.0));
  CAPTURE(steep, shallow);
  const auto at = [](double x, double slope) { return Vec2(x, x * std::tan(slope * degree)); };
  const Vec2 corner(0.0, 0.0), low = at(-3.0, steep), middle = at(-3.0, 0.5 * (steep + shallow)), high = at(-3.0, shallow);
  std::vector<BlockInput> blocks{fixed_block("below", {{-3.0, -3.0}, {3.0, -3.0}, at(3.0, shallow), corner, low}),
                                 free_block("above", {high, corner, at(3.0, steep), {3.0, 3.0}, {-3.0, 3.0}})};
  const auto touch = [&](int a, int b) {
    const Detection d(scene_with(blocks));
    return std::ranges::any_of(d.contacts, [&](const Contact& c) { return std::pair(a, b) == std::minmax({c.vertex_block, c.edge_block}); });
  };
  CHECK(touch(0, 1));
  const bool is_fixed = GENERATE(false, true);
  const std::vector<Vec2> behind{corner, at(3.0, shallow), at(3.0, steep)};
  blocks.push_back(is_fixed ? fixed_block("behind", behind) : free_block("behind", behind));
  CHECK(touch(0, 1));
  SECTION("with one block in each") {
    blocks.push_back(free_block("ahead", {low, corner, high}));
    CHECK(touch(0, 3));
    CHECK(touch(1, 3));
  }
  SECTION("with two, parted by the line half-way") {
    blocks.push_back(free_block("lower", {low, corner, middle}));
    CHECK(touch(1, 3));
    blocks.push_back(free_block("upper", {middle, corner, high}));
    CHECK_FALSE(touch(1, 3));
    CHECK_FALSE(touch(0, 4));
    CHECK(touch(3, 4));
  }
  if (!is_fixed) CHECK_FALSE(touch(0, 1));
  // If it is fixed, it is one body with what is below, and the corner is an end of the steep joint.
  const Detection d(scene_with(blocks));
  for (const Contact& c : d.contacts) {
    if (std::pair(0, 1) != std::minmax({c.vertex_block, c.edge_block})) continue;
    const Vec2 along = d.system.arm(d.system.next(c.edge)) - d.system.arm(c.edge);
    CHECK(std::abs(along.y() / along.x()) == Approx(std::tan(steep * degree)));
  }
}

TEST_CASE("a fixed wedge between the tips of two blocks keeps them from touching, though it is no part of the fixed one", "[contact][detection]") {
  // Both wedges lie between the edges of the blocks below and above, which cross at eight degrees, and along none of them.
  const auto tip_at = [](double x, double slope) { return Vec2(x, x * std::tan(slope * degree)); };
  const Vec2 corner(0.0, 0.0);
  const std::vector<Vec2> behind{corner, tip_at(3.0, 7.0), tip_at(3.0, 9.0)}, ahead{tip_at(-3.0, 9.0), corner, tip_at(-3.0, 7.0)};
  const bool is_fixed = GENERATE(false, true);
  CAPTURE(is_fixed);
  const Detection d(scene_with({fixed_block("below", {{-3.0, -3.0}, {3.0, -3.0}, tip_at(3.0, 4.0), corner, tip_at(-3.0, 12.0)}),
                                free_block("above", {tip_at(-3.0, 4.0), corner, tip_at(3.0, 12.0), {3.0, 3.0}, {-3.0, 3.0}}),
                                is_fixed ? fixed_block("behind", behind) : free_block("behind", behind),
                                is_fixed ? fixed_block("ahead", ahead) : free_block("ahead", ahead)}));
  for (const Contact& c : d.contacts) CHECK(std::pair(0, 1) != std::minmax({c.vertex_block, c.edge_block}));
}

TEST_CASE("two wedges side by side touch along the joint between them alone", "[contact][detection]") {
  // Their outer edges (0 and 5) are less than 15 degrees from each other and turn their backs to each other.
  const auto at = [](double slope) { return Vec2(3.0, 3.0 * std::tan(slope * degree)); };
  const double lower = GENERATE(15.8, 17.0, 18.0);
  Detection d(scene_with({fixed_block("under", {{0.0, 0.0}, at(lower), at(18.4)}), free_block("above", {{0.0, 0.0}, at(18.4), at(30.4)})}));
  REQUIRE_FALSE(d.contacts.empty());
  for (const Contact& c : d.contacts) CHECK((c.edge == 2 || c.edge == 3));
}

TEST_CASE("a block that leans on another one of its width keeps the contact at the corner that it leans from", "[contact][detection]") {
  Detection d(scene_with({fixed_block("lower", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("upper", rectangle(0.0, 1.0, 1.0, 1.0))}));
  REQUIRE(d.contacts.size() == 2);
  const double lean = GENERATE(-1e-5, -5e-4, 5e-4);
  d.move(1, 0.0, -0.5 * std::abs(lean), lean);
  d.update();
  CHECK(d.contacts.size() == 2);
  CHECK(d.total_length() == Approx(1.0).epsilon(1e-3));
}

TEST_CASE("a corner comes off the end of an edge at once, though lists of contacts are kept", "[contact][detection]") {
  // Two bricks side by side, whose lower corners coincide, the right and taller one of which turns about its far corner: its own one (8) rises along
  // the other's side (5), and the other's corner (5) is below its side (11).
  Detection d(scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("left", rectangle(0.0, 0.0, 1.0, 0.6)),
                          free_block("right", rectangle(1.0, 0.0, 1.0, 0.8))}),
              0.05, DetectionSkips());
  REQUIRE(d.find(5, 11) != nullptr);
  const double angle = -1e-5;
  const Vec2 arm(-0.5, 0.4);  // of the right one's middle
  const Vec2 way = Motion::turned_by(angle, arm, RotationKind::exact);
  d.move(2, way.x(), way.y(), angle);
  d.update();
  CHECK(d.find(5, 11) == nullptr);
  REQUIRE(d.find(8, 5) != nullptr);
  CHECK(d.find(8, 5)->gap >= 0.0);
  CHECK(d.detector.counters().searches == 1);
}

TEST_CASE("a corner deep in the floor of a wide box does not touch the back of its walls", "[contact][detection]") {
  // A wedge has gone into the floor with its lower side ahead, so that its tip (8) faces neither floor nor underside but, 90 m away, a wall's back.
  const double tilt = GENERATE(-1.0, 1.0);  // the tip to the right or, seen in a mirror, to the left
  std::vector<Vec2> wedge{{40.0, -0.3}, {30.2, 1.4}, {30.6, -3.7}};
  if (tilt < 0.0) wedge = {{-40.0, -0.3}, {-30.6, -3.7}, {-30.2, 1.4}};
  Detection d(scene_with(
      {fixed_block("box", {{-54, -8}, {54, -8}, {54, 30}, {50, 30}, {50, 0}, {-50, 0}, {-50, 30}, {-54, 30}}), free_block("wedge", wedge)}));
  REQUIRE(d.find(tilt > 0.0 ? 10 : 9, 4) != nullptr);  // its other lower corner has come in through the floor
  for (const Contact& c : d.contacts) CHECK(c.edge == 4);
}

TEST_CASE("a block wholly inside another one is pushed to the nearest face only", "[contact][detection]") {
  Detection d(scene_with({fixed_block("base", rectangle(-50.0, -20.0, 100.0, 20.0)), free_block("block", rectangle(0.0, -1.5, 1.0, 1.0))}));
  REQUIRE_FALSE(d.contacts.empty());
  for (const Contact& c : d.contacts) CHECK(c.edge == 2);
}

TEST_CASE("joints are those of the two materials", "[contact][detection]") {
  Scene scene = scene_with({fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", rectangle(0.0, 0.0, 2.0, 1.0)),
                            free_block("top", rectangle(0.0, 1.0, 2.0, 1.0))});
  scene.materials.push_back({"lead", 11300.0});
  scene.blocks[2].material = 1;
  scene.joints.push_back(scene.joints[0]);
  scene.joints[1].materials = {1, 0};
  Detection d(scene);
  REQUIRE(d.contacts.size() == 4);
  for (const Contact& c : d.contacts) CHECK(c.joint == (std::max(c.vertex_block, c.edge_block) == 2 ? 1 : 0));
}

TEST_CASE("two feet that slide towards each other on one floor meet", "[contact][detection]") {
  // Both lean away from each other, so that neither tip lies opposite to the other one's side before they have passed each other.
  const double apart = GENERATE(1e-2, 1e-5, 3e-7, 0.0, -3e-7, -5e-6);
  Detection d(scene_with({fixed_block("floor", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("left", {{-2.0, 0.0}, {0.0, 0.0}, {-1.0, 2.0}}),
                          free_block("right", {{0.02, 0.0}, {2.0, 0.0}, {1.0, 1.0}})}));
  for (int step = 0; step < 2; ++step) {
    for (Contact& c : d.contacts) c.status = c.edge_block == 0 ? ContactStatus::sliding : ContactStatus::open;
    d.move(1, step == 0 ? 0.005 : 0.015 - apart, 0.0);
    d.update();
  }
  CAPTURE(apart);
  const auto between = std::count_if(d.contacts.begin(), d.contacts.end(), [](const Contact& c) { return c.vertex_block + c.edge_block == 3; });
  CHECK(between >= 1);
}

TEST_CASE("two tips that slide towards each other along a wall do not pass each other on", "[contact][detection]") {
  // The faces by which they meet are 16 degrees from parallel: each of the two lines parts the blocks as well as the other.
  const double apart = GENERATE(0.02, 0.01, 1e-3);
  const double slope = std::tan(8.0 * degree);
  Detection d(scene_with({fixed_block("wall", rectangle(-1.0, -5.0, 1.0, 10.0)),
                          free_block("upper", placed({{0.0, 0.0}, {2.0, 2.0 * slope}, {1.0, 3.0}}, 0.0, {0.0, apart})),
                          free_block("lower", {{0.0, 0.0}, {1.0, -3.0}, {2.0, -2.0 * slope}})}));
  for (Contact& c : d.contacts) c.status = c.edge_block == 0 ? ContactStatus::sliding : ContactStatus::open;
  d.move(1, 0.0, -2e-6);
  d.detector.look_again();
  d.update();
  CAPTURE(apart);
  const auto between = std::count_if(d.contacts.begin(), d.contacts.end(), [](const Contact& c) { return c.vertex_block + c.edge_block == 3; });
  CHECK(between >= 1);
}

TEST_CASE("a corner that slides down a wall meets the other wall of an obtuse notch", "[contact][detection]") {
  const double before = GENERATE(0.02, 1e-2, 1e-4);  // [m] of the notch's corner, vertex 3
  Detection d(scene_with({fixed_block("base", {{-3.0, -2.0}, {3.0, -2.0}, {3.0, 1.0}, {0.0, 0.0}, {-3.0, 0.0}}),
                          free_block("block", placed({{0.0, 0.0}, {1.0, 2.0}, {-1.0, 2.0}}, 0.0, Vec2(-before, 0.0)))}));
  REQUIRE(d.system.is_reflex(3));
  CHECK(d.find(5, 3) != nullptr);
  CHECK(d.find(5, 2) != nullptr);
}

TEST_CASE("a blunt corner at the tip of a thin wedge does not hold the wedge's outer side", "[contact][detection]") {
  // A slope whose face is steeper than the joint under the wedge by half a degree: the wedge tapers to a tip at the blunt corner where both meet.
  const double joint = 51.0 * test::degree, face = 51.5 * test::degree, length = 1.0;
  const Vec2 up_joint = length * Vec2(std::cos(joint), std::sin(joint)), up_face = length * Vec2(std::cos(face), std::sin(face));
  const Detection d(test::scene_with({test::fixed_block("slope", {Vec2(0.0, 0.0), -up_face, Vec2(3.0, -1.0), Vec2(3.0, 3.0), up_joint}),
                                      test::free_block("wedge", {Vec2(0.0, 0.0), up_joint, up_face})}));
  for (const Contact& c : d.contacts) {
    const Vec2 normal = perpendicular(d.system.arm(d.system.next(c.edge)) - d.system.arm(c.edge)).normalized();
    const double along_joint = std::abs(normal.dot(up_joint));
    INFO("corner " << c.vertex << " on edge " << c.edge);
    CHECK(along_joint < 1e-12);
    if (c.vertex_block == 0) CHECK(c.edge == 5);
  }
  CHECK(d.total_length() == Approx(length));
}

TEST_CASE("a corner that has come past the tip of a wedge does not touch its far side from behind", "[contact][detection]") {
  // The wedge's tip (2) is about to touch the other block's face (6); that block's lowest corner (3) lies beside the wedge.
  Detection d(scene_with({fixed_block("wedge", {{-0.0106, -0.0105}, {-0.0120, -0.0315}, {0.0, 0.0}}),
                          free_block("block", {{4.23e-4, -8.15e-4}, {4.23e-4, 0.0366}, {-0.0067, 0.0309}, {-0.0075, 0.0270}})}));
  CHECK(d.find(2, 6) != nullptr);
  for (const Contact& c : d.contacts) CHECK(c.gap > 0.0);
}

TEST_CASE("a needle's tip that has gone right through another tip is held by the line that they are least behind", "[contact][detection]") {
  // The needle's tip (3) lies below the other block's tip (0), so that neither is in the other block; their sides cross. The other block's tip is
  // behind the needle's upper side (5) by less than the needle's tip is behind its face (0). Seen in a mirror the same.
  const bool mirrored = GENERATE(false, true);
  const double way = GENERATE(1.0, 0.1, 1e2);
  const auto seen = [&](std::vector<Vec2> polygon) {
    if (mirrored) {
      for (Vec2& p : polygon) p.x() = -p.x();
      std::reverse(polygon.begin() + 1, polygon.end());
    }
    return polygon;
  };
  const Vec2 tip = way * Vec2(-4.6e-5, -4.3e-6);
  const auto edge_from = [&](int from, int to) { return mirrored ? to : from; };
  Detection d(scene_with({free_block("block", seen({Vec2(0.0, 0.0), at(0.07, 41.7), at(0.1, 169.0)})),
                          free_block("needle", seen({Vec2(0.05, 0.0), Vec2(0.05, 0.0) + at(0.2, 11.0), Vec2(0.05, 0.0) + at(0.1, 25.5)}))}));
  d.move(1, (mirrored ? -1.0 : 1.0) * (tip.x() - 0.05), tip.y());
  d.update();
  CAPTURE(mirrored, way);
  const int upper_side = edge_from(5, 3);
  REQUIRE(d.contacts.size() == 1);
  REQUIRE(d.find(0, upper_side) != nullptr);
  CHECK(d.find(0, upper_side)->gap == Approx(-perpendicular(at(1.0, 25.5)).dot(tip)).margin(1e-12));
}

TEST_CASE("tips that have gone right through each other are held by the one line that they are least behind", "[contact][detection]") {
  // Neither tip is in the other block, and both sides of one cross both sides of the other. The other block's tip (3) is behind the block's side (0);
  // the block's tip (0) is behind the other one's side (5) by less.
  struct Tips {
    double first, second;                    // [deg] of the block's two sides
    double first_of_other, second_of_other;  // [deg] of the other's
    Vec2 start, end;                         // [m] of its tip; the block's is the origin
  };
  // A blunt tip and a sharp one, 0.2 mm and 8 micrometres through each other.
  const Tips t = GENERATE(values<Tips>(
      {{49.6, 125.2, 335.9, 355.0, {-0.0111, 0.0066}, {-1.55e-4, 1.81e-4}}, {174.8, 254.6, 131.6, 151.1, {0.0084, -0.0107}, {-2.6e-7, -8.35e-6}}}));
  Detection d(scene_with({free_block("block", {Vec2(0.0, 0.0), at(0.07, t.first), at(0.1, t.second)}),
                          free_block("other", {t.start, t.start + at(0.2, t.first_of_other), t.start + at(0.1, t.second_of_other)})}));
  d.move(1, t.end.x() - t.start.x(), t.end.y() - t.start.y());
  d.update();
  CAPTURE(t.first);
  const double behind_side_of_other = perpendicular(at(1.0, t.second_of_other)).dot(t.end);
  REQUIRE(behind_side_of_other < perpendicular(at(1.0, t.first)).dot(t.end));
  REQUIRE(d.contacts.size() == 1);
  REQUIRE(d.find(0, 5) != nullptr);
  CHECK(d.find(0, 5)->gap == Approx(-behind_side_of_other).margin(1e-12));
}

TEST_CASE("a needle's tip just ahead of a side does not hold the far end of that side, however narrow the angle between them",
          "[contact][detection]") {
  // The tip (3) is some micrometres ahead of the block's side (2), within the angle of edges that face each other; the side's far end (2) is 20 mm
  // behind the needle's own side (3). The needle comes from one side of the block's tip or from the other.
  struct Pair {
    double first, second;                      // [deg] of the block's two sides
    double first_of_needle, second_of_needle;  // [deg]
    Vec2 start, end;                           // [m] of its tip; the block's is the origin
  };
  const Pair p = GENERATE(values<Pair>(
      {{17.0, 41.6, 27.5, 36.1, {0.0183, -0.0141}, {1.01e-6, 6.89e-6}}, {108.9, 181.5, 170.1, 178.6, {0.0137, 0.0125}, {2.77e-6, -2.52e-6}}}));
  Detection d(scene_with({free_block("block", {Vec2(0.0, 0.0), at(0.07, p.first), at(0.1, p.second)}),
                          free_block("needle", {p.start, p.start + at(0.2, p.first_of_needle), p.start + at(0.1, p.second_of_needle)})}));
  d.move(1, p.end.x() - p.start.x(), p.end.y() - p.start.y());
  d.update();
  CAPTURE(p.first);
  REQUIRE(d.contacts.size() == 1);
  CHECK(d.contacts[0].gap > 0.0);
}

TEST_CASE("a needle that has come off the face that held it, behind its line, is held by the other block's tip", "[contact][detection]") {
  // The needle's tip (3) has slid down the face (0) of the other block to past its end and stands 37 micrometres behind its line, in no block any
  // more; the needle's upper side (5) has come behind the other block's tip (0).
  const Vec2 along = at(1.0, 37.0), inwards = at(1.0, 127.0), on_face = 6e-4 * along;
  const double depth = 3.7e-5, beyond = GENERATE(5.4e-5, 2e-5);
  Detection d(scene_with({free_block("block", {Vec2(0.0, 0.0), along, at(1.0, 157.0)}),
                          free_block("needle", {on_face, on_face + at(3.0, 1.5), on_face + at(2.0, 14.8)})}));
  REQUIRE(d.find(3, 0) != nullptr);
  d.find(3, 0)->status = ContactStatus::sliding;
  const Vec2 tip = depth * inwards - beyond * along;
  d.move(1, tip.x() - on_face.x(), tip.y() - on_face.y());
  d.find(3, 0)->gap = -depth;
  d.update();
  CAPTURE(beyond);
  REQUIRE(d.contacts.size() == 1);
  REQUIRE(d.find(0, 5) != nullptr);
  CHECK(d.find(0, 5)->gap == Approx(-perpendicular(at(1.0, 14.8)).dot(tip)).margin(1e-12));
}

TEST_CASE("a needle's tip in the side of a block does not hold the block's far end", "[contact][detection]") {
  // The tip of the upper block (15) is in the right side of the lower one, far beyond the end of the short side (8) at its left; that end (0) is
  // behind the line along the upper block's side (15), far beyond the block.
  const double lift = 0.02;  // [m] within reach, so that all corners are looked at
  const std::vector<Vec2> lower{{-22.6803, 1.7895}, {-22.4331, 1.3109}, {-20.9390, 0.1968}, {-18.7395, 0.0025}, {-18.9423, 0.3649},
                                {-19.1071, 0.5496}, {-21.7289, 2.0163}, {-22.4404, 2.0644}, {-22.6370, 1.9495}};
  const std::vector<Vec2> upper{{-19.1748, 1.8349}, {-19.7415, 2.3939}, {-20.1762, 2.6933}, {-21.1559, 3.1544},
                                {-21.8506, 3.3243}, {-22.9573, 2.7036}, {-19.4190, 0.7241}};
  Detection d(scene_with({free_block("lower", lower), free_block("upper", placed(upper, 0.0, {0.0, lift}))}));
  d.move(1, 0.0, -lift - 1e-3);
  d.update();
  REQUIRE_FALSE(d.contacts.empty());
  for (const Contact& c : d.contacts) CHECK(c.gap > -0.01);
}

TEST_CASE("a block that has gone into another one through one side does not hold the far end of another side", "[contact][detection]") {
  // Caught between two steps of a fast impact. First: the end (3) of the lower block's upper side is in the upper block's lower side, and that side's
  // line is far in front of the upper block's corner (3), beyond its own block. Second: the tip of the lower block, with three corners, has come in
  // through the side of the upper one, whose right corner (0) is far behind the lower block's left side.
  const std::vector<Vec2> first_upper{{3.434130, 2.251201}, {3.346770, 2.261538}, {3.336431, 2.262069}, {3.195592, 2.256349},
                                      {3.091202, 2.230032}, {3.309922, 2.115584}, {3.334148, 2.116158}, {3.481439, 2.138074}};
  const std::vector<Vec2> first_lower{{3.296511, 2.123705}, {3.235266, 2.160292}, {2.935842, 2.108793}, {2.863787, 2.062453}, {2.854515, 2.054097}};
  const std::vector<Vec2> second_upper{{0.887900, 2.000646}, {0.990436, 2.248918}, {0.853178, 2.217326}, {0.832305, 2.181066},
                                       {0.809686, 2.057575}, {0.822795, 2.020474}, {0.837410, 2.005000}, {0.841374, 2.002497}};
  const std::vector<Vec2> second_lower{{0.832906, 2.038892}, {0.830648, 2.034475}, {0.826263, 2.023336}, {0.822759, 2.011531}, {0.816517, 1.980996},
                                       {0.809913, 1.884794}, {0.823475, 1.773198}, {0.830606, 1.757466}, {0.876301, 1.890662}};
  const double lift = 0.04;  // [m] clear of each other, and within reach
  for (const auto& [upper, lower, deepest] : {std::tuple(first_upper, first_lower, 0.006), std::tuple(second_upper, second_lower, 0.03)}) {
    Detection d(scene_with({free_block("upper", placed(upper, 0.0, {0.0, lift})), free_block("lower", lower)}));
    d.move(0, 0.0, -lift);
    d.update();
    REQUIRE_FALSE(d.contacts.empty());
    for (const Contact& c : d.contacts) CHECK(c.gap > -deepest);
  }
}

namespace {

/// [m] Of two convex blocks: by the line along an edge of one of them that parts them most; negative if they overlap.
double parted_by(const BlockSystem& system, int a, int b) {
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& [of, from] : {std::pair(a, b), std::pair(b, a)}) {
    const auto &edges = system.block(of), &corners = system.block(from);
    for (int e = edges.first_vertex; e < edges.first_vertex + edges.vertex_count; ++e) {
      const Vec2 start = system.position(of, e), along = (system.position(of, system.next(e)) - start).normalized();
      double least = std::numeric_limits<double>::infinity();
      for (int v = corners.first_vertex; v < corners.first_vertex + corners.vertex_count; ++v) {
        least = std::min(least, -cross(along, system.position(from, v) - start));
      }
      most = std::max(most, least);
    }
  }
  return most;
}

}  // namespace

TEST_CASE("two tips that overlap have a contact, whichever way they have come past each other", "[contact][detection]") {
  // Of two convex blocks that overlap, the line that they are least behind has the foot of its corner between the ends of its edge: there is always a
  // contact to be found.
  std::mt19937 random(20);
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  constexpr double deepest = 1e-4, stride = 2e-5;  // [m]
  int overlaps = 0;
  for (int pair = 0; pair < 300; ++pair) {
    const double left = draw(0.0, 360.0), right = left + 180.0 + draw(-60.0, 60.0), wide = draw(10.0, 170.0), narrow = draw(5.0, 60.0);
    Scene scene = scene_with(
        {free_block("wide", {Vec2(0.0, 0.0), at(1.0, left - 0.5 * wide), at(1.0, left + 0.5 * wide)}),
         free_block("narrow", placed({Vec2(0.0, 0.0), at(2.0, right - 0.5 * narrow), at(2.0, right + 0.5 * narrow)}, 0.0, at(3e-4, left + 180.0)))});
    Detection d(scene);
    for (int step = 0; step < 200; ++step) {
      const Vec2 way = at(stride, draw(0.0, 360.0)) + 2e-6 * at(1.0, left) * (parted_by(d.system, 0, 1) > 0.0 ? 5.0 : -1.0);
      d.move(1, way.x(), way.y());
      if (parted_by(d.system, 0, 1) < -deepest) d.move(1, -way.x(), -way.y());
      double closure = 0.0;
      for (Contact& c : d.contacts) {
        c.status = c.gap < 0.0 ? ContactStatus::sliding : ContactStatus::open;
        closure = std::max(closure, -c.gap);
      }
      d.update();
      const double parted = parted_by(d.system, 0, 1);
      if (parted > -tolerance::edge_end_m - tolerance::seam_closures * closure) continue;
      ++overlaps;
      CAPTURE(pair, step, left, right, wide, narrow, parted, closure);
      CHECK(std::ranges::any_of(d.contacts, [](const Contact& c) { return c.gap < 0.0; }));
    }
  }
  CHECK(overlaps > 1000);
}
