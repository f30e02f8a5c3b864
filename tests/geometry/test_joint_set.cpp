#include <algorithm>
#include <cmath>
#include <numbers>

#include "openclose/geometry/joint_set.h"
#include "support/catch.h"

using namespace openclose;
using std::numbers::pi;

namespace {

const Polygon square{{0.0, 0.0}, {10.0, 0.0}, {10.0, 10.0}, {0.0, 10.0}};

JointSet set_of(double dip_deg, double spacing) {
  JointSet set;
  set.dip = dip_deg * pi / 180.0;
  set.spacing = spacing;
  return set;
}

double mean_length(const std::vector<SetTrace>& segments) {
  double sum = 0.0;
  for (const Segment& segment : segments) sum += segment.length();
  return sum / static_cast<double>(segments.size());
}

}  // namespace

TEST_CASE("directions are exact at right angles", "[geometry][joint_set]") {
  CHECK(direction(0.0) == Vec2(1.0, 0.0));
  CHECK(direction(pi / 2.0) == Vec2(0.0, 1.0));
  CHECK(direction(-pi / 2.0) == Vec2(0.0, -1.0));
  CHECK(direction(pi) == Vec2(-1.0, 0.0));
  CHECK(direction(1e-9).y() == Approx(1e-9));
}

TEST_CASE("a positive dip rises to the right", "[geometry][joint_set]") {
  const std::vector<SetTrace> up = *traces(set_of(30.0, 1.0), square, 1000);
  const std::vector<SetTrace> down = *traces(set_of(-30.0, 1.0), square, 1000);
  const auto slope = [](const Segment& segment) { return (segment.to - segment.from).y() / (segment.to - segment.from).x(); };
  CHECK(slope(up[3]) == Approx(std::tan(pi / 6.0)));
  CHECK(slope(down[3]) == Approx(-std::tan(pi / 6.0)));
}

TEST_CASE("joints run through the domain at their spacing, one through the origin", "[geometry][joint_set]") {
  JointSet set = set_of(0.0, 2.0);
  set.origin = {-77.0, 105.0};
  const std::vector<SetTrace> joints = *traces(set, square, 1000);
  REQUIRE(joints.size() == 5);
  for (int i = 0; i < 5; ++i) {
    CHECK(joints[i].from.y() == 1.0 + 2.0 * i);
    CHECK(std::min(joints[i].from.x(), joints[i].to.x()) < 0.0);
    CHECK(std::max(joints[i].from.x(), joints[i].to.x()) > 10.0);
  }
}

TEST_CASE("a dip and its opposite are the same joints", "[geometry][joint_set]") {
  CHECK(traces(set_of(35.0, 1.5), square, 1000)->size() == traces(set_of(-145.0, 1.5), square, 1000)->size());
}

TEST_CASE("traces and gaps", "[geometry][joint_set]") {
  JointSet set = set_of(0.0, 1.0);
  set.origin = {0.0, 0.5};
  set.trace_length = 2.0;
  set.gap = 1.0;
  SECTION("begin at the origin") {
    const std::vector<SetTrace> all = *traces(set, square, 1000);
    const auto first = std::find_if(all.begin(), all.end(), [](const Segment& s) { return s.from == Vec2(3.0, 0.5); });
    REQUIRE(first != all.end());
    CHECK(first->to == Vec2(5.0, 0.5));
  }
  SECTION("are shifted from joint to joint") {
    set.stagger = 0.5;
    const std::vector<SetTrace> all = *traces(set, square, 1000);
    const auto at = [&](const Vec2& from) { return std::any_of(all.begin(), all.end(), [&](const Segment& s) { return s.from == from; }); };
    CHECK(at({3.0, 0.5}));
    CHECK(at({4.5, 1.5}));
    CHECK(at({3.0, 2.5}));
  }
  SECTION("scatter by as much as they are told to") {
    set.trace_scatter = 0.5;
    set.spacing = 0.05;
    const std::vector<SetTrace> all = *traces(set, square, 100000);
    double longest = 0.0;
    for (const Segment& segment : all) longest = std::max(longest, segment.length());
    CHECK(longest <= 3.0);
    CHECK(longest > 2.9);
  }
}

TEST_CASE("a region bounds its joints", "[geometry][joint_set]") {
  JointSet set = set_of(0.0, 1.0);
  set.origin = {0.0, 0.5};
  // A notch in the region's top parts the upper joints.
  set.region = {{2.0, 2.0}, {8.0, 2.0}, {8.0, 6.0}, {6.0, 6.0}, {6.0, 4.0}, {4.0, 4.0}, {4.0, 6.0}, {2.0, 6.0}};
  const std::vector<SetTrace> all = *traces(set, square, 1000);
  CHECK(all.size() == 6);
  CHECK(mean_length(all) == Approx((2 * 6.0 + 4 * 2.0) / 6.0));
}

TEST_CASE("scatter is the same everywhere", "[geometry][joint_set]") {
  SECTION("the generator's numbers do not change") {
    CHECK(uniform(1, 0, 0, 0) == uniform(1, 0, 0, 0));
    CHECK(uniform(1, 0, 0, 0) != uniform(2, 0, 0, 0));
    CHECK(uniform(1, 0, 0, 0) != uniform(1, 1, 0, 0));
    CHECK(uniform(1, 0, 0, 0) != uniform(1, 0, 1, 0));
    CHECK(uniform(1, 0, 0, 0) != uniform(1, 0, 0, 1));
    CHECK(uniform(1, 0, 0, 0) == 0x1.8a06577767b92p-1);
    CHECK(uniform(12345, -7, 3, 99) == 0x1.abe016f1bcde8p-1);
  }
  SECTION("they are uniform between -1 and 1") {
    double sum = 0.0;
    double squares = 0.0;
    const int count = 100000;
    for (int i = 0; i < count; ++i) {
      const double number = uniform(1, i - 1000, 2, 0);
      REQUIRE(number >= -1.0);
      REQUIRE(number < 1.0);
      sum += number;
      squares += number * number;
    }
    // Standard errors: 1/sqrt(3 n) and sqrt(4/45/n).
    CHECK(std::abs(sum / count) < 4.0 / std::sqrt(3.0 * count));
    CHECK(squares / count == Approx(1.0 / 3.0).margin(4.0 * std::sqrt(4.0 / 45.0 / count)));
  }
  SECTION("a joint does not depend on the domain") {
    JointSet set = set_of(20.0, 0.7);
    set.spacing_scatter = 0.5;
    set.dip_scatter = 0.1;
    const Polygon larger{{-30.0, -30.0}, {10.0, -30.0}, {10.0, 10.0}, {-30.0, 10.0}};
    const std::vector<SetTrace> few = *traces(set, square, 1000);
    const std::vector<SetTrace> many = *traces(set, larger, 1000);
    for (const Segment& segment : few) {
      const auto on_line = [&](const Segment& other) {
        return distance_to_segment(segment.from, other.from, other.to) < 0.3 &&
               std::abs(cross((segment.to - segment.from).normalized(), (other.to - other.from).normalized())) < 1e-12;
      };
      CHECK(std::any_of(many.begin(), many.end(), on_line));
    }
  }
  SECTION("a domain has all joints that a larger one has there") {
    JointSet set = set_of(20.0, 0.7);
    set.spacing_scatter = 0.5;
    set.dip_scatter = 0.1;
    set.origin = {-25.0, 3.0};  // far away: a joint that turns a little goes a long way to the side
    const Polygon larger{{-60.0, -60.0}, {60.0, -60.0}, {60.0, 60.0}, {-60.0, 60.0}};
    // Within the square, clear of its boundary by what joints run over it.
    const auto inside = [](const std::vector<SetTrace>& segments) {
      std::vector<double> heights;
      for (const Segment& s : segments) {
        const Vec2 along = s.to - s.from, middle(5.0, 5.0);
        const double height = s.from.y() + (middle.x() - s.from.x()) / along.x() * along.y();
        if (height > 0.0 && height < 10.0) heights.push_back(height);
      }
      std::sort(heights.begin(), heights.end());
      return heights;
    };
    const std::vector<double> here = inside(*traces(set, square, 1000)), there = inside(*traces(set, larger, 1000));
    REQUIRE(here.size() > 5);
    REQUIRE(here.size() == there.size());
    for (std::size_t i = 0; i < here.size(); ++i) CHECK(here[i] == Approx(there[i]).margin(1e-10));
  }
}

TEST_CASE("scattered spacings and dips stay within their bounds", "[geometry][joint_set]") {
  JointSet set = set_of(0.0, 0.1);
  SECTION("spacing") {
    set.spacing_scatter = 0.3;
    std::vector<double> heights;
    const std::vector<SetTrace> all = *traces(set, square, 1000);
    for (const Segment& segment : all) heights.push_back(segment.from.y());
    std::sort(heights.begin(), heights.end());
    double smallest = 1.0;
    double largest = 0.0;
    for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
      smallest = std::min(smallest, heights[i + 1] - heights[i]);
      largest = std::max(largest, heights[i + 1] - heights[i]);
    }
    CHECK(smallest >= 0.07 - 1e-12);
    CHECK(smallest < 0.075);
    CHECK(largest <= 0.13 + 1e-12);
    CHECK(largest > 0.125);
  }
  SECTION("dip") {
    set.dip_scatter = 0.05;
    double steepest = 0.0;
    const std::vector<SetTrace> all = *traces(set, square, 1000);
    for (const Segment& segment : all) {
      const Vec2 along = segment.to - segment.from;
      steepest = std::max(steepest, std::abs(std::atan2(along.y(), along.x())));
    }
    CHECK(steepest <= 0.05);
    CHECK(steepest > 0.045);
  }
}

TEST_CASE("sets with too many traces are not made", "[geometry][joint_set]") {
  CHECK_FALSE(traces(set_of(30.0, 1e-9), square, 1000));
  CHECK(traces(set_of(0.0, 1.0), square, 12));
  CHECK_FALSE(traces(set_of(0.0, 1.0), square, 5));
  JointSet set = set_of(30.0, 1.0);
  SECTION("short traces") {
    set.trace_length = 1e-9;
    CHECK_FALSE(traces(set, square, 1000));
  }
  SECTION("scatter from an origin far away") {
    set.spacing_scatter = 0.1;
    set.origin = {1e7, -1e7};
    CHECK_FALSE(traces(set, square, 1000));
  }
}

TEST_CASE("a set with bridges is the whole of every line that has a trace", "[geometry][joint_set]") {
  JointSet set = set_of(0.0, 3.0);
  set.origin = {0.0, 1.0};
  set.trace_length = 4.0;
  set.gap = 3.0;
  const std::vector<SetTrace> open = *traces(set, square, 1000);
  set.has_bridges = true;
  const std::vector<SetTrace> all = *traces(set, square, 1000);
  double joints = 0.0;
  for (const SetTrace& trace : open) joints += trace.length();
  double length = 0.0, bridges = 0.0;
  std::size_t ends = 0;
  for (const SetTrace& trace : all) {
    length += trace.length();
    if (trace.is_bridge) bridges += trace.length();
    ends += (trace.goes_on_from ? 0 : 1) + (trace.goes_on_to ? 0 : 1);
  }
  // Four lines of 10.2 m in the box around the square: [0, 4] and [7, 10.1] are joint, and no trace lies at the beginning.
  CHECK(open.size() == 8);
  CHECK(all.size() == 16);
  CHECK(ends == 8);
  CHECK(length == Approx(4 * 10.2).epsilon(1e-12));
  CHECK(bridges == Approx(4 * 3.1).epsilon(1e-12));
  CHECK(length - bridges == Approx(joints).epsilon(1e-12));
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    CHECK(all[i].goes_on_to == (all[i].to == all[i + 1].from));
    CHECK(all[i].goes_on_to == all[i + 1].goes_on_from);
    CHECK((!all[i].goes_on_to || all[i].is_bridge != all[i + 1].is_bridge));
  }

  SECTION("within its region") {
    set.region = {{1.0, 0.5}, {9.0, 0.5}, {9.0, 4.5}, {1.0, 4.5}};
    const std::vector<SetTrace> some = *traces(set, square, 1000);
    REQUIRE(some.size() == 6);
    CHECK(some[0].from == Vec2(1.0, 1.0));
    CHECK(some[1].is_bridge);
    CHECK((some[1].from - Vec2(4.0, 1.0)).norm() < 1e-14);
    CHECK(some[2].to == Vec2(9.0, 1.0));
  }
  SECTION("a line without a trace has no bridges") {
    // Every second line has its trace at the left side.
    set.gap = 100.0;
    set.stagger = 0.5;
    const std::vector<SetTrace> found = *traces(set, square, 1000);
    for (const SetTrace& trace : found) CHECK(std::min(trace.from.y(), trace.to.y()) < 8.0);
    CHECK(found.size() == 6);
  }
  SECTION("scattered traces, those behind the origin too, come in their order") {
    set.origin = {5.0, 1.0};
    set.trace_length = 1.0;
    set.gap = 1.0;
    set.trace_scatter = 0.5;
    const std::vector<SetTrace> scattered = *traces(set, square, 1000);
    set.has_bridges = false;
    const std::vector<SetTrace> without = *traces(set, square, 1000);
    double sum = 0.0, joint = 0.0, alone = 0.0;
    for (const SetTrace& trace : scattered) {
      sum += trace.length();
      if (!trace.is_bridge) joint += trace.length();
    }
    for (const SetTrace& trace : without) alone += trace.length();
    CHECK(sum == Approx(4 * 10.2).epsilon(1e-12));
    CHECK(joint == Approx(alone).epsilon(1e-12));
  }
  SECTION("joints that run through end at the region") {
    JointSet through = set_of(0.0, 3.0);
    through.has_bridges = true;
    CHECK(traces(through, square, 1000)->size() == 4);
    const std::vector<SetTrace> found = *traces(through, square, 1000);
    for (const SetTrace& trace : found) CHECK_FALSE(trace.is_bridge);
  }
}
