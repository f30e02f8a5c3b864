#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "openclose/geometry/block_cutting.h"
#include "openclose/geometry/joint_set.h"
#include "openclose/geometry/overlap.h"
#include "support/catch.h"
#include "support/polygons.h"

using namespace openclose;
using builders::rectangle_between;
using std::numbers::pi;

namespace {

const PolygonWithHoles square{rectangle_between({0.0, 0.0}, {4.0, 4.0}), {}};

/// Lines given by their ends, each a joint of its own.
std::vector<JointTrace> lines(const std::vector<Segment>& segments) {
  std::vector<JointTrace> traces;
  for (const Segment& segment : segments) traces.push_back({segment, static_cast<int>(traces.size())});
  return traces;
}

Cutting cut(const PolygonWithHoles& domain, const std::vector<Segment>& segments, const CuttingLimits& limits = {}) {
  return cut_blocks(domain, lines(segments), std::vector<int>(segments.size(), Cutting::label_of_boundary), limits);
}

double total_area(const std::vector<Polygon>& blocks) {
  double area = 0.0;
  for (const Polygon& block : blocks) area += signed_area(block);
  return area;
}

/// What must hold of every cutting: simple, counter-clockwise blocks without straight corners that fill the domain.
void check_sound(const Cutting& cutting, const PolygonWithHoles& domain, double area_error = 1e-12) {
  REQUIRE_FALSE(cutting.blocks.empty());
  for (const Polygon& block : cutting.blocks) {
    CHECK(signed_area(block) > 0.0);
    CHECK_FALSE(first_self_intersection(block));
    CHECK(corners(block).size() == block.size());
  }
  CHECK(total_area(cutting.blocks) == Approx(domain.area()).epsilon(area_error).margin(0.0));
}

void check_no_overlap(const std::vector<Polygon>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t j = i + 1; j < blocks.size(); ++j) {
      if (overlap_depth(blocks[i], blocks[j]) > 0.0) FAIL("blocks " << i << " and " << j << " overlap");
    }
  }
}

/// Vertices of different blocks are the same to the last bit, or apart.
void check_vertices_coincide(const std::vector<Polygon>& blocks) {
  std::vector<Vec2> all;
  for (const Polygon& block : blocks) all.insert(all.end(), block.begin(), block.end());
  std::sort(all.begin(), all.end(), [](const Vec2& a, const Vec2& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size() && all[j].x() - all[i].x() < tolerance::shortest_edge_m; ++j) {
      if (all[i] != all[j] && (all[i] - all[j]).norm() < 0.9 * tolerance::shortest_edge_m) FAIL("vertices differ in their last bits");
    }
  }
}

std::vector<Segment> grid(int columns, int rows, double width, double height) {
  std::vector<Segment> segments;
  for (int i = 1; i < columns; ++i) segments.push_back({{width * i / columns, -1.0}, {width * i / columns, height + 1.0}});
  for (int i = 1; i < rows; ++i) segments.push_back({{-1.0, height * i / rows}, {width + 1.0, height * i / rows}});
  return segments;
}

std::vector<Segment> random_segments(std::mt19937_64& generator, int count, double size, double longest) {
  std::uniform_real_distribution<double> place(-0.1 * size, 1.1 * size);
  std::uniform_real_distribution<double> angle(0.0, pi);
  std::uniform_real_distribution<double> length(0.1 * longest, longest);
  std::vector<Segment> segments;
  for (int i = 0; i < count; ++i) {
    const Vec2 from(place(generator), place(generator));
    const double turn = angle(generator);
    segments.push_back({from, from + length(generator) * Vec2(std::cos(turn), std::sin(turn))});
  }
  return segments;
}

}  // namespace

TEST_CASE("a domain without joints is one block", "[geometry][cutting]") {
  const Cutting cutting = cut(square, {});
  REQUIRE(cutting.blocks.size() == 1);
  CHECK(cutting.blocks[0] == square.outer);
}

TEST_CASE("a grid cuts a rectangle into a known number of blocks", "[geometry][cutting]") {
  const PolygonWithHoles domain{rectangle_between({0.0, 0.0}, {7.0, 3.0}), {}};
  const Cutting cutting = cut(domain, grid(7, 3, 7.0, 3.0));
  check_sound(cutting, domain);
  REQUIRE(cutting.blocks.size() == 21);
  CHECK(cutting.dangling_ends == 0);
  check_vertices_coincide(cutting.blocks);
  SECTION("in rows from below, each from left to right") {
    CHECK(cutting.blocks[0] == rectangle_between({0.0, 0.0}, {1.0, 1.0}));
    CHECK(cutting.blocks[1] == rectangle_between({1.0, 0.0}, {2.0, 1.0}));
    CHECK(cutting.blocks[20] == rectangle_between({6.0, 2.0}, {7.0, 3.0}));
  }
}

TEST_CASE("lines in general position cut a convex domain as often as Euler's formula says", "[geometry][cutting]") {
  // Each line adds one block, and one more for each of its crossings inside.
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> angle(0.0, pi);
  std::uniform_real_distribution<double> place(1.0, 3.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<Segment> segments;
    for (int i = 0; i < 12; ++i) {
      const Vec2 through(place(generator), place(generator));
      const double turn = angle(generator);
      const Vec2 along(std::cos(turn), std::sin(turn));
      segments.push_back({through - 10.0 * along, through + 10.0 * along});
    }
    int expected = 1 + 12;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      for (std::size_t j = i + 1; j < segments.size(); ++j) {
        const Vec2 a = segments[i].to - segments[i].from;
        const Vec2 b = segments[j].to - segments[j].from;
        const Vec2 crossing = segments[i].at(cross(segments[j].from - segments[i].from, b) / cross(a, b));
        if (contains(square.outer, crossing)) ++expected;
      }
    }
    CuttingLimits limits;
    limits.sliver_width = tolerance::least_sliver_width_m;
    limits.end_reach = 0.0;
    const Cutting cutting = cut(square, segments, limits);
    check_sound(cutting, square);
    CHECK(static_cast<int>(cutting.blocks.size()) + cutting.slivers_merged == expected);
  }
}

TEST_CASE("the blocks do not depend on the order or direction of the joints", "[geometry][cutting]") {
  std::mt19937_64 generator(5);
  std::vector<Segment> segments = random_segments(generator, 150, 4.0, 3.0);
  for (const Segment& line : grid(5, 5, 4.0, 4.0)) segments.push_back(line);
  segments.push_back({{1.0, 1.0 + 3e-9}, {3.0, 1.0 - 3e-9}});  // as good as on one of the grid
  const std::vector<Polygon> blocks = cut(square, segments).blocks;
  CHECK(blocks.size() > 100);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(segments.begin(), segments.end(), generator);
    for (Segment& segment : segments) {
      if (generator() % 2 == 0) std::swap(segment.from, segment.to);
    }
    CHECK(cut(square, segments).blocks == blocks);
  }
}

TEST_CASE("domains and blocks that are not convex", "[geometry][cutting]") {
  SECTION("a joint across a notch is in the domain on both sides of it and not between") {
    const PolygonWithHoles domain{{{0.0, 0.0}, {5.0, 0.0}, {5.0, 3.0}, {3.0, 3.0}, {3.0, 1.0}, {2.0, 1.0}, {2.0, 3.0}, {0.0, 3.0}}, {}};
    const Cutting cutting = cut(domain, {{{-1.0, 2.0}, {6.0, 2.0}}});
    check_sound(cutting, domain);
    REQUIRE(cutting.blocks.size() == 3);
    CHECK(cutting.blocks[0].size() == 8);
    CHECK(cutting.blocks[1] == rectangle_between({0.0, 2.0}, {2.0, 3.0}));
    CHECK(cutting.blocks[2] == rectangle_between({3.0, 2.0}, {5.0, 3.0}));
  }
  SECTION("a joint that bends makes a block with a re-entrant corner") {
    const Cutting cutting = cut(square, {{{2.0, 0.0}, {2.0, 2.0}}, {{2.0, 2.0}, {4.0, 2.0}}});
    check_sound(cutting, square);
    REQUIRE(cutting.blocks.size() == 2);
    CHECK(cutting.blocks[0] == rectangle_between({2.0, 0.0}, {4.0, 2.0}));
    CHECK(cutting.blocks[1] == Polygon{{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {4.0, 2.0}, {4.0, 4.0}, {0.0, 4.0}});
  }
  SECTION("joints that close outside the domain enclose nothing there") {
    const PolygonWithHoles domain{{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {2.0, 1.0}, {0.0, 4.0}}, {}};
    const Cutting cutting = cut(domain, {{{-1.0, 3.0}, {5.0, 3.0}}, {{-1.0, 3.5}, {5.0, 3.5}}, {{2.0, 2.0}, {2.0, 5.0}}});
    check_sound(cutting, domain);
    CHECK(cutting.blocks.size() == 5);
    CHECK_FALSE(cutting.uses[2].in_domain);
  }
  SECTION("a joint along the boundary changes nothing") {
    const Cutting cutting = cut(square, {{{-1.0, 0.0}, {5.0, 0.0}}, {{0.0, -1.0}, {0.0, 3.0}}});
    REQUIRE(cutting.blocks.size() == 1);
    CHECK(cutting.blocks[0] == square.outer);
    CHECK(cutting.dangling_ends == 0);
  }
}

TEST_CASE("holes in the domain", "[geometry][cutting]") {
  const PolygonWithHoles domain{rectangle_between({0.0, 0.0}, {4.0, 4.0}), {rectangle_between({1.0, 1.0}, {2.0, 2.0})}};
  SECTION("a joint through the hole leaves two blocks with re-entrant corners") {
    const Cutting cutting = cut(domain, {{{-1.0, 1.5}, {5.0, 1.5}}});
    check_sound(cutting, domain);
    REQUIRE(cutting.blocks.size() == 2);
    CHECK(cutting.blocks[0].size() == 8);
    CHECK(cutting.blocks[1].size() == 8);
  }
  SECTION("two joints through it leave no block in it") {
    const Cutting cutting = cut(domain, {{{-1.0, 1.5}, {5.0, 1.5}}, {{1.5, -1.0}, {1.5, 5.0}}});
    check_sound(cutting, domain);
    CHECK(cutting.blocks.size() == 4);
  }
  SECTION("one that the joints do not reach, or in one place only, would be a hole in a block") {
    CHECK(cut(domain, {{{3.0, -1.0}, {3.0, 5.0}}}).loose_holes == std::vector<int>{0});
    CHECK(cut(domain, {{{-1.0, 1.5}, {1.0, 1.5}}}).loose_holes == std::vector<int>{0});
    CHECK(cut(domain, {}).loose_holes == std::vector<int>{0});
    CHECK(cut(domain, {}).blocks.empty());
  }
  SECTION("faults") {
    CHECK_FALSE(first_ring_fault(domain));
    const auto fault = [](const Polygon& a, const Polygon& b) { return first_ring_fault({rectangle_between({0.0, 0.0}, {4.0, 4.0}), {a, b}})->kind; };
    const Polygon good = rectangle_between({1.0, 1.0}, {2.0, 2.0});
    CHECK(fault(good, rectangle_between({2.0, 1.0}, {3.0, 2.0})) == RingFault::Kind::meets);
    CHECK(fault(good, rectangle_between({3.0, 3.0}, {5.0, 5.0})) == RingFault::Kind::meets);
    CHECK(fault(good, rectangle_between({5.0, 5.0}, {6.0, 6.0})) == RingFault::Kind::outside);
    CHECK(fault(good, rectangle_between({1.2, 1.2}, {1.8, 1.8})) == RingFault::Kind::nested);
    CHECK(fault(rectangle_between({1.2, 1.2}, {1.8, 1.8}), good) == RingFault::Kind::nested);
  }
}

TEST_CASE("T-junctions and ends", "[geometry][cutting]") {
  const Segment through{{2.0, -1.0}, {2.0, 5.0}};
  SECTION("a joint that ends on another one") {
    const Cutting cutting = cut(square, {through, {{-1.0, 1.0}, {2.0, 1.0}}});
    check_sound(cutting, square);
    REQUIRE(cutting.blocks.size() == 3);
    CHECK(cutting.dangling_ends == 0);
    // The other side of the joint has no corner there.
    CHECK(cutting.blocks[1] == rectangle_between({2.0, 0.0}, {4.0, 4.0}));
  }
  SECTION("one that ends short of it by less than the reach gets there") {
    CHECK(cut(square, {through, {{0.0009, 1.0}, {1.9991, 1.0}}}).blocks.size() == 3);
  }
  SECTION("one that falls shorter is cut back, whole") {
    const Cutting cutting = cut(square, {through, {{-1.0, 1.0}, {1.99, 1.0}}});
    CHECK(cutting.blocks.size() == 2);
    CHECK(cutting.dangling_ends == 1);
    CHECK(cutting.uses[1].in_domain);
    CHECK_FALSE(cutting.uses[1].bounds_block);
  }
  SECTION("one that goes on is cut back to the last meeting") {
    const Cutting cutting = cut(square, {through, {{-1.0, 1.0}, {3.0, 1.0}}});
    CHECK(cutting.blocks.size() == 3);
    CHECK(cutting.dangling_ends == 1);
  }
  SECTION("a branched tree of joints goes altogether") {
    const Cutting cutting = cut(square, {{{2.0, -1.0}, {2.0, 2.0}}, {{1.0, 1.0}, {3.0, 1.0}}, {{2.5, 0.5}, {2.5, 1.5}}});
    CHECK(cutting.blocks.size() == 1);
    CHECK(cutting.dangling_ends == 5);
    CHECK(cutting.enclosed.empty());
  }
}

TEST_CASE("joints enclosed in one block are dropped and counted", "[geometry][cutting]") {
  const std::vector<Segment> loop{{{1.0, 1.0}, {2.0, 1.0}}, {{2.0, 1.0}, {2.0, 2.0}}, {{2.0, 2.0}, {1.0, 1.0}}};
  const auto with = [&](const Segment& more) {
    std::vector<Segment> segments = loop;
    segments.push_back(more);
    return cut(square, segments);
  };
  CHECK(cut(square, loop).enclosed.size() == 1);
  CHECK(cut(square, loop).blocks.size() == 1);
  SECTION("hanging on the boundary by one joint") {
    CHECK(with({{-1.0, 1.5}, {1.5, 1.5}}).enclosed.size() == 1);
  }
  SECTION("hanging in one point on a joint") {
    const Cutting cutting = with({{1.0, -1.0}, {1.0, 5.0}});
    CHECK(cutting.enclosed.size() == 1);
    CHECK(cutting.blocks.size() == 2);
  }
  SECTION("connected twice they bound a block") {
    const Cutting cutting = with({{-1.0, 1.2}, {5.0, 1.2}});
    CHECK(cutting.enclosed.empty());
    CHECK(cutting.blocks.size() == 4);
    check_sound(cutting, square);
  }
}

TEST_CASE("lines that should meet in one point do", "[geometry][cutting]") {
  SECTION("three, and a fan of many, at places that are no round numbers") {
    const int count = GENERATE(3, 4, 17, 100);
    std::vector<Segment> segments;
    const Vec2 centre(1.0 + 1.0 / 3.0, 1.7);
    for (int i = 0; i < count; ++i) {
      const Vec2 along(std::cos(0.1 + pi * i / count), std::sin(0.1 + pi * i / count));
      segments.push_back({centre - 7.0 * along, centre + 9.0 * along});
    }
    const Cutting cutting = cut(square, segments);
    check_sound(cutting, square);
    CHECK(static_cast<int>(cutting.blocks.size()) == 2 * count);
    check_vertices_coincide(cutting.blocks);
    check_no_overlap(cutting.blocks);
  }
  SECTION("to within the shortest edge") {
    for (const double miss : {0.0, 1e-12, 1e-10, 5e-9}) {
      const Cutting cutting = cut(square, {{{0.0, 0.0}, {4.0, 4.0}}, {{0.0, 4.0}, {4.0, 0.0}}, {{-1.0, 2.0 + miss}, {5.0, 2.0 + miss}}});
      CHECK(cutting.blocks.size() == 6);
      CHECK(cutting.slivers_merged == 0);
    }
  }
  SECTION("lines through a corner of the domain") {
    const Cutting cutting = cut(square, {{{-1.0, -1.0}, {5.0, 5.0}}, {{-1.0, -0.5}, {5.0, 2.5}}});
    CHECK(cutting.blocks.size() == 3);
    check_sound(cutting, square);
  }
}

TEST_CASE("joints that coincide count once", "[geometry][cutting]") {
  const std::vector<Segment> once{{{-1.0, 1.0}, {5.0, 2.0}}, {{1.0, -1.0}, {2.0, 5.0}}};
  const std::vector<Polygon> blocks = cut(square, once).blocks;
  std::vector<Segment> twice = once;
  twice.push_back(once[0]);
  twice.push_back({once[1].to, once[1].from});
  const Cutting cutting = cut(square, twice);
  CHECK(cutting.blocks == blocks);
  CHECK(cutting.overlaps == std::vector<std::pair<int, int>>{{0, 2}, {1, 3}});
  SECTION("also where only parts of them do") {
    const Cutting parts = cut(square, {{{-1.0, 1.0}, {3.0, 1.0}}, {{2.0, 1.0}, {5.0, 1.0}}});
    CHECK(parts.blocks.size() == 2);
    CHECK(parts.blocks[0] == rectangle_between({0.0, 0.0}, {4.0, 1.0}));
  }
}

TEST_CASE("slivers go to the neighbour with the longest common edge", "[geometry][cutting]") {
  // A strip 0.4 mm wide at half height; a joint above it begins on it.
  const std::vector<Segment> segments{{{-1.0, 2.0}, {5.0, 2.0}}, {{-1.0, 2.0004}, {5.0, 2.0004}}, {{3.0, 2.0004}, {3.0, 5.0}}};
  CuttingLimits limits;
  limits.end_reach = 1e-5;
  SECTION("merged") {
    const Cutting cutting = cut(square, segments, limits);
    check_sound(cutting, square);
    CHECK(cutting.slivers_merged == 1);
    CHECK(cutting.slivers_area == Approx(0.0016));
    CHECK(cutting.slivers_left == 0);
    REQUIRE(cutting.blocks.size() == 3);
    CHECK(signed_area(cutting.blocks[0]) == Approx(8.0016).epsilon(1e-12));
  }
  SECTION("kept, if the limit is lower") {
    limits.sliver_width = 1e-4;
    const Cutting cutting = cut(square, segments, limits);
    CHECK(cutting.slivers_merged == 0);
    CHECK(cutting.blocks.size() == 4);
  }
  SECTION("by area") {
    limits.sliver_area = 1.0;
    const Cutting cutting = cut(square, {{{-1.0, 3.5}, {5.0, 3.5}}, {{3.5, -1.0}, {3.5, 5.0}}}, limits);
    CHECK(cutting.slivers_merged == 1);
    REQUIRE(cutting.blocks.size() == 3);
    check_sound(cutting, square);
  }
  SECTION("all of a heap of them") {
    limits.sliver_area = 2.5;
    const Cutting cutting = cut(square, grid(4, 4, 4.0, 4.0), limits);
    check_sound(cutting, square);
    CHECK(cutting.slivers_left == 0);
    CHECK(static_cast<int>(cutting.blocks.size()) == 16 - cutting.slivers_merged);
    for (const Polygon& block : cutting.blocks) CHECK(signed_area(block) >= 2.5);
  }
  SECTION("a domain that is one whole sliver stays") {
    limits.sliver_area = 100.0;
    const Cutting cutting = cut(square, grid(2, 2, 4.0, 4.0), limits);
    CHECK(cutting.blocks.size() == 1);
    CHECK(cutting.slivers_left == 1);
  }
}

TEST_CASE("slivers around a hole do not fill it", "[geometry][cutting]") {
  // Two wedges and the rest of the domain meet around the hole: with both wedges gone to the rest only one joint would lead to it.
  const PolygonWithHoles domain{rectangle_between({0.0, 0.0}, {4.0, 4.0}), {rectangle_between({2.0, 2.0}, {2.001, 2.001})}};
  CuttingLimits limits;
  limits.sliver_width = 0.1;
  const Vec2 middle(2.0005, 2.0005);
  const Cutting cutting = cut(domain, {{middle, {2.05, 5.0}}, {middle, {2.0005, 5.0}}, {middle, {1.95, 5.0}}}, limits);
  CHECK(cutting.loose_holes.empty());
  check_sound(cutting, domain);
  CHECK(cutting.slivers_merged == 1);
  CHECK(cutting.slivers_left == 1);
  CHECK(cutting.blocks.size() == 2);
}

TEST_CASE("random joints: areas, vertices, overlaps", "[geometry][cutting]") {
  std::mt19937_64 generator(17);
  const PolygonWithHoles domain{{{0.0, 0.0}, {10.0, 0.0}, {10.0, 6.0}, {6.0, 6.0}, {5.0, 9.0}, {4.0, 5.0}, {0.0, 7.0}}, {}};
  int blocks = 0;
  for (int round = 0; round < 400; ++round) {
    const int count = 5 + round % 60;
    std::vector<Segment> segments = random_segments(generator, count, 10.0, 12.0);
    // Ends on other joints, joints that coincide to within the shortest edge, and pairs that cross almost in one line.
    for (int i = 0; i + 1 < count; i += 5) {
      segments.push_back({segments[i].at(0.4), segments[i + 1].at(0.6)});
      segments.push_back({segments[i].from + Vec2(3e-9, -2e-9), segments[i].to + Vec2(-2e-9, 4e-9)});
      segments.push_back({segments[i].from + Vec2(0.0, 1e-7), segments[i].to - Vec2(0.0, 1e-7)});
    }
    const Cutting cutting = cut(domain, segments);
    // Corners between joints that coincide almost are moved by up to 2e-8 m.
    check_sound(cutting, domain, 1e-10);
    CHECK(cutting.slivers_left == 0);
    check_vertices_coincide(cutting.blocks);
    if (cutting.blocks.size() < 120) check_no_overlap(cutting.blocks);
    blocks += static_cast<int>(cutting.blocks.size());
  }
  CHECK(blocks > 10000);
}

TEST_CASE("joints on a coarse lattice, where everything coincides", "[geometry][cutting]") {
  std::mt19937_64 generator(23);
  std::uniform_int_distribution<int> place(-1, 7);
  const PolygonWithHoles domain{{{0.0, 0.0}, {0.6, 0.0}, {0.6, 0.6}, {0.3, 0.3}, {0.0, 0.6}}, {}};
  for (int round = 0; round < 300; ++round) {
    std::vector<Segment> segments;
    for (int i = 0; i < 15; ++i) {
      segments.push_back({{place(generator) / 10.0, place(generator) / 10.0}, {place(generator) / 10.0, place(generator) / 10.0}});
    }
    const Cutting cutting = cut(domain, segments);
    check_sound(cutting, domain);
    check_no_overlap(cutting.blocks);
  }
}

TEST_CASE("a cutting far from the origin", "[geometry][cutting]") {
  const Vec2 shift(1e6, -2e6);
  PolygonWithHoles domain = square;
  for (Vec2& vertex : domain.outer) vertex += shift;
  std::vector<Segment> segments = grid(40, 40, 4.0, 4.0);
  for (Segment& segment : segments) segment = {segment.from + shift, segment.to + shift};
  const Cutting cutting = cut(domain, segments);
  CHECK(cutting.blocks.size() == 1600);
  CHECK(total_area(cutting.blocks) == Approx(16.0).epsilon(1e-12).margin(0.0));
}

TEST_CASE("more blocks than allowed", "[geometry][cutting]") {
  CuttingLimits limits;
  limits.max_blocks = 99;
  CHECK(cut(square, grid(10, 10, 4.0, 4.0), limits).too_many);
  limits.max_blocks = 100;
  CHECK(cut(square, grid(10, 10, 4.0, 4.0), limits).blocks.size() == 100);
  SECTION("so many that it is not even tried") {
    limits.max_blocks = 10;
    const Cutting cutting = cut(square, grid(2000, 2000, 4.0, 4.0), limits);
    CHECK(cutting.too_many);
    CHECK(cutting.blocks.empty());
  }
}

TEST_CASE("every edge of a block knows its joint", "[geometry][cutting]") {
  // Joint 0 across the middle, joint 1 upright through the upper half, joint 2 along the right half of joint 0.
  const std::vector<Segment> segments = {{{0.0, 2.0}, {4.0, 2.0}}, {{1.0, 2.0}, {1.0, 4.0}}, {{2.5, 2.0}, {4.0, 2.0}}};
  for (const double away : {0.0, 5e6}) {
    INFO("moved by " << away);
    const Vec2 by(away, -away);
    PolygonWithHoles domain = square;
    for (Vec2& vertex : domain.outer) vertex += by;
    std::vector<Segment> there = segments;
    for (Segment& segment : there) segment = {segment.from + by, segment.to + by};
    const Cutting cutting = cut_blocks(domain, lines(there), {10, 11, 12});
    REQUIRE(cutting.blocks.size() == 3);
    REQUIRE(cutting.edge_labels.size() == 3);
    constexpr int none = Cutting::label_of_boundary;
    // Each begins with its lowest vertex. Where joints run along each other the first one counts.
    CHECK(cutting.edge_labels[0] == std::vector<int>{none, none, 10, none});
    CHECK(cutting.edge_labels[1] == std::vector<int>{10, 11, none, none});
    CHECK(cutting.edge_labels[2] == std::vector<int>{10, none, none, 11});
  }
}

TEST_CASE("a side of a block that two joints share has a vertex where the one goes over into the other", "[geometry][cutting]") {
  // Two lines one behind the other, and one that makes the upper half two blocks: the change is on a straight side of the lower block and the left
  // one.
  const std::vector<Segment> segments = {{{0.0, 2.0}, {1.5, 2.0}}, {{1.5, 2.0}, {4.0, 2.0}}, {{3.0, 2.0}, {3.0, 4.0}}};
  constexpr int none = Cutting::label_of_boundary;
  for (const double away : {0.0, 5e6}) {
    INFO("moved by " << away);
    const Vec2 by(away, -away);
    PolygonWithHoles domain = square;
    for (Vec2& vertex : domain.outer) vertex += by;
    std::vector<Segment> there = segments;
    for (Segment& segment : there) segment = {segment.from + by, segment.to + by};
    const Cutting cutting = cut_blocks(domain, lines(there), {5, 6, 7});
    REQUIRE(cutting.blocks.size() == 3);
    CHECK(cutting.edge_labels[0] == std::vector<int>{none, none, 6, 5, none});
    CHECK(cutting.blocks[0][3] == Vec2(1.5, 2.0) + by);
    CHECK(cutting.edge_labels[1] == std::vector<int>{5, 6, 7, none, none});
    CHECK(cutting.blocks[1][1] == Vec2(1.5, 2.0) + by);
    CHECK(cutting.edge_labels[2] == std::vector<int>{6, none, none, 7});
    // Alike they have no vertex there.
    CHECK(cut_blocks(domain, lines(there), {5, 5, 7}).blocks[0].size() == 4);
  }
}

TEST_CASE("a sliver is as wide as its sides from corner to corner make it", "[geometry][cutting]") {
  // 4 m by 0.4 mm, with a change of the joint in the middle of both long sides.
  std::vector<JointTrace> traces;
  for (const double y : {2.0, 2.0004}) {
    traces.push_back({{{0.0, y}, {2.0, y}}, 0, JointTrace::no_bridge, false, true});
    traces.push_back({{{2.0, y}, {4.0, y}}, 1, JointTrace::no_bridge, true, false});
  }
  CuttingLimits limits;
  limits.end_reach = 0.0;
  const Cutting cutting = cut_blocks(square, traces, {5, 6}, limits);
  CHECK(cutting.slivers_merged == 1);
  CHECK(cutting.blocks.size() == 2);
}

TEST_CASE("a joint that ends a little beside a meeting ends there", "[geometry][cutting]") {
  // Half a millimetre is less than the reach, two millimetres are more.
  for (const auto& [past, vertices] : {std::pair(5e-4, 4u), std::pair(-5e-4, 4u), std::pair(2e-3, 5u), std::pair(-2e-3, 5u)}) {
    INFO("past the upright by " << past);
    std::vector<JointTrace> traces = lines({{{0.0, 2.0}, {1.0 + past, 2.0}}, {{1.0 + past, 2.0}, {4.0, 2.0}}, {{1.0, 2.0}, {1.0, 4.0}}});
    traces[0].goes_on_to = traces[1].goes_on_from = true;
    const Cutting cutting = cut_blocks(square, traces, {5, 6, 7});
    REQUIRE(cutting.blocks.size() == 3);
    CHECK(cutting.blocks[0].size() == 5);
    CHECK(cutting.blocks[past > 0.0 ? 1 : 2].size() + cutting.blocks[past > 0.0 ? 2 : 1].size() == 4 + vertices);
  }
}

TEST_CASE("fifty thousand blocks take as many comparisons as blocks, times a number", "[geometry][cutting]") {
  const PolygonWithHoles domain{{{0.0, 0.0}, {1000.0, 0.0}, {1000.0, 600.0}, {400.0, 600.0}, {200.0, 200.0}, {0.0, 200.0}}, {}};
  std::vector<JointTrace> all;
  for (const auto& [dip, spacing] : {std::pair(20.0, 3.0), std::pair(75.0, 2.3)}) {
    JointSet set;
    set.dip = dip * pi / 180.0;
    set.spacing = spacing;
    set.origin = {0.3, 0.1};
    const std::vector<SetTrace> found = traces(set, domain.outer, 10000).value();
    for (const SetTrace& segment : found) all.push_back({segment, 0});
  }
  // Refused is what needs more than 32 comparisons of traces for each block that is allowed: of all pairs it would be 200,000.
  CuttingLimits limits;
  limits.max_blocks = 60000;
  const Cutting cutting = cut_blocks(domain, all, {Cutting::label_of_boundary}, limits);
  CHECK_FALSE(cutting.too_many);
  CHECK(cutting.blocks.size() > 50000);
  CHECK(total_area(cutting.blocks) == Approx(domain.area()).epsilon(1e-12).margin(0.0));
}
