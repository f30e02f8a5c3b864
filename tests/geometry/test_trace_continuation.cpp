#include "openclose/geometry/trace_continuation.h"
#include "support/catch.h"
#include "support/polygons.h"

using namespace openclose;
using builders::rectangle_between;

namespace {

constexpr double reach = 1e-3;
const Polygon square = rectangle_between({0.0, 0.0}, {10.0, 10.0}), hole = rectangle_between({4.0, 4.0}, {6.0, 6.0});

JointTrace bridged(const Vec2& from, const Vec2& to) {
  return {{from, to}, 0, 7};
}

/// Where the traces that were added run.
std::vector<Segment> added(std::vector<JointTrace> traces, const std::vector<const Polygon*>& rings = {&square}) {
  const std::size_t given = traces.size();
  continue_traces(traces, rings, reach);
  std::vector<Segment> more;
  for (std::size_t i = given; i < traces.size(); ++i) {
    CHECK(traces[i].joint == 7);
    CHECK(traces[i].goes_on_from);
    CHECK_FALSE(traces[i].goes_on_to);
    more.push_back(traces[i].segment);
  }
  return more;
}

void check_same(const Segment& segment, const Vec2& from, const Vec2& to) {
  CHECK((segment.from - from).norm() < 1e-12);
  CHECK((segment.to - to).norm() < 1e-12);
}

}  // namespace

TEST_CASE("a trace that ends in rock goes on to the outline and to holes", "[geometry][continuation]") {
  const std::vector<Segment> more = added({bridged({2.0, 5.0}, {3.0, 5.0})}, {&square, &hole});
  REQUIRE(more.size() == 2);
  check_same(more[0], {2.0, 5.0}, {0.0, 5.0});
  check_same(more[1], {3.0, 5.0}, {4.0, 5.0});
  CHECK(added({bridged({7.0, 5.0}, {8.0, 5.0})}, {&square, &hole}).size() == 2);
  // What ends outside, or in the hole, has nothing to meet.
  CHECK(added({bridged({-1.0, 5.0}, {5.0, 5.0})}, {&square, &hole}).empty());
}

TEST_CASE("a trace that ends in rock goes on to the next trace", "[geometry][continuation]") {
  const JointTrace near{{{5.0, 0.0}, {5.0, 10.0}}, 1}, far{{{7.0, 0.0}, {7.0, 10.0}}, 1};
  for (const bool turned : {false, true}) {
    const std::vector<Segment> more = added({far, turned ? bridged({3.0, 2.0}, {1.0, 2.0}) : bridged({1.0, 2.0}, {3.0, 2.0}), near});
    REQUIRE(more.size() == 2);
    check_same(more[turned ? 0 : 1], {3.0, 2.0}, {5.0, 2.0});
    check_same(more[turned ? 1 : 0], {1.0, 2.0}, {0.0, 2.0});
  }
  SECTION("also to one in its own line, and to the end of one beside it") {
    const std::vector<Segment> more = added({bridged({0.0, 2.0}, {2.0, 2.0}), {{{4.0, 2.0}, {10.0, 2.0}}, 1}});
    REQUIRE(more.size() == 1);
    check_same(more[0], {2.0, 2.0}, {4.0, 2.0});
    check_same(added({bridged({0.0, 2.0}, {2.0, 2.0}), {{{4.0, 2.0005}, {4.0, 10.0}}, 1}}).front(), {2.0, 2.0}, {4.0, 2.0});
    CHECK(added({bridged({0.0, 2.0}, {2.0, 2.0}), {{{4.0, 2.002}, {4.0, 10.0}}, 1}}).front().to.x() == 10.0);
  }
  SECTION("what is led on does not stop another one") {
    const std::vector<Segment> more = added({bridged({0.0, 2.0}, {2.0, 2.0}), bridged({4.0, 10.0}, {4.0, 4.0})});
    REQUIRE(more.size() == 2);
    check_same(more[0], {2.0, 2.0}, {10.0, 2.0});
    check_same(more[1], {4.0, 4.0}, {4.0, 0.0});
  }
}

TEST_CASE("an end that reaches something, or that another trace continues, does not go on", "[geometry][continuation]") {
  const JointTrace upright{{{5.0, 0.0}, {5.0, 10.0}}, 1};
  for (const double past : {0.0, 5e-4, -5e-4}) CHECK(added({bridged({0.0, 2.0}, {5.0 + past, 2.0}), upright}).empty());
  CHECK(added({bridged({0.0, 2.0}, {5.002, 2.0}), upright}).size() == 1);
  CHECK(added({bridged({0.0, 2.0}, {9.9995, 2.0})}).empty());
  JointTrace continued = bridged({0.0, 2.0}, {3.0, 2.0});
  continued.goes_on_to = true;
  CHECK(added({continued}).empty());
  std::vector<JointTrace> without_bridge{{{{1.0, 2.0}, {3.0, 2.0}}, 0}};
  CHECK_FALSE(continue_traces(without_bridge, {&square}, reach));
  CHECK(without_bridge.size() == 1);
}
