#include <cmath>
#include <limits>
#include <random>

#include "openclose/geometry/polygon.h"
#include "openclose/model/block_system.h"
#include "support/catch.h"
#include "support/scenes.h"

using namespace openclose;
using test::degree;
using test::fixed_block;
using test::free_block;
using test::placed;
using test::rectangle;
using test::scene_with;

namespace {

using System = BlockSystem;
using Unknowns = System::Unknowns;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double density = 2500.0;  // [kg/m3] of test::empty_scene

/// Feet 2 m and 1 m wide: a rectangle 2 x 1 at the origin and one 1 x 2 on its left half.
const Polygon l_shape{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 3.0}, {0.0, 3.0}};

/// Of a single block, as the system places it, in its own coordinates.
Polygon outline(const System& system, int b) {
  Polygon polygon;
  const auto& block = system.block(b);
  for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) polygon.push_back(system.position(b, v));
  return polygon;
}

/// Of the arms alone, which the position's rounding does not touch.
double arm_area(const System& system, int b) {
  const auto& block = system.block(b);
  double area = 0.0;
  for (int v = block.first_vertex; v < block.first_vertex + block.vertex_count; ++v) area += 0.5 * cross(system.arm(v), system.arm(system.next(v)));
  return area;
}

}  // namespace

TEST_CASE("mass, centroid and moment of inertia of a rectangle", "[model][block_system]") {
  const double angle = GENERATE(0.0, 0.7, 2.5);
  const System system(scene_with({free_block("block", placed(rectangle(-1.0, -0.5, 2.0, 1.0), angle, {3.0, 4.0}))}));
  const auto& block = system.block(0);
  const double rounding = 50.0 * epsilon;
  CHECK(block.area == Approx(2.0).epsilon(rounding));
  CHECK(block.mass[0] == Approx(2.0 * density).epsilon(rounding));
  CHECK(block.mass[1] == block.mass[0]);
  CHECK(block.mass[2] == Approx(2.0 * density * 5.0 / 12.0).epsilon(rounding));
  CHECK((system.centroid(0) + system.origin() - Vec2(3.0, 4.0)).norm() <= rounding);
  CHECK(block.radius == Approx(std::sqrt(1.25)).epsilon(rounding));
}

TEST_CASE("mass, centroid and moment of inertia of an L from its two rectangles", "[model][block_system]") {
  const System system(scene_with({free_block("block", l_shape)}));
  // Both parts weigh 2 m2; their centroids (1, 0.5) and (0.5, 2) lie sqrt(2.5) m apart, with the common one half-way.
  const double parts = 2.0 * (4.0 + 1.0) / 12.0 + 2.0 * (1.0 + 4.0) / 12.0, steiner = 4.0 * 2.5 / 4.0;
  CHECK(system.block(0).area == Approx(4.0).epsilon(1e-14));
  CHECK((system.centroid(0) + system.origin() - Vec2(0.75, 1.25)).norm() <= 1e-14);
  CHECK(system.block(0).mass[2] == Approx(density * (parts + steiner)).epsilon(1e-14));
}

TEST_CASE("every material has its own density", "[model][block_system]") {
  Scene scene = scene_with({free_block("a", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("b", rectangle(2.0, 0.0, 1.0, 1.0))});
  scene.materials.push_back({"lead", 11300.0});
  scene.blocks[1].material = 1;
  const System system(scene);
  CHECK(system.block(0).mass[0] == 2500.0);
  CHECK(system.block(1).mass[0] == 11300.0);
  CHECK(system.block(1).material == 1);
}

TEST_CASE("fixed blocks have neither equation nor velocity", "[model][block_system]") {
  Scene scene = scene_with({fixed_block("base", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("a", rectangle(2.0, 0.0, 1.0, 1.0)),
                            fixed_block("wall", rectangle(4.0, 0.0, 1.0, 1.0)), free_block("b", rectangle(6.0, 0.0, 1.0, 1.0))});
  for (BlockInput& block : scene.blocks) {
    block.velocity = {1.0, 2.0};
    block.angular_velocity = 3.0;
  }
  const System system(scene);
  CHECK(system.block_count() == 4);
  CHECK(system.free_count() == 2);
  CHECK(system.free_blocks() == std::vector<int>{1, 3});
  CHECK(system.block(0).equation == -1);
  CHECK(system.block(1).equation == 0);
  CHECK(system.block(2).equation == -1);
  CHECK(system.block(3).equation == 1);
  CHECK(system.velocity(0).isZero(0.0));
  CHECK(system.velocity(3) == Unknowns(1.0, 2.0, 3.0));
  // 2500 kg and 2500/6 kg m2 each.
  CHECK(system.kinetic_energy() == Approx(2.0 * (0.5 * 2500.0 * 5.0 + 0.5 * 2500.0 / 6.0 * 9.0)).epsilon(1e-14));
}

TEST_CASE("the median size is that of all blocks that may move, also of those at rest", "[model][block_system]") {
  System system(scene_with({fixed_block("base", rectangle(0.0, -1.0, 20.0, 1.0)), free_block("a", rectangle(0.0, 0.0, 2.0, 2.0)),
                            free_block("b", rectangle(3.0, 0.0, 3.0, 3.0)), free_block("c", rectangle(7.0, 0.0, 5.0, 5.0))}));
  CHECK(system.median_size() == 3.0);
  system.put_to_rest({2, 3});
  CHECK(system.median_size() == 3.0);
  system.put_to_rest({1});
  CHECK(system.median_size() == 3.0);
}

TEST_CASE("velocities can be set and stopped", "[model][block_system]") {
  System system(scene_with({free_block("block", rectangle(0.0, 0.0, 1.0, 1.0))}));
  CHECK(system.kinetic_energy() == 0.0);
  system.set_velocity(0, {2.0, 0.0, 0.0});
  CHECK(system.kinetic_energy() == Approx(5000.0).epsilon(epsilon));
  system.stop();
  CHECK(system.velocity(0).isZero(0.0));
  CHECK(system.kinetic_energy() == 0.0);
}

TEST_CASE("vertices follow each other around their own block", "[model][block_system]") {
  const System system(scene_with({free_block("a", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("b", {{2.0, 0.0}, {3.0, 0.0}, {2.0, 1.0}})}));
  CHECK(system.block(1).first_vertex == 4);
  CHECK(system.block(1).vertex_count == 3);
  for (int v = 0; v < 7; ++v) {
    CHECK(system.previous(system.next(v)) == v);
    CHECK(system.next(system.previous(v)) == v);
  }
  CHECK(system.next(0) == 1);
  CHECK(system.next(3) == 0);
  CHECK(system.next(6) == 4);
  CHECK((system.position(1, 5) + system.origin() - Vec2(3.0, 0.0)).norm() <= 4.0 * epsilon);
}

TEST_CASE("only the inner corner of an L is reflex, whichever way it lies", "[model][block_system]") {
  const double angle = GENERATE(range(0, 360, 17)) * degree;
  const System system(scene_with({free_block("base", rectangle(-9.0, 0.0, 1.0, 1.0)), free_block("block", placed(l_shape, angle))}));
  for (int v = 0; v < 10; ++v) CHECK(system.is_reflex(v) == (v == 4 + 3));
}

TEST_CASE("a straight corner is not reflex", "[model][block_system]") {
  const System system(scene_with({free_block("block", {{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}})}));
  for (int v = 0; v < 5; ++v) CHECK_FALSE(system.is_reflex(v));
}

TEST_CASE("a block advances by its unknowns", "[model][block_system]") {
  System system(scene_with({free_block("block", rectangle(0.0, 0.0, 2.0, 2.0)), free_block("other", rectangle(5.0, 0.0, 2.0, 2.0))}));
  const Polygon other = outline(system, 1);
  system.advance(0, {10.0, 0.0, 90.0 * degree});
  // The lower left corner has gone to the lower right.
  CHECK((system.position(0, 0) + system.origin() - Vec2(12.0, 0.0)).norm() <= 20.0 * epsilon);
  CHECK(system.displacement(0) == Unknowns(10.0, 0.0, 90.0 * degree));
  CHECK(outline(system, 1) == other);
  CHECK(system.displacement(1).isZero(0.0));
}

TEST_CASE("exact rotation does not deform a block however often it turns", "[model][block_system]") {
  System system(scene_with({free_block("block", placed(l_shape, 0.3, {5.0, -2.0}))}));
  const double area = arm_area(system, 0);
  std::vector<double> arms;
  for (int v = 0; v < 6; ++v) arms.push_back(system.arm(v).norm());
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> turn(-0.5, 1.0);
  double worst = 0.0;
  for (int step = 0; step < 20000; ++step) {
    system.advance(0, {1e-3, 0.0, turn(generator)});
    worst = std::max(worst, std::abs(arm_area(system, 0) / area - 1.0));
    for (int v = 0; v < 6; ++v) worst = std::max(worst, std::abs(system.arm(v).norm() / arms[v] - 1.0));
  }
  // Independent of the number of steps.
  CHECK(worst < 20.0 * epsilon);
  const double total = system.displacement(0)[2];
  CHECK(total > 1000.0);
  const Vec2 reference = placed({l_shape[4] - Vec2(0.75, 1.25)}, 0.3 + total).front();
  // Turned about once per radian: the rounding of an angle of some 5000 rad.
  CHECK((system.arm(4) - reference).norm() <= 4.0 * epsilon * total * reference.norm());
}

TEST_CASE("linear rotation by r grows the area by 1 + r^2 each time", "[model][block_system]") {
  Scene scene = scene_with({free_block("block", l_shape)});
  scene.method.rotation = RotationKind::linear;
  System system(scene);
  const int steps = 1000;
  const double r = GENERATE(1e-3, 0.02);
  for (int step = 0; step < steps; ++step) system.advance(0, {0.0, 0.0, r});
  CHECK(arm_area(system, 0) / 4.0 == Approx(std::pow(1.0 + r * r, steps)).epsilon(10.0 * steps * epsilon));
  CHECK(system.displacement(0)[2] == Approx(steps * r).epsilon(steps * epsilon));
}

TEST_CASE("a followed point moves with its block", "[model][block_system]") {
  Scene scene = scene_with({free_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("block", l_shape)});
  scene.method.rotation = GENERATE(RotationKind::exact, RotationKind::linear);
  System system(scene);
  const int corner = system.follow_point(1, l_shape[4]), inside = system.follow_point(1, {0.5, 0.5}), other = system.follow_point(0, {1.0, -0.5});
  CHECK(system.point_block(inside) == 1);
  CHECK(system.point_block(other) == 0);
  CHECK((system.point_position(inside) + system.origin() - Vec2(0.5, 0.5)).norm() <= 20.0 * epsilon);
  for (int step = 0; step < 50; ++step) system.advance(1, {0.1, -0.02, 0.05});
  CHECK((system.point_position(corner) - system.position(1, 4 + 4)).norm() <= 100.0 * epsilon);
  CHECK((system.point_position(other) + system.origin() - Vec2(1.0, -0.5)).norm() <= 20.0 * epsilon);
  // The middle of the foot's diagonal stays the middle.
  CHECK((system.point_position(inside) - 0.5 * (system.position(1, 4 + 0) + system.position(1, 4 + 3))).norm() <= 100.0 * epsilon);
}

TEST_CASE("a point followed after the block has turned is the same material point", "[model][block_system]") {
  System system(scene_with({free_block("block", l_shape)}));
  const int early = system.follow_point(0, {1.5, 0.2});
  system.advance(0, {1.0, 2.0, 0.4});
  system.advance(0, {1.0, 2.0, 0.4});
  const int late = system.follow_point(0, {1.5, 0.2});
  CHECK((system.point_position(late) - system.point_position(early)).norm() <= 8.0 * epsilon);
}

TEST_CASE("a restored state is the saved one to the last bit", "[model][block_system]") {
  Scene scene = scene_with({free_block("block", l_shape), free_block("other", rectangle(5.0, 0.0, 2.0, 2.0))});
  scene.method.rotation = GENERATE(RotationKind::exact, RotationKind::linear);
  System system(scene);
  const int point = system.follow_point(0, {0.3, 0.4});
  const auto step = [&] {
    system.advance(0, {0.1, 0.2, 0.3});
    system.advance(1, {-0.1, 0.0, 0.01});
    system.set_velocity(0, system.velocity(0) + Unknowns(1.0, 0.0, 0.5));
  };
  step();
  const System::State saved = system.state();
  const Polygon first = outline(system, 0), second = outline(system, 1);
  const Vec2 followed = system.point_position(point);
  step();
  const Polygon ahead = outline(system, 0);
  CHECK(ahead != first);
  system.restore(saved);
  CHECK(outline(system, 0) == first);
  CHECK(outline(system, 1) == second);
  CHECK(system.point_position(point) == followed);
  CHECK(system.velocity(0) == Unknowns(1.0, 0.0, 0.5));
  CHECK(system.displacement(0) == Unknowns(0.1, 0.2, 0.3));
  step();
  CHECK(outline(system, 0) == ahead);
}

TEST_CASE("a model 1e6 m away moves like one at the origin", "[model][block_system]") {
  // Coordinates that are exact there, too: only the centroid, which is no sum of a few bits, is rounded at 1e6 m.
  const Vec2 far(1048576.0, -1048576.0);
  Polygon there;
  for (const Vec2& v : l_shape) there.push_back(v + far);
  System near(scene_with({free_block("block", l_shape)})), away(scene_with({free_block("block", there)}));
  const double coordinate_rounding = far.norm() * epsilon;
  const int a = near.follow_point(0, {0.5, 0.5}), b = away.follow_point(0, Vec2(0.5, 0.5) + far);
  CHECK(away.origin() == near.origin() + far);
  CHECK(away.block(0).area == near.block(0).area);
  CHECK(away.block(0).mass[2] == Approx(near.block(0).mass[2]).epsilon(1e-14));
  CHECK((away.centroid(0) - near.centroid(0)).norm() <= coordinate_rounding);
  for (int step = 0; step < 1000; ++step) {
    near.advance(0, {1e-3, 2e-3, 0.01});
    away.advance(0, {1e-3, 2e-3, 0.01});
  }
  // Nothing is lost by the motion itself: the arms turn by about 10 rad, so their difference only turns.
  for (int v = 0; v < 6; ++v) CHECK((away.arm(v) - near.arm(v)).norm() <= coordinate_rounding);
  CHECK(away.displacement(0) == near.displacement(0));
  CHECK((away.point_position(b) - near.point_position(a)).norm() <= 3.0 * coordinate_rounding);
}

TEST_CASE("flags of the scene reach the system", "[model][block_system]") {
  Scene scene = scene_with({free_block("a", rectangle(0.0, 0.0, 1.0, 1.0)), free_block("b", rectangle(2.0, 0.0, 1.0, 1.0))});
  scene.blocks[1].rotation_locked = true;
  scene.method.rotation = GENERATE(RotationKind::exact, RotationKind::linear);
  const System system(scene);
  CHECK_FALSE(system.block(0).rotation_locked);
  CHECK(system.block(1).rotation_locked);
  CHECK(system.rotation_kind() == scene.method.rotation);
}

TEST_CASE("reduced mass of two blocks, a fixed one counting as infinitely heavy", "[model]") {
  const Scene scene = test::column_of_blocks(2);
  const BlockSystem system(scene);
  CHECK(system.reduced_mass(1, 2) == Approx(0.5 * test::block_mass).epsilon(1e-14));
  CHECK(system.reduced_mass(0, 2) == Approx(test::block_mass).epsilon(1e-14));
  CHECK(system.reduced_mass(2, 0) == Approx(test::block_mass).epsilon(1e-14));
}
