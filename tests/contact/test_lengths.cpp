// Tributary lengths: their values and their continuity.
#include <algorithm>
#include <array>
#include <cmath>

#include "contacts.h"
#include "openclose/core/tolerance.h"
#include "support/catch.h"

using namespace openclose;
using namespace openclose::test;

namespace {

constexpr double width = 1.0, height = 2.0;  // [m] of the tilted block

/// A block tilted about its lower left corner, which stands at x on a base whose top ends at 5.
Detection tilted(double angle, double x = 0.0) {
  return Detection(scene_with(
      {fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", placed(rectangle(0.0, 0.0, width, height), angle, {x, 0.0}))}));
}

/// By the rule in the header: the overlap on the bisector, which makes half the tilt with either edge, and the corner's own sides.
double expected_length(double angle) {
  const double span = tolerance::parallel_none_rad - tolerance::parallel_full_rad;
  const double w = std::clamp((tolerance::parallel_none_rad - angle) / span, 0.0, 1.0);
  return w * 0.5 * width * std::cos(0.5 * angle) + (1.0 - w) * 0.5 * (width * std::cos(angle) + height * std::sin(angle));
}

/// Lengths of the contacts in the left and in the right half of the overlap, whichever block's corners they belong to.
std::array<double, 2> left_and_right(const Detection& d) {
  std::array<double, 2> sums{};
  double low = 1e9, high = -1e9;
  const auto x = [&](const Contact& c) { return d.system.position(c.vertex_block, c.vertex).x(); };
  for (const Contact& c : d.contacts) {
    low = std::min(low, x(c));
    high = std::max(high, x(c));
  }
  for (const Contact& c : d.contacts) sums[x(c) < 0.5 * (low + high) ? 0 : 1] += c.length;
  return sums;
}

}  // namespace

TEST_CASE("a lone corner has half the shadows of its two sides", "[contact][lengths]") {
  Detection d = tilted(45.0 * degree);
  REQUIRE(d.contacts.size() == 1);
  CHECK(d.length(4, 2) == Approx(0.5 * (width + height) * std::sqrt(0.5)).epsilon(1e-14));
  CHECK(std::abs(d.contacts[0].gap) <= 1e-15);
}

TEST_CASE("no shadow is counted longer than the edge", "[contact][lengths]") {
  Detection d(scene_with(
      {fixed_block("pillar", rectangle(-0.2, -1.0, 0.5, 1.0)), free_block("block", placed(rectangle(0.0, 0.0, width, height), 45.0 * degree))}));
  REQUIRE(d.contacts.size() == 1);
  CHECK(d.length(4, 2) == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("the length of the standing corner passes continuously from an edge's to a lone corner's", "[contact][lengths]") {
  for (const double angle : {0.0, 2.0, 5.0, 7.0, 10.0, 14.9, 15.0, 15.1, 30.0, 45.0}) {
    CHECK(tilted(angle * degree).length(4, 2) == Approx(expected_length(angle * degree)).epsilon(1e-12));
  }
  // In the passage the weight changes by 1 over 10 degrees, elsewhere the shadows change by less than (width + height) / 2 per radian.
  const double step = 45.0 * degree / 1000.0;
  const double steepest = 0.5 * height * std::sin(tolerance::parallel_none_rad) / (10.0 * degree) + 0.5 * (width + height);
  double before = tilted(0.0).length(4, 2);
  for (int i = 1; i <= 1000; ++i) {
    const double now = tilted(i * step).length(4, 2);
    CHECK(std::abs(now - before) <= steepest * step);
    before = now;
  }
}

TEST_CASE("tilting to the other side mirrors the lengths", "[contact][lengths]") {
  const double angle = GENERATE(3.0, 8.0, 40.0) * degree;
  Detection right(scene_with(
      {fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", placed(rectangle(-width, 0.0, width, height), -angle))}));
  CHECK(right.length(5, 2) == Approx(expected_length(angle)).epsilon(1e-12));
}

TEST_CASE("a block sliding off the end of another loses its length without a jump", "[contact][lengths]") {
  const double angle = GENERATE(0.0, 1e-9, 2.0 * degree);
  const int samples = 1000;
  const double step = 1.2 * width / samples;
  std::array<double, 2> before = left_and_right(tilted(angle, 3.9));
  double least = 1.0;
  for (int i = 1; i <= samples; ++i) {
    const double x = 3.9 + i * step;
    const std::array<double, 2> now = left_and_right(tilted(angle, x));
    const double overlap = std::clamp(5.0 - x, 0.0, width);
    // Lengths are measured on the bisector and by its half tilt; at the end they are cut off below the shortest overlap.
    CHECK(now[0] + now[1] == Approx(overlap).margin(tolerance::shortest_overlap_m + 2.0 * (1.0 - std::cos(angle)) + 0.5 * height * angle * angle));
    for (int k = 0; k < 2; ++k) CHECK(std::abs(now[k] - before[k]) <= 0.5 * step * (1.0 + 1e-9) + tolerance::shortest_overlap_m);
    before = now;
    least = std::min(least, now[0] + now[1]);
  }
  CHECK(least == 0.0);
}

TEST_CASE("the two ends of an overlap share it equally all the way", "[contact][lengths]") {
  for (double x = 3.01; x < 4.999; x += 0.0137) {
    const std::array<double, 2> ends = left_and_right(tilted(0.0, x));
    CHECK(ends[0] == Approx(ends[1]).epsilon(1e-12));
    CHECK(ends[0] == Approx(0.5 * std::min(width, 5.0 - x)).epsilon(1e-12));
  }
}

TEST_CASE("over the seam of two collinear edges the length is that of one", "[contact][lengths]") {
  // The top of the base has a vertex (3) in its middle; its edges are those from 2 (right) and 3 (left).
  const std::vector<Vec2> base{{-5.0, -1.0}, {5.0, -1.0}, {5.0, 0.0}, {0.0, 0.0}, {-5.0, 0.0}};
  for (const double x : {-1.5, -1.0, -0.7, -0.3, 0.0, 0.4}) {
    Detection flat(scene_with({fixed_block("base", base), free_block("block", rectangle(x, 0.0, width, height))}));
    CHECK(flat.total_length() == Approx(width).epsilon(1e-14));
  }
}

TEST_CASE("where the joint changes on straight sides of both blocks each one has the length of its part", "[contact][lengths]") {
  // Of a seam of 6 m the piece from 1 to 3 m has another joint.
  for (const double angle : {0.0, 35.0, -60.0, 90.0}) {
    const auto at = [&](double x, double y) { return placed({{x, y}}, angle * degree).front(); };
    Scene scene = scene_with({fixed_block("base", {at(0, -1), at(6, -1), at(6, 0), at(3, 0), at(1, 0), at(0, 0)}),
                              free_block("block", {at(0, 0), at(1, 0), at(3, 0), at(6, 0), at(6, 2), at(0, 2)})});
    JointProperties other = scene.joints.front();
    other.name = "bridge";
    other.materials = {JointProperties::no_material, JointProperties::no_material};
    scene.joints.push_back(other);
    const int bridge = static_cast<int>(scene.joints.size()) - 1;
    constexpr int none = BlockInput::by_materials;
    scene.blocks[0].edge_joints = {none, none, none, bridge, none, none};
    scene.blocks[1].edge_joints = {none, bridge, none, none, none, none};
    Detection d(scene);
    // It slides over the changes, by less than the shortest part.
    for (const double way : {0.0, 1e-7, 1e-3, 0.5, 0.99}) {
      INFO("at " << angle << " degrees, " << way << " m on");
      const Vec2 from = d.system.centroid(1) - d.system.block(1).reference_centroid;
      const Vec2 step = at(way, 0.0) - from;
      d.move(1, step.x(), step.y());
      d.update();
      double of_bridge = 0.0;
      for (const Contact& c : d.contacts) {
        if (c.joint == bridge) of_bridge += c.length;
        CHECK(std::abs(c.gap) < 1e-12);
      }
      CHECK(d.total_length() == Approx(6.0 - way).margin(4.0 * tolerance::shortest_overlap_m));
      CHECK(of_bridge == Approx(2.0).margin(4.0 * tolerance::shortest_overlap_m));
      for (int v = 0; v < 12; ++v) CHECK_FALSE(d.system.is_reflex(v));
    }
  }
}

TEST_CASE("where the joint changes on straight sides contacts hand on what they carry while the block slides", "[contact][lengths]") {
  constexpr double closure = 5e-5;
  for (const double angle : {0.0, -35.0, 35.0, 90.0}) {
    const auto at = [&](double x, double y) { return placed({{x, y}}, angle * degree).front(); };
    Scene scene = scene_with({fixed_block("base", {at(0, -1), at(6, -1), at(6, 0), at(3, 0), at(1, 0), at(0, 0)}),
                              free_block("block", {at(0, 0), at(1, 0), at(3, 0), at(6, 0), at(6, 2), at(0, 2)})});
    for (const double direction : {1.0, -1.0}) {
      Detection d(scene);
      const Vec2 along = direction * at(1.0, 0.0), down = -closure * at(0.0, 1.0);
      d.move(1, down.x(), down.y());
      for (int step = 0; step < 300; ++step) {
        INFO("at " << angle << " degrees, step " << step << " in direction " << direction);
        for (Contact& c : d.contacts) {
          c.gap = -closure;
          c.status = ContactStatus::sticking;
        }
        d.update();
        double carried = 0.0;
        for (const Contact& c : d.contacts) carried -= c.length * c.stretch();
        CHECK(carried == Approx(d.total_length() * closure).epsilon(1e-6));
        const double way = step < 3 ? 1e-7 : step < 10 ? 1e-4 : 3e-3;
        d.move(1, way * along.x(), way * along.y());
      }
    }
  }
}
