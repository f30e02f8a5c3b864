// What must hold of every cutting, tried on random domains and joints with a fixed seed.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "openclose/geometry/arrangement.h"
#include "openclose/geometry/block_cutting.h"
#include "openclose/geometry/joint_set.h"
#include "openclose/geometry/overlap.h"
#include "support/catch.h"

using namespace openclose;
using std::numbers::pi;

namespace {

using Generator = std::mt19937_64;

double uniform_in(Generator& generator, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(generator);
}
int any_of(Generator& generator, int count) {
  return static_cast<int>(generator() % static_cast<std::uint64_t>(count));
}

/// Seen from the centre its vertices come in order: simple, convex or not.
Polygon star(Generator& generator, const Vec2& centre, double radius, int count, double roughness) {
  Polygon polygon;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * pi * (i + uniform_in(generator, 0.0, 0.6)) / count;
    polygon.push_back(centre + radius * uniform_in(generator, 1.0 - roughness, 1.0) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

struct Problem {
  PolygonWithHoles domain;
  std::vector<JointTrace> traces;
  int joints = 0;

  void add(const Segment& segment) { traces.push_back({segment, joints++}); }
  /// All alike, so that only corners are vertices.
  std::vector<int> labels() const { return std::vector<int>(joints, Cutting::label_of_boundary); }
  void add(const JointSet& set) {
    const std::vector<SetTrace> found = *openclose::traces(set, domain.outer, 100000);
    for (const SetTrace& segment : found) traces.push_back({segment, joints});
    ++joints;
  }
};

PolygonWithHoles random_domain(Generator& generator, double size, const Vec2& centre) {
  while (true) {
    PolygonWithHoles domain{star(generator, centre, 0.6 * size, 3 + any_of(generator, 10), uniform_in(generator, 0.1, 0.7)), {}};
    if (corners(domain.outer).size() != domain.outer.size() || first_self_intersection(domain.outer)) continue;
    for (int hole = any_of(generator, 3); hole > 0; --hole) {
      PolygonWithHoles more = domain;
      const Vec2 middle = centre + 0.3 * size * Vec2(uniform_in(generator, -1.0, 1.0), uniform_in(generator, -1.0, 1.0));
      more.holes.push_back(star(generator, middle, 0.1 * size, 4, 0.3));
      if (!first_ring_fault(more)) domain = more;
    }
    return domain;
  }
}

void add_set(Generator& generator, Problem& problem, double size, double dip) {
  JointSet set;
  set.dip = dip;
  set.spacing = size / uniform_in(generator, 3.0, 12.0);
  set.origin = problem.domain.outer[any_of(generator, static_cast<int>(problem.domain.outer.size()))];
  if (any_of(generator, 3) == 0) {
    set.trace_length = uniform_in(generator, 0.1, 0.6) * size;
    set.gap = 0.5 * *set.trace_length;
    set.stagger = 0.5;
  }
  problem.add(set);
}

/// Joint sets, some of them almost parallel, and single joints in the places where cutting is hard: through corners of the domain, along its edges,
/// from one trace to another, many through one point.
Problem random_problem(Generator& generator, double size, const Vec2& centre) {
  Problem problem{random_domain(generator, size, centre), {}, 0};
  const double dip = uniform_in(generator, -pi, pi);
  add_set(generator, problem, size, dip);
  if (any_of(generator, 2) == 0) add_set(generator, problem, size, dip + uniform_in(generator, 0.5, 2.5));
  if (any_of(generator, 3) == 0) add_set(generator, problem, size, dip + 1e-3);
  const auto anywhere = [&] { return Vec2(centre + 0.6 * size * Vec2(uniform_in(generator, -1.0, 1.0), uniform_in(generator, -1.0, 1.0))); };
  const Vec2 common = anywhere();
  for (int line = any_of(generator, 12); line > 0; --line) {
    const Polygon& ring = problem.domain.holes.empty() || line % 2 == 0 ? problem.domain.outer : problem.domain.holes.front();
    const std::size_t i = generator() % ring.size();
    const Vec2& corner = ring[i];
    const Vec2& next = ring[(i + 1) % ring.size()];
    const Vec2 point = anywhere();
    switch (any_of(generator, 4)) {
      case 0:
        problem.add({point, point + 1.5 * (corner - point)});
        break;
      case 1:
        problem.add({corner - 0.3 * (next - corner), next});
        break;
      case 2: {
        const auto on_trace = [&] { return problem.traces[generator() % problem.traces.size()].segment.at(uniform_in(generator, 0.1, 0.9)); };
        const Segment between{on_trace(), on_trace()};
        if (between.length() > 0.01 * size) problem.add(between);
        break;
      }
      default:
        problem.add({point, common + 0.8 * (common - point)});
    }
  }
  return problem;
}

Cutting cut(const Problem& problem) {
  return cut_blocks(problem.domain, problem.traces, problem.labels());
}

/// The same joints in another order, some of them from the other end, with other numbers.
Problem permuted(Generator& generator, Problem problem) {
  std::shuffle(problem.traces.begin(), problem.traces.end(), generator);
  for (JointTrace& trace : problem.traces) {
    trace.joint = problem.joints - 1 - trace.joint;
    if (generator() % 2 == 0) std::swap(trace.segment.from, trace.segment.to);
  }
  return problem;
}

/// The same domain, every ring beginning with another vertex, the holes in another order.
Problem rewritten(Generator& generator, Problem problem) {
  const auto turn = [&](Polygon& ring) { std::rotate(ring.begin(), ring.begin() + any_of(generator, static_cast<int>(ring.size())), ring.end()); };
  turn(problem.domain.outer);
  for (Polygon& hole : problem.domain.holes) turn(hole);
  std::reverse(problem.domain.holes.begin(), problem.domain.holes.end());
  return problem;
}

Problem moved(Problem problem, const Vec2& by) {
  for (Vec2& vertex : problem.domain.outer) vertex += by;
  for (Polygon& hole : problem.domain.holes) {
    for (Vec2& vertex : hole) vertex += by;
  }
  for (JointTrace& trace : problem.traces) trace.segment = {trace.segment.from + by, trace.segment.to + by};
  return problem;
}

/// Sum of the areas of the blocks over the domain's, less one.
double area_error(const Problem& problem, const Cutting& cutting) {
  double sum = 0.0;
  for (const Polygon& block : cutting.blocks) sum += signed_area(block);
  return sum / problem.domain.area() - 1.0;
}

double perimeters(const std::vector<Polygon>& blocks) {
  double sum = 0.0;
  for (const Polygon& block : blocks) {
    for (std::size_t i = 0; i < block.size(); ++i) sum += (block[(i + 1) % block.size()] - block[i]).norm();
  }
  return sum;
}

std::vector<Vec2> distinct_vertices_of(const std::vector<Polygon>& blocks) {
  std::vector<Vec2> all;
  for (const Polygon& block : blocks) all.insert(all.end(), block.begin(), block.end());
  std::sort(all.begin(), all.end(), [](const Vec2& a, const Vec2& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Vertices that are not the same to the last bit are apart; one inside a block's polygon would be an overlap.
void check_vertices(const std::vector<Polygon>& blocks, double rounding) {
  const std::vector<Vec2> all = distinct_vertices_of(blocks);
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    for (std::size_t j = i + 1; j < all.size() && all[j].x() - all[i].x() < tolerance::shortest_edge_m; ++j) {
      if ((all[j] - all[i]).norm() < tolerance::shortest_edge_m) FAIL("vertices that should be one differ in their last bits");
    }
  }
  for (const Polygon& block : blocks) {
    const Box box = Box::around(block);
    for (const Vec2& vertex : all) {
      if (box.contains(vertex) && contains(block, vertex) && distance_to_boundary(block, vertex) > rounding) FAIL("a vertex lies inside a block");
    }
  }
}

}  // namespace

TEST_CASE("any joints in any domain: area, shapes, corners, order", "[geometry][cutting]") {
  Generator generator(20240611);
  int cut_problems = 0;
  std::size_t blocks = 0;
  for (int round = 0; round < 600; ++round) {
    INFO("round " << round);
    const double size = std::pow(10.0, round % 4);
    const Vec2 centre = round % 3 == 0 ? Vec2(5.0e5, 5.2e6) : Vec2(0.3 * size, -0.4 * size);
    const Problem problem = random_problem(generator, size, centre);
    const Cutting cutting = cut(problem);
    CHECK_FALSE(cutting.too_many);
    if (cutting.blocks.empty()) {
      CHECK_FALSE(cutting.loose_holes.empty());
      continue;
    }
    ++cut_problems;
    blocks += cutting.blocks.size();
    for (const Polygon& block : cutting.blocks) {
      CHECK(signed_area(block) > 0.0);
      CHECK_FALSE(first_self_intersection(block));
      CHECK(corners(block).size() == block.size());
    }
    // A corner on the edge of a neighbour lies beside it by the rounding of its coordinates.
    const double rounding = 0x1p-52 * (centre.cwiseAbs().maxCoeff() + size);
    CHECK(std::abs(area_error(problem, cutting)) < 1e-12 + rounding * perimeters(cutting.blocks) / problem.domain.area());
    if (cutting.blocks.size() < 200) check_vertices(cutting.blocks, 4.0 * rounding);
    CHECK(cut(permuted(generator, problem)).blocks == cutting.blocks);
    CHECK(cut(rewritten(generator, problem)).blocks == cutting.blocks);
  }
  CHECK(cut_problems > 400);
  CHECK(blocks > 10000);
}

TEST_CASE("a cutting moves with its domain, to the rounding of the corners", "[geometry][cutting]") {
  Generator generator(77);
  for (int round = 0; round < 100; ++round) {
    INFO("round " << round);
    Problem problem{{{{-40.0, -30.0}, {40.0, -30.0}, {40.0, 30.0}, {10.0, 12.0}, {-40.0, 30.0}}, {}}, {}, 0};
    // Coordinates with few digits can be moved without rounding.
    const auto place = [&] { return Vec2(any_of(generator, 100 * 1024) / 1024.0 - 50.0, any_of(generator, 80 * 1024) / 1024.0 - 40.0); };
    for (int line = 0; line < 25; ++line) problem.add({place(), place()});
    const Cutting here = cut(problem);
    const Vec2 shift(3.0 * 0x1p20, -5.0 * 0x1p20);
    const Cutting there = cut(moved(problem, shift));
    REQUIRE(there.blocks.size() == here.blocks.size());
    for (std::size_t b = 0; b < here.blocks.size(); ++b) {
      Polygon expected = here.blocks[b];
      for (Vec2& vertex : expected) vertex += shift;
      CHECK(there.blocks[b] == expected);
    }
  }
}

TEST_CASE("joint sets on a national grid give the blocks they give at the origin", "[geometry][cutting]") {
  const auto blocks_at = [](const Vec2& shift) {
    Problem problem{{{{0.0, 0.0}, {30.0, 0.0}, {30.0, 20.0}, {12.0, 20.0}, {5.0, 6.0}, {0.0, 6.0}}, {}}, {}, 0};
    problem = moved(problem, shift);
    for (const double dip_deg : {20.0, 75.0}) {
      JointSet set;
      set.dip = dip_deg * pi / 180.0;
      set.spacing = 0.25;
      set.origin = shift + Vec2(5.0, 6.0);
      problem.add(set);
    }
    return cut(problem).blocks;
  };
  const Vec2 shift(437512.3, 5287123.7);
  const std::vector<Polygon> here = blocks_at(Vec2::Zero());
  const std::vector<Polygon> there = blocks_at(shift);
  REQUIRE(there.size() == here.size());
  REQUIRE(here.size() > 5000);
  // Coordinates of 5e6 m are rounded to 9.3e-10 m; the ends of two joints, which cross at 55 degrees, and the corner itself are.
  const double rounding = 6.0 * 0x1p-30;
  for (std::size_t b = 0; b < here.size(); ++b) {
    // No corners have come from bends that are mere rounding.
    REQUIRE(there[b].size() == here[b].size());
    for (std::size_t i = 0; i < here[b].size(); ++i) CHECK((there[b][i] - shift - here[b][i]).norm() < rounding);
  }
}

TEST_CASE("so many crossings are refused before they are built", "[geometry][cutting]") {
  // Every line of one fan crosses every one of the other: twenty times the limit.
  Problem problem{{{{0.0, 0.0}, {4.0, 0.0}, {4.0, 4.0}, {0.0, 4.0}}, {}}, {}, 0};
  Generator generator(3);
  for (int i = 0; i < 1000; ++i) {
    const auto height = [&] { return uniform_in(generator, 0.5, 3.5); };
    problem.add({{-1.0, height()}, {5.0, height()}});
    problem.add({{height(), -1.0}, {height(), 5.0}});
  }
  CuttingLimits limits;
  limits.max_blocks = 50000;
  CHECK(cut_blocks(problem.domain, problem.traces, problem.labels(), limits).too_many);
  // No crossing is looked at after the one that is too many.
  std::vector<SourceSegment> segments;
  for (const JointTrace& trace : problem.traces) segments.push_back({trace.segment, trace.joint, false});
  std::size_t looked_at = 0;
  const std::size_t allowed = 50000;
  const ArrangementLimits growth{100 * segments.size() * segments.size(), allowed, [&](const Vec2&) { return ++looked_at > 0; }};
  CHECK_FALSE(arrange(segments, growth));
  CHECK(looked_at > allowed);
  CHECK(looked_at <= allowed + segments.size());
}
