#include "openclose/limit_analysis/failing_blocks.h"
#include "support/catch.h"

using namespace openclose::limit_analysis;

TEST_CASE("failing blocks: those faster than a hundredth of the fastest, by their fastest vertex") {
  Problem problem;
  std::vector<std::vector<Point>> outlines;
  for (const double x : {0.0, 10.0, 20.0, 30.0}) {
    outlines.push_back({{x, 0}, {x, 2}, {x + 1, 2}, {x + 1, 0}});  // clockwise: the area is positive nevertheless
    problem.blocks.push_back({.centroid = {x + 0.5, 1}});
  }
  const double radius = std::hypot(0.5, 1);
  const Mechanism mechanism = {{{1, 0}, 0}, {{0.0099, 0}, 0}, {{0, 0}, 0.011 / radius}, {{0, 0}, 0}};
  const FailingBlocks failing = failing_blocks(problem, outlines, mechanism);
  CHECK(failing.blocks == std::vector<int>{0, 2});
  CHECK(failing.area == 4);
  CHECK(failing.low == Point(0, 0));
  CHECK(failing.high == Point(21, 2));
  CHECK(failing_blocks(problem, outlines, Mechanism(4)).blocks.empty());
}
