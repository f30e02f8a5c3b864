#include "openclose/analysis/corner_entry.h"
#include "openclose/analysis/run.h"
#include "openclose/core/tolerance.h"
#include "openclose/geometry/overlap.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;

namespace {

constexpr double tolerated = 1e-6;  // [m]

/// Of a block that starts at this height above the base, 10 m from its left end or shifted, and moves by d.
double entry_from(double height, const Motion::Unknowns& d, double shift = 0.0) {
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v += Vec2(shift, height);
  const BlockSystem system(scene);
  StepSolution solution;
  solution.d = d;
  return first_entry(system, solution, {{0, 1}}, {tolerated});
}

/// A square that comes down on its corner, past the corner of a fixed block, at 20 m/s.
Scene passing_corners(double dt) {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("base", {{-3.0, -2.0}, {0.0, -2.0}, {0.0, 0.0}, {-3.0, -0.5}}),
                  test::free_block("square", test::placed(test::rectangle(-0.5, -0.5, 1.0, 1.0), 0.7, {0.3, 1.0}))};
  scene.blocks[1].velocity = {-12.0, -16.0};
  scene.method.contact = "hard";
  scene.method.gap_tolerance = 3e-7;
  scene.step.dt = dt;
  scene.step.max_displacement = 1.0;
  return scene;
}

}  // namespace

TEST_CASE("a step ends where a corner enters a block", "[analysis][corner_entry]") {
  CHECK(entry_from(0.05, {0.3, -0.1, 0.0}) == Approx((0.05 + 0.5 * tolerated) / 0.1).epsilon(1e-8));
  SECTION("not where none does") {
    CHECK(entry_from(0.05, {0.3, -0.05, 0.0}) == 1.0);
    CHECK(entry_from(0.05, {0.0, -0.05 - 3.9 * tolerated, 0.0}) == 1.0);
    CHECK(entry_from(0.05, {0.0, 0.1, 0.0}) == 1.0);
  }
  SECTION("nor where it is in and goes no deeper") {
    CHECK(entry_from(-0.01, {0.1, 0.0, 0.0}) == 1.0);
    CHECK(entry_from(-0.01, {0.1, 0.005, 0.0}) == 1.0);
  }
  SECTION("nor at once") {
    CHECK(entry_from(0.0, {0.0, -0.1, 0.0}) == 1.0);
  }
  SECTION("but soon after the start") {
    CHECK(entry_from(tolerated, {0.0, -0.02, 0.0}) == Approx(1.5 * tolerated / 0.02).epsilon(1e-6));
  }
  SECTION("nor beside the end of an edge") {
    CHECK(entry_from(0.0, {1.0, 0.0, 0.0}, -12.5) == 1.0);
    CHECK(entry_from(-0.5, {1.0, 0.0, 0.0}, -12.5) == Approx(0.5 + 0.5 * tolerated).epsilon(1e-8));
  }
  SECTION("also if it leaves it again within the step") {
    CHECK(entry_from(0.05, {0.0, -1.1, 0.0}) == Approx(0.05 / 1.1).epsilon(1e-4));
  }
  SECTION("one that turns in") {
    const double angle = 0.2;  // the lower left corner goes down
    const double part = entry_from(0.01, {0.0, 0.0, angle});
    CHECK(part > 0.0);
    CHECK(part < 1.0);
    CHECK(entry_from(0.01, 0.9 * part * Motion::Unknowns(0.0, 0.0, angle)) == 1.0);  // the way is the chord of the arc
    CHECK(entry_from(0.01, 1.1 * part * Motion::Unknowns(0.0, 0.0, angle)) < 1.0);
  }
}

TEST_CASE("a tip that is behind another one's face by no more than flush corners are enters it all the same", "[analysis][corner_entry]") {
  // Two feet on one floor, tip to tip; the right one hangs a micrometre higher.
  const Vec2 face = Vec2(std::cos(57.0 * test::degree), std::sin(57.0 * test::degree)), outward(face.y(), -face.x()), tip(-5e-7, 1e-6);
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("left", {Vec2(0.0, 0.0), 2.0 * face, Vec2(-1.0, 1.5), Vec2(-1.0, 0.1)}),
                  test::free_block("right", {tip, tip + Vec2(2.0, 0.0), tip + Vec2(2.0, 0.5)})};
  const BlockSystem system(scene);
  StepSolution solution;
  const double way = 1e-4;
  solution.d = Motion::Unknowns(-way, 0.0, 0.0);
  // Until it is behind by twice what counts as flush.
  const double expected = (2.0 * tolerance::edge_end_m + outward.dot(tip)) / (way * outward.x());
  CHECK(first_entry(system, solution, {{0, 1}}, {tolerated}) == Approx(expected).epsilon(1e-6));
}

TEST_CASE("a corner that goes through another one's tip within a step is stopped in it, however little it may enter", "[analysis][corner_entry]") {
  // A thin wedge points at the left; its upper side rises steeply at the tip. The corner comes from the left and ends below the wedge.
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("wedge", {{0.0, 0.0}, {1.0, 0.2}, {1.0, 2.0}, {0.4, 1.0}}),
                  test::free_block("corner", {{-0.01, 1e-3}, {-1.0, 1.0}, {-1.0, 0.1}})};
  const BlockSystem system(scene);
  StepSolution solution;
  const auto part = [&](const Motion::Unknowns& d) {
    solution.d = d;
    return first_entry(system, solution, {{0, 1}}, {.depth = tolerated, .part_of_width = 0.1});
  };
  // Of the side from (0.4, 1) to (0, 0), which is 0.4 y in front of it: until it is behind by twice what counts as flush.
  const double outside = 0.01 + 0.4 * 1e-3, flush = 2.0 * tolerance::edge_end_m * std::hypot(1.0, 0.4);
  const double come = (outside + flush) / (0.013 + 0.4 * 9e-4);
  // Below the other side from (0, 0) to (1, 0.2): it is half-way to where it is as deep behind the one as behind the other.
  const auto behind_upper = [&](double p) { return ((0.013 + 0.4 * 9e-4) * p - outside) / std::hypot(1.0, 0.4); };
  const auto behind_lower = [&](double p) { return (1e-3 - 9e-4 * p - 0.2 * (0.013 * p - 0.01)) / std::hypot(1.0, 0.2); };
  const double difference = behind_lower(come) - behind_upper(come), slope = (behind_lower(1.0) - behind_upper(1.0) - difference) / (1.0 - come);
  CHECK(part({0.013, -9e-4, 0.0}) == Approx(come - 0.5 * difference / slope).epsilon(1e-6));
  CHECK(part({0.013, 3e-3, 0.0}) == 1.0);   // ends in the wedge, where it is found
  CHECK(part({0.013, -1e-2, 0.0}) == 1.0);  // passes below the tip

  // Where hardly anything is tolerated and the corner is behind the upper side by that already, it is met as soon as it is no longer flush.
  const double hardly = 1e-8;
  scene.blocks[1].vertices[0] = Vec2(0.4e-3 + hardly, 1e-3);
  const BlockSystem rigid(scene);
  solution.d = Motion::Unknowns(0.0026, -9e-4, 0.0);
  CHECK(first_entry(rigid, solution, {{0, 1}}, {.depth = hardly}) == Approx((flush - hardly) / (0.0026 + 0.4 * 9e-4)).epsilon(1e-4));
}

TEST_CASE("a tip that is behind another tip's face already, and nothing holds, is stopped before it is deep in the block",
          "[analysis][corner_entry]") {
  // The tip of the needle's block lies at the end of the wedge's face, behind it by more than flush corners are, and goes on into the wedge.
  Scene scene = test::empty_scene();
  const Vec2 along = Vec2(std::cos(37.0 * test::degree), std::sin(37.0 * test::degree)), inwards = perpendicular(along);
  const Vec2 tip = 1e-5 * inwards + 1e-5 * along;
  scene.blocks = {test::fixed_block("wedge", {{0.0, 0.0}, along, {-0.9, 0.4}}),
                  test::free_block("needle", {tip, tip + Vec2(2.0, 0.05), tip + Vec2(2.0, 0.5)})};
  const BlockSystem system(scene);
  StepSolution solution;
  const double way = 1e-2, deep = 1e-3;
  const Vec2 gone = way * inwards;
  solution.d = Motion::Unknowns(gone.x(), gone.y(), 0.0);
  const double part = first_entry(system, solution, {{0, 1}}, {deep});
  // Until it is behind by half of what is tolerated.
  CHECK(part == Approx((0.5 * deep - 1e-5) / way).epsilon(1e-6));
  const std::vector<Contact> held = [&] {
    Contact of_tip;
    of_tip.vertex = 3;
    of_tip.edge = 0;
    return std::vector<Contact>{of_tip};
  }();
  CHECK(first_entry(system, solution, {{0, 1}}, {deep}, held) == 1.0);
}

TEST_CASE("blocks whose sides cross pass into each other with no corner in the other one", "[analysis][corner_entry]") {
  // The tip of the right foot comes between the left one and the floor, which is not there.
  Scene scene = test::empty_scene();
  const Vec2 tip(0.01, 5e-4);
  scene.blocks = {test::fixed_block("left", {{0.0, 0.0}, {1.0, 1.5}, {-1.0, 1.5}, {-1.0, 0.1}}),
                  test::free_block("right", {tip, tip + Vec2(2.0, 0.0), tip + Vec2(2.0, 0.5)})};
  const BlockSystem system(scene);
  StepSolution solution;
  const auto passes = [&](const Motion::Unknowns& d, double allowed) {
    solution.d = d;
    return pass_into_each_other(system, solution, {{0, 1}}, allowed);
  };
  CHECK(passes({-0.02, 0.0, 0.0}, tolerated));
  CHECK_FALSE(passes({-0.009, 0.0, 0.0}, tolerated));
  CHECK_FALSE(passes({-0.02, 0.0, 0.0}, 0.02));
  CHECK_FALSE(passes({-0.02, -0.02, 0.0}, tolerated));  // under the left one
  SECTION("not again where they were so") {
    for (Vec2& v : scene.blocks[1].vertices) v -= Vec2(0.02, 0.0);
    const BlockSystem crossed(scene);
    solution.d = Motion::Unknowns(-0.001, 0.0, 0.0);
    CHECK_FALSE(pass_into_each_other(crossed, solution, {{0, 1}}, tolerated));
  }
}

TEST_CASE("a block may come into a trough, and not into its floor", "[analysis][corner_entry]") {
  Scene scene = test::empty_scene();
  scene.blocks = {test::fixed_block("trough", {{-2.0, -1.0}, {2.0, -1.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 0.0}, {-1.0, 0.0}, {-1.0, 1.0}, {-2.0, 1.0}}),
                  test::free_block("box", test::rectangle(-0.5, 1.2, 1.0, 1.0))};
  const BlockSystem system(scene);
  const auto passes = [&](double down) {
    StepSolution solution;
    solution.d = Motion::Unknowns(0.0, -down, 0.0);
    return pass_into_each_other(system, solution, {{0, 1}}, tolerated);
  };
  CHECK_FALSE(passes(1.1));
  CHECK(passes(1.3));
}

TEST_CASE("what a corner may enter goes with the width of the narrower block", "[analysis][corner_entry]") {
  Scene scene = test::block_on_base();
  for (Vec2& v : scene.blocks[1].vertices) v += Vec2(0.0, 0.05);
  const BlockSystem above(scene);
  const double width = above.block(1).area / (3.14159265358979323846 * above.block(1).radius), tenth = 0.1;
  StepSolution solution;
  const auto part = [&](double down, const EntryTolerance& tolerance, const std::vector<Contact>& held = {}) {
    solution.d = Motion::Unknowns(0.0, -0.05 - down, 0.0);
    return first_entry(above, solution, {{0, 1}}, tolerance, held);
  };
  const EntryTolerance by_width{.part_of_width = tenth};
  CHECK(part(3.9 * tenth * width, by_width) == 1.0);
  CHECK(part(4.1 * tenth * width, by_width) == Approx((0.05 + 0.5 * tenth * width) / (0.05 + 4.1 * tenth * width)).epsilon(1e-8));
  CHECK(part(3.9 * tenth * width, {.part_of_width = tenth, .most = 0.5 * tenth * width}) < 1.0);
  // Springs that have acted hold their corners.
  std::vector<Contact> held;
  for (int v = 4; v < 8; ++v) {
    for (int e = 0; e < 4; ++e) {
      Contact c;
      c.vertex_block = 1, c.vertex = v, c.edge_block = 0, c.edge = e;
      held.push_back(c);
    }
  }
  CHECK(part(4.1 * tenth * width, by_width, held) == 1.0);
}

TEST_CASE("rigid corners that meet within a step do not enter each other", "[analysis][corner_entry]") {
  for (const double dt : {0.02, 0.011, 0.005}) {
    INFO(dt);
    const Scene scene = passing_corners(dt);
    Simulation simulation(scene);
    prepare_start(simulation);
    double deepest = 0.0;
    while (simulation.time() < 0.1) {
      REQUIRE(simulation.advance(dt));
      const BlockSystem& system = simulation.system();
      Polygon base, square;
      for (int v = 0; v < 4; ++v) base.push_back(system.position(0, v));
      for (int v = 4; v < 8; ++v) square.push_back(system.position(1, v));
      deepest = std::max(deepest, overlap_depth(base, square));
    }
    CHECK(deepest <= 10.0 * scene.method.gap_tolerance);
    CHECK(simulation.velocity(1).norm() < 19.0);  // they have met
  }
}
