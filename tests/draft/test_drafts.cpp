#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include "openclose/analytical/masonry_arch.h"
#include "openclose/core/error.h"
#include "openclose/draft/drafts.h"
#include "openclose/geometry/box.h"
#include "openclose/geometry/polygon.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

namespace {

const Draft& draft_named(std::string_view name) {
  return *std::ranges::find(drafts(), name, &Draft::name);
}

Scene scene_with(std::string_view draft, const std::map<std::string, double>& asked = {}) {
  return scene_of_text(scene_from(draft_named(draft), asked), "new.toml");
}

std::string error_of(std::string_view draft, const std::map<std::string, double>& asked) {
  try {
    scene_from(draft_named(draft), asked);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::size_t free_blocks(const Scene& scene) {
  return static_cast<std::size_t>(std::ranges::count(scene.blocks, false, &BlockInput::fixed));
}

}  // namespace

TEST_CASE("every draft is a scene that is checked without a warning, and each of its keys has a comment", "[draft]") {
  for (const Draft& draft : drafts()) {
    INFO(draft.name);
    const std::string text = scene_from(draft, {});
    const Scene scene = scene_of_text(text, "new.toml");
    CHECK(check_scene(scene).empty());
    CHECK(free_blocks(scene) > 10);
    CHECK(scene.step.dt > 0.0);
    CHECK(scene.end_time > 0.0);
    std::istringstream lines(text);
    std::set<std::string> explained;
    std::string table, above;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with('[')) table = line;
      const std::size_t equals = line.find(" = ");
      if (!line.starts_with('#') && equals != std::string::npos && explained.insert(table + line.substr(0, equals)).second) {
        INFO(line);
        CHECK((line.find("  # ") != std::string::npos || above.starts_with("# ")));
      }
      above = line;
    }
  }
}

TEST_CASE("every dimension changes the scene", "[draft]") {
  for (const Draft& draft : drafts()) {
    // A wall with a door, in which there is room for another one.
    std::map<std::string, double> usual;
    if (draft.name == "wall") usual = {{"bricks", 15.0}, {"door_bricks", 2.0}};
    const std::string text = scene_from(draft, usual);
    for (const Dimension& dimension : draft.dimensions) {
      const std::string name(dimension.name);
      INFO(draft.name << "." << name);
      const double value = usual.contains(name) ? usual.at(name) : dimension.value;
      std::map<std::string, double> asked = usual;
      asked[name] = value + 1.0;
      CHECK(scene_from(draft, asked) != text);
      asked[name] = value;
      CHECK(scene_from(draft, asked) == text);
    }
  }
}

TEST_CASE("an arch has the voussoirs that the line of thrust knows", "[draft][arch]") {
  for (const int n : {3, 10, 15}) {
    const Scene scene = scene_with("arch", {{"voussoirs", n}, {"radius_m", 1.0}, {"thickness_m", 0.2}, {"springing_deg", 0.0}});
    const auto expected = analytical::straight_voussoirs(n, 0.2);
    REQUIRE(scene.blocks.size() == expected.size() + 2);
    CHECK(scene.blocks.front().fixed);
    CHECK(scene.blocks.back().fixed);
    CHECK(free_blocks(scene) == expected.size());
    for (int k = 0; k < n; ++k) {
      for (const auto& [x, y] : expected[k]) CHECK(distance_to_boundary(scene.blocks[k + 1].vertices, {x, y}) < 1e-8);
      CHECK(scene.blocks[k + 1].vertices.size() == 4);
    }
  }
  // 15 degrees above the horizontal at either end.
  const Scene flat = scene_with("arch");
  const Vec2 joint = flat.blocks[1].vertices[2] - flat.blocks[1].vertices[3];
  CHECK(std::atan2(joint.y(), -joint.x()) == Approx(15.0 * std::numbers::pi / 180.0).epsilon(1e-8));
  CHECK(joint.norm() == Approx(0.36).epsilon(1e-8));
}

TEST_CASE("a wall has its bricks, and a door under a lintel", "[draft][wall]") {
  // Odd courses have nine bricks, even ones ten pieces, of which two are halves.
  CHECK(free_blocks(scene_with("wall")) == 5 * 9 + 4 * 10);
  const auto area = [](const Scene& scene) {
    double sum = 0.0;
    for (const BlockInput& block : scene.blocks) sum += block.fixed ? 0.0 : signed_area(block.vertices);
    return sum;
  };
  CHECK(area(scene_with("wall")) == Approx(9 * 0.6 * 9 * 0.4));
  const Scene door = scene_with("wall", {{"door_bricks", 2.0}, {"door_courses", 3.0}});
  CHECK(area(door) == Approx(9 * 0.6 * 9 * 0.4 - 2 * 0.6 * 3 * 0.4));
  const auto lintel = std::ranges::find_if(door.blocks, [](const BlockInput& b) { return !b.fixed && longest_edge(b.vertices) > 0.61; });
  REQUIRE(lintel != door.blocks.end());
  CHECK(longest_edge(lintel->vertices) == Approx(3 * 0.6));
  CHECK(lintel->vertices.front().y() == Approx(3 * 0.4));
  CHECK(check_scene(door).empty());
  CHECK(scene_with("wall", {{"tilt_deg", 0.0}}).gravity == Vec2(0.0, -9.81));
  CHECK(scene_with("wall", {{"tilt_deg", 30.0}}).gravity.isApprox(9.81 * Vec2(0.5, -std::sqrt(0.75)), 1e-14));
  CHECK_THAT(error_of("wall", {{"door_bricks", 6.0}}), StartsWith("new wall: the doors do not fit"));
}

TEST_CASE("walls and arches are dry: friction alone holds their joints", "[draft]") {
  for (const std::string name : {"wall", "arch"}) {
    const Scene scene = scene_with(name);
    REQUIRE(scene.joints.size() == 1);
    CHECK(scene.joints[0].friction_angle > 0.0);
    CHECK(scene.joints[0].cohesion == 0.0);
    CHECK(scene.joints[0].tensile_strength == 0.0);
  }
}

TEST_CASE("a wall has windows at equal distances, whole courses above and below them", "[draft][wall]") {
  const Scene scene =
      scene_with("wall", {{"bricks", 14.0}, {"door_bricks", 2.0}, {"door_courses", 3.0}, {"doors", 2.0}, {"sill_courses", 2.0}, {"tilt_deg", 0.0}});
  CHECK(check_scene(scene).empty());
  std::vector<double> of_course(9, 0.0);  // [m2]
  double narrowest = 1e9, lintels = 0.0;
  for (const BlockInput& block : scene.blocks) {
    if (block.fixed) continue;
    const Box box = Box::around(block.vertices);
    of_course[static_cast<std::size_t>(std::lround(box.low.y() / 0.4))] += signed_area(block.vertices);
    narrowest = std::min(narrowest, box.high.x() - box.low.x());
    lintels += box.high.x() - box.low.x() > 0.61 ? 1.0 : 0.0;
  }
  for (std::size_t course = 0; course < of_course.size(); ++course)
    CHECK(of_course[course] == Approx((course >= 2 && course < 5 ? 10.0 : 14.0) * 0.6 * 0.4));
  CHECK(narrowest == Approx(0.3));
  CHECK(lintels == 2.0);
  CHECK_THAT(error_of("wall", {{"door_bricks", 2.0}, {"doors", 2.0}}), StartsWith("new wall: the doors do not fit"));
  CHECK_THAT(error_of("wall", {{"door_bricks", 2.0}, {"sill_courses", 4.0}}), StartsWith("new wall: the doors do not fit"));
}

TEST_CASE("a slope has its outline and its joints", "[draft][slope]") {
  const Scene scene = scene_with("slope", {{"height_m", 30.0}, {"face_angle_deg", 90.0}, {"bench_m", 10.0}, {"depth_m", 5.0}, {"behind_m", 40.0}});
  REQUIRE(scene.cutting);
  CHECK(scene.cutting->domain_area == Approx(30.0 * 40.0 + 5.0 * 50.0));
  CHECK(free_blocks(scene) > 20);
  // Spacings wider than the slope leave the two joints through the toe: the wedge above the bedding, and three parts of the ground that are fixed.
  const Scene wedge = scene_with("slope", {{"bedding_spacing_m", 1000.0}, {"cross_spacing_m", 1000.0}});
  CHECK(wedge.blocks.size() == 4);
  CHECK(free_blocks(wedge) == 1);
  CHECK_THAT(error_of("slope", {{"bedding_spacing_m", 1e-4}}),
             StartsWith("new slope: these dimensions make no scene together (new:") && ContainsSubstring("accepted: the default ones"));
}

TEST_CASE("dimensions that a draft has not, or that are out of range, are refused", "[draft][errors]") {
  CHECK(error_of("arch", {{"height_m", 3.0}}) ==
        "new arch: height_m: it has no such dimension; accepted: voussoirs, radius_m, thickness_m, springing_deg, tilt_deg");
  CHECK(error_of("arch", {{"radius_m", 0.0}}) == "new arch: radius_m: 0 is out of range; accepted: a number > 0");
  CHECK(error_of("arch", {{"voussoirs", 4.5}}) == "new arch: voussoirs: 4.5 is out of range; accepted: a whole number in [3, 999]");
  CHECK(error_of("arch", {{"radius_m", std::nan("")}}) == "new arch: radius_m: nan is out of range; accepted: a number > 0");
  CHECK(error_of("arch", {{"thickness_m", 5.0}}) ==
        "new arch: thickness_m: an arch of radius 2 m cannot be 5 m thick; accepted: less than twice the radius, 4");
}

TEST_CASE("a new slope shows how a joint set gets a strength of its own", "[draft][slope]") {
  const std::string text = scene_from(draft_named("slope"), {});
  CHECK_THAT(text, ContainsSubstring("# name = \"bedding\"") && ContainsSubstring("# joint = \"bedding\""));
}
