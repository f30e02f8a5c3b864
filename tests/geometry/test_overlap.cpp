#include <cmath>
#include <numbers>
#include <random>

#include "openclose/core/tolerance.h"
#include "openclose/geometry/overlap.h"
#include "openclose/geometry/touching_outlines.h"
#include "support/catch.h"
#include "support/polygons.h"

using namespace openclose;
using builders::placed;
using builders::rectangle_between;

namespace {

const Polygon square = rectangle_between({0.0, 0.0}, {1.0, 1.0});

/// A base of 4 x 2 with a notch of 1 x 1 in the middle of its top.
const Polygon notched{{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {2.5, 2.0}, {2.5, 1.0}, {1.5, 1.0}, {1.5, 2.0}, {0.0, 2.0}};

/// Symmetric by definition; checked wherever a depth is asked for.
double depth(const Polygon& a, const Polygon& b) {
  const double there = overlap_depth(a, b);
  CHECK(overlap_depth(b, a) == there);
  return there;
}

}  // namespace

TEST_CASE("polygons apart do not overlap", "[geometry][overlap]") {
  CHECK(depth(square, rectangle_between({2.0, 0.0}, {3.0, 1.0})) == 0.0);
  CHECK(depth(square, rectangle_between({1.0 + 1e-6, 0.0}, {2.0, 1.0})) == 0.0);
  // The boxes overlap, the polygons do not.
  CHECK(depth({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, {{1.0, 1.0}, {0.2, 1.0}, {1.0, 0.2}}) == 0.0);
}

TEST_CASE("touching is not overlapping", "[geometry][overlap]") {
  SECTION("whole edge") {
    CHECK(depth(square, rectangle_between({1.0, 0.0}, {2.0, 1.0})) == 0.0);
  }
  SECTION("part of an edge: T-junctions") {
    CHECK(depth(square, rectangle_between({1.0, 0.25}, {2.0, 0.75})) == 0.0);
    CHECK(depth(square, rectangle_between({1.0, 0.5}, {2.0, 3.0})) == 0.0);
  }
  SECTION("corner on corner, corner on edge") {
    CHECK(depth(square, rectangle_between({1.0, 1.0}, {2.0, 2.0})) == 0.0);
    CHECK(depth(square, {{1.0, 0.5}, {2.0, 0.0}, {2.0, 1.0}}) == 0.0);
  }
  SECTION("a block in a notch, filling it or not, or standing out") {
    CHECK(depth(notched, rectangle_between({1.5, 1.0}, {2.5, 2.0})) == 0.0);
    CHECK(depth(notched, rectangle_between({1.5, 1.0}, {2.0, 1.5})) == 0.0);
    CHECK(depth(notched, rectangle_between({1.5, 1.0}, {2.5, 4.0})) == 0.0);
  }
}

TEST_CASE("rounding of turned and shifted neighbours is not overlapping", "[geometry][overlap]") {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  const double distance = GENERATE(1.0, 1e3, 1e6);
  std::uniform_real_distribution<double> coordinate(-distance, distance);
  for (int i = 0; i < 200; ++i) {
    const double turn = angle(generator);
    const Vec2 shift(coordinate(generator), coordinate(generator));
    const auto turned = [&](const Polygon& polygon) { return placed(polygon, turn, shift); };
    CHECK(depth(turned(square), turned(rectangle_between({1.0, 0.0}, {2.0, 1.0}))) == 0.0);
    CHECK(depth(turned(square), turned(rectangle_between({1.0, 0.3}, {2.0, 2.3}))) == 0.0);
    CHECK(depth(turned(notched), turned(rectangle_between({1.5, 1.0}, {2.5, 2.0}))) == 0.0);
    CHECK(depth(turned(notched), turned(rectangle_between({1.5, 1.0}, {2.1, 3.0}))) == 0.0);
  }
}

TEST_CASE("an overlap of rounding size stays of rounding size", "[geometry][overlap]") {
  const double pushed = 1e-9;
  CHECK(depth(square, rectangle_between({1.0 - pushed, 0.0}, {2.0, 1.0})) == 0.0);
  CHECK(depth(notched, rectangle_between({1.5 - pushed, 1.0 - pushed}, {2.5 + pushed, 2.0})) == 0.0);
}

TEST_CASE("depth of known overlaps", "[geometry][overlap]") {
  SECTION("edge pushed into an edge") {
    const double pushed = GENERATE(1e-6, 1e-3, 0.25);
    CHECK(depth(square, rectangle_between({1.0 - pushed, 0.25}, {2.0, 0.75})) == Approx(pushed).epsilon(1e-9));
    CHECK(depth(square, rectangle_between({1.0 - pushed, 0.0}, {2.0, 1.0})) == Approx(pushed).epsilon(1e-9));
  }
  SECTION("corner pushed into an edge") {
    CHECK(depth(square, {{0.9, 0.5}, {2.0, 0.0}, {2.0, 1.0}}) == Approx(0.1));
  }
  SECTION("cross: no vertex of one inside the other") {
    CHECK(depth(rectangle_between({-5.0, -0.5}, {5.0, 0.5}), rectangle_between({-0.5, -5.0}, {0.5, 5.0})) == Approx(0.5));
    CHECK(depth(rectangle_between({-5.0, -0.1}, {5.0, 0.1}), rectangle_between({-0.5, -5.0}, {0.5, 5.0})) == Approx(0.5));
  }
  SECTION("star of David") {
    const Polygon up{{-1.0, -0.5}, {1.0, -0.5}, {0.0, 1.2}};
    const Polygon down{{-1.0, 0.5}, {0.0, -1.2}, {1.0, 0.5}};
    CHECK(depth(up, down) > 0.3);
  }
  SECTION("one inside the other") {
    CHECK(depth(rectangle_between({-1.0, -1.0}, {2.0, 2.0}), square) == Approx(1.0));
  }
  SECTION("one inside the other with flush edges") {
    CHECK(depth(square, rectangle_between({0.0, 0.0}, {1.0, 0.5})) == Approx(0.5));
    CHECK(depth(rectangle_between({0.0, 0.0}, {2.0, 1.0}), square) == Approx(0.5));
  }
  SECTION("identical") {
    CHECK(depth(square, square) > 0.3);
    CHECK(depth(notched, notched) > 0.2);
    CHECK(depth(square, {{1.0, 1.0}, {0.0, 1.0}, {0.0, 0.0}, {1.0, 0.0}}) > 0.3);
  }
  SECTION("identical, with many blunt corners or very thin") {
    Polygon round;
    for (int i = 0; i < 400; ++i) round.emplace_back(std::cos(i * std::numbers::pi / 200.0), std::sin(i * std::numbers::pi / 200.0));
    CHECK(depth(round, round) > 0.9);
    CHECK(depth(round, placed(round, 0.003, {1e-5, 0.0})) > 0.9);
    const Polygon strip = rectangle_between({0.0, 0.0}, {100.0, 0.004});
    CHECK(depth(strip, strip) == Approx(0.002));
    CHECK(depth(strip, rectangle_between({0.0, 0.0}, {50.0, 0.004})) == Approx(0.002));
  }
  SECTION("identical but for a tail, whose mouth is all that is of one inside the other") {
    CHECK(depth(square, {{0.0, 0.0}, {5.0, 0.0}, {5.0, 1e-4}, {1.0, 1e-4}, {1.0, 1.0}, {0.0, 1.0}}) > 0.3);
  }
  SECTION("identical to rounding") {
    const double off = GENERATE(-1e-9, 1e-9, 1e-5);
    CHECK(depth(square, rectangle_between({off, -off}, {1.0 + off, 1.0})) > 0.3);
    CHECK(depth(placed(notched, 0.3, {1e6, 1e6}), placed(notched, 0.3 + 1e-15, {1e6, 1e6})) > 0.2);
  }
  SECTION("a block too wide for the notch") {
    CHECK(depth(notched, rectangle_between({1.4, 1.0}, {2.6, 3.0})) == Approx(0.1));
  }
  SECTION("a beam through both cheeks of the notch") {
    CHECK(depth(notched, rectangle_between({-1.0, 1.4}, {5.0, 1.6})) == Approx(0.6));
  }
  SECTION("an edge that runs along a notch's tip is deep on both sides of it") {
    const Polygon pricked{{0.0, 0.0}, {4.0, 0.0}, {4.0, 2.0}, {2.01, 2.0}, {2.0, 1.0}, {1.99, 2.0}, {0.0, 2.0}};
    CHECK(depth(pricked, rectangle_between({0.0, 1.0}, {4.0, 3.0})) > 0.4);
  }
}

TEST_CASE("random polygons overlap where a grid of points says so", "[geometry][overlap]") {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> radius(0.3, 1.0);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  std::uniform_real_distribution<double> shift(-1.5, 1.5);
  const auto star = [&] {
    Polygon polygon;
    for (int i = 0; i < 9; ++i) polygon.push_back(radius(generator) * Vec2(std::cos(i * 0.7), std::sin(i * 0.7)));
    return polygon;
  };
  int deep = 0;
  int apart = 0;
  for (int i = 0; i < 500; ++i) {
    const Polygon a = star();
    const Polygon b = placed(star(), angle(generator), {shift(generator), shift(generator)});
    double deepest = 0.0;
    bool any = false;
    for (double x = -1.0; x < 1.0; x += 0.05) {
      for (double y = -1.0; y < 1.0; y += 0.05) {
        if (!contains(a, {x, y}) || !contains(b, {x, y})) continue;
        any = true;
        deepest = std::max(deepest, std::min(distance_to_boundary(a, {x, y}), distance_to_boundary(b, {x, y})));
      }
    }
    const double found = depth(a, b);
    // The depth is sampled, like the grid; half of what the grid sees is a bound that must hold.
    CHECK(found >= 0.5 * deepest);
    if (any) CHECK(found > 0.0);
    // A disc of this radius, centred on one boundary inside the other polygon, is many grid points wide.
    if (found > 0.3) CHECK(any);
    deep += found > 0.1 ? 1 : 0;
    apart += found == 0.0 ? 1 : 0;
  }
  CHECK(deep > 100);
  CHECK(apart > 100);
}

namespace {

/// Two blocks that meet along a joint through these points, from left to right; the upper one pushed down by so much.
std::pair<Polygon, Polygon> along_joint(const Polygon& joint, double pushed) {
  Polygon lower{{joint.front().x(), -10.0}, {joint.back().x(), -10.0}}, upper{{joint.back().x(), 10.0}, {joint.front().x(), 10.0}};
  lower.insert(lower.end(), joint.rbegin(), joint.rend());
  for (const Vec2& point : joint) upper.emplace_back(point.x(), point.y() - pushed);
  return {lower, upper};
}

}  // namespace

TEST_CASE("blocks that meet along a rough joint only touch, unless they overlap", "[geometry][overlap]") {
  std::mt19937 generator(20);
  const double rounding = GENERATE(0.0, 1e-4);
  const double height = GENERATE(0.02, 0.5);
  std::uniform_real_distribution<double> heights(-height, height), widths(0.01, 0.1), off(-rounding, rounding);
  for (int i = 0; i < 20; ++i) {
    Polygon joint{{0.0, 0.0}};
    for (int k = 0; k < 60; ++k) joint.emplace_back(joint.back().x() + widths(generator), heights(generator));
    auto [lower, upper] = along_joint(joint, 0.0);
    for (Vec2& point : upper) point += Vec2(off(generator), off(generator));
    CHECK(only_touch(lower, upper, 1e-3));
    CHECK(only_touch(upper, lower, 1e-3));
    CHECK(overlap_depth_beyond(1e-3, outline_of(lower), outline_of(upper)) <= 1e-3);
    // Teeth this steep overlap less deep than they are pushed: what is asked for is what the whole formula says.
    const auto pushed = along_joint(joint, 0.1).second;
    const double depth = overlap_depth(lower, pushed);
    REQUIRE(depth > 1e-3);
    CHECK_FALSE(only_touch(lower, pushed, 1e-3));
    CHECK(overlap_depth_beyond(1e-3, outline_of(lower), outline_of(pushed)) == depth);
    // Blocks that coincide have no boundary inside each other.
    CHECK_FALSE(only_touch(lower, lower, 1e-3));
    CHECK_FALSE(only_touch(upper, along_joint(joint, 0.0).second, 1e-3));
  }
}

TEST_CASE("a joint of many teeth takes no longer than its teeth", "[geometry][overlap]") {
  // Each edge against each would be 1e10 comparisons.
  Polygon joint;
  for (int k = 0; k <= 50000; ++k) joint.emplace_back(2e-3 * k, k % 2 == 0 ? 0.0 : 0.5);
  const auto [lower, upper] = along_joint(joint, 0.0);
  CHECK(only_touch(lower, upper, 1e-3));
  // Teeth that are longer than the joint, and upright.
  const auto turned = [](Polygon polygon) {
    for (Vec2& point : polygon) point = Vec2(-point.y(), point.x());
    return polygon;
  };
  Polygon comb;
  for (int k = 0; k <= 50000; ++k) comb.emplace_back(2e-3 * k, k % 2 == 0 ? -9.0 : 400.0);
  auto [below, above_comb] = along_joint(comb, 0.0);
  above_comb[0].y() = above_comb[1].y() = 500.0;
  CHECK(only_touch(below, above_comb, 1e-3));
  CHECK(only_touch(turned(below), turned(above_comb), 1e-3));
  // The long edge of a plane joint beside as many short ones.
  for (Vec2& point : joint) point.y() = 0.0;
  const auto [flat, above] = along_joint(joint, 0.0);
  CHECK(only_touch(rectangle_between({-50.0, -10.0}, {150.0, 0.0}), above, 1e-3));
}

TEST_CASE("beams that cross do more than touch, though no corner of one is in the other", "[geometry][overlap]") {
  const Polygon lying = rectangle_between({-5.0, -0.5}, {5.0, 0.5}), standing = rectangle_between({-0.5, -5.0}, {0.5, 5.0});
  CHECK_FALSE(only_touch(lying, standing, 1e-3));
  CHECK_FALSE(only_touch(standing, lying, 1e-3));
}

TEST_CASE("random polygons only touch where no depth is found", "[geometry][overlap]") {
  std::mt19937 generator(21);
  std::uniform_real_distribution<double> radius(0.3, 1.0), angle(0.0, 2.0 * std::numbers::pi), shift(-1.5, 1.5);
  const auto star = [&] {
    Polygon polygon;
    for (int i = 0; i < 9; ++i) polygon.push_back(radius(generator) * Vec2(std::cos(i * 0.7), std::sin(i * 0.7)));
    return polygon;
  };
  int touching = 0;
  for (int i = 0; i < 500; ++i) {
    const Polygon a = star(), b = placed(star(), angle(generator), {shift(generator), shift(generator)});
    const double depth = overlap_depth(a, b);
    const bool touch = only_touch(a, b, 1e-3);
    if (depth > 1e-3) CHECK_FALSE(touch);
    if (depth == 0.0) CHECK(touch);
    touching += touch;
  }
  CHECK(touching > 100);
}
