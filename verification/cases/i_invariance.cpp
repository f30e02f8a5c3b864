// I1 to I9: what must not matter. The same scene - three blocks that tumble onto a base, slide, stick and strike each other - is run as it is and in
// another guise, and the results are carried back.
//
// Tolerances: a perturbation of relative size e at the start grows with every impact and every contact that takes over; that growth G is measured in
// the case itself by moving one block by `nudge`, and what rounding of coordinates of size L does to a run is bounded by G times eps L times the
// number of roundings that may add up, `roundings` (a dozen a step in 300 steps that go the same way). Where scaling is by powers of two, and where
// nothing that is computed changes, the bits agree.
#include <algorithm>
#include <cmath>
#include <limits>

#include "harness.h"
#include "openclose/core/parallel.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double dt = 1e-3, end = 0.3;  // [s]
constexpr double nudge = 1e-10;         // [m]
constexpr double roundings = 12.0 * end / dt;
constexpr double eps = std::numeric_limits<double>::epsilon();

Scene tumbling(const std::string& method) {
  Scene scene = empty_scene();
  scene.joints[0].normal_stiffness = 1e8;
  scene.joints[0].shear_stiffness = 5e7;
  scene.blocks = {fixed_block("base", rectangle(-10.0, -1.0, 20.0, 1.0)), free_block("left", {{-0.7, 0.3}, {0.4, 0.5}, {0.2, 1.4}, {-0.6, 1.3}}),
                  free_block("right", {{1.0, 0.4}, {1.8, 0.6}, {1.7, 1.6}, {0.9, 1.3}}), free_block("top", {{0.2, 1.8}, {1.3, 2.0}, {0.7, 2.8}})};
  scene.blocks[1].velocity = {1.5, -1.0};
  scene.blocks[1].angular_velocity = -2.0;
  scene.blocks[2].velocity = {-1.0, -1.0};
  scene.blocks[3].velocity = {0.0, -4.0};
  scene.method.contact = method;
  use_joint_springs_as_penalty(scene);
  scene.step = {dt, 1.0, 1e-6};
  scene.end_time = end;
  return scene;
}

/// Displacements of the blocks, in the order of the scene; empty if a step fails.
std::vector<Eigen::Vector3d> motion(const Report& report, const Scene& scene) {
  Simulation simulation = report.simulate(scene);
  for (int i = 0; i < std::lround(end / dt); ++i) {
    if (!simulation.advance(scene.step.dt)) return {};
  }
  std::vector<Eigen::Vector3d> moved;
  for (int b = 0; b < simulation.system().block_count(); ++b) moved.push_back(simulation.system().displacement(b));
  // Nothing has been shown by blocks that have not moved.
  if (moved[1].norm() < 1e-3) return {};
  return moved;
}

/// Largest difference of the three blocks [m, rad]; NaN if one of the runs failed.
template <class F>
double difference(const std::vector<Eigen::Vector3d>& plain, const std::vector<Eigen::Vector3d>& other, F carried_back) {
  if (plain.empty() || other.empty()) return not_measured();
  double worst = 0.0;
  for (int b = 1; b <= 3; ++b) worst = larger(worst, (carried_back(other[b]) - plain[b]).cwiseAbs().maxCoeff());
  return worst;
}

template <class F>
void move_vertices(Scene& scene, F f) {
  for (BlockInput& block : scene.blocks) {
    for (Vec2& v : block.vertices) v = f(v);
  }
}

void invariance_of(Report& report, const std::string& method) {
  const Scene scene = tumbling(method);
  const auto plain = motion(report, scene);
  const auto same = [](const Eigen::Vector3d& d) { return d; };

  Scene nudged = scene;
  for (Vec2& v : nudged.blocks[3].vertices) v.x() += nudge;
  const double growth = difference(plain, motion(report, nudged), same) / nudge;
  const std::string why = text("growth of a perturbation {:.3g}, measured", growth) + ", times eps times coordinates times roundings";
  const auto rounding = [&](double coordinates) { return std::max(growth, 1.0) * eps * coordinates * roundings; };

  // Lengths and times stay, because thresholds have them for units.
  Scene units = scene;
  units.materials[0].density *= 4.0;
  units.joints[0].normal_stiffness *= 4.0;
  units.joints[0].shear_stiffness *= 4.0;
  units.method.penalty = *units.method.penalty * 4.0;
  report.near("I1 another unit of mass (4): bit for bit", method, 0.0, difference(plain, motion(report, units), same), 0.0, "m, rad",
              "a power of two times every force and mass changes no digit");

  Scene mirrored = scene;
  move_vertices(mirrored, [](const Vec2& v) { return Vec2(-v.x(), v.y()); });
  for (BlockInput& b : mirrored.blocks) {
    std::reverse(b.vertices.begin(), b.vertices.end());
    b.velocity.x() *= -1.0;
    b.angular_velocity *= -1.0;
  }
  report.near("I2 mirrored", method, 0.0,
              difference(plain, motion(report, mirrored), [](const Eigen::Vector3d& d) { return Eigen::Vector3d(-d[0], d[1], -d[2]); }),
              rounding(10.0), "m, rad", why);

  const double angle = 0.7391;
  Scene rotated = scene;
  move_vertices(rotated, [&](const Vec2& v) { return turned(v, angle); });
  rotated.gravity = turned(rotated.gravity, angle);
  for (BlockInput& b : rotated.blocks) b.velocity = turned(b.velocity, angle);
  report.near("I3 turned by 0.7391 rad, gravity too", method, 0.0,
              difference(plain, motion(report, rotated),
                         [&](const Eigen::Vector3d& d) {
                           const Vec2 u = turned(d.head<2>(), -angle);
                           return Eigen::Vector3d(u.x(), u.y(), d[2]);
                         }),
              rounding(10.0), "m, rad", why);

  constexpr double far = 1e6;
  Scene moved = scene;
  move_vertices(moved, [](const Vec2& v) { return Vec2(v.x() + far, v.y() - far); });
  // The vertices are rounded once, when they are written there; the motion is computed relative to the first of them.
  report.near("I4 moved by 1e6 m", method, 0.0, difference(plain, motion(report, moved), same),
              std::max(growth, 1.0) * eps * far * 12.0 + rounding(10.0), "m, rad", why + "; the 12 free vertices are rounded once at 1e6 m");

  Scene renumbered = scene;
  std::swap(renumbered.blocks[1], renumbered.blocks[3]);
  auto other = motion(report, renumbered);
  if (!other.empty()) std::swap(other[1], other[3]);
  report.near("I6 blocks renumbered", method, 0.0, difference(plain, other, same), rounding(10.0), "m, rad", why);

  Scene with_stranger = scene;
  with_stranger.blocks.push_back(free_block("stranger", rectangle(500.0, 500.0, 1.0, 1.0)));
  // Its weight would be the largest force, a part of which is what residuals of all blocks may keep.
  with_stranger.blocks.back().velocity = {3.0, 0.0};
  const char* nothing_connects =
      "bit for bit: a block without contacts has no part in the equations of the others; it has neither the largest force nor the longest way, "
      "which count for all";
  report.near("I7 a far block that touches nothing", method, 0.0, difference(plain, motion(report, with_stranger), same), 0.0, "m, rad",
              nothing_connects);
  if (method == "soft") {
    for (const char* integrator : {"tr_bdf2", "path_average", "generalized_alpha"}) {
      Scene alone = scene, not_alone = with_stranger;
      alone.method.integrator = not_alone.method.integrator = integrator;
      report.near(std::string("I7 a far block that touches nothing, ") + integrator, method, 0.0,
                  difference(motion(report, alone), motion(report, not_alone), same), 0.0, "m, rad", nothing_connects);
    }
  }

  // Stopped in the middle of the first impacts, and continued by another simulation.
  Simulation whole = report.simulate(scene), first = report.simulate(scene);
  bool going = true;
  for (int i = 0; i < 100; ++i) going = going && whole.advance(dt) && first.advance(dt);
  Archive saved;
  saved(first);
  Simulation second = report.simulate(scene);
  Archive archive(saved.bytes());
  archive(second);
  for (int i = 0; i < 100; ++i) going = going && whole.advance(dt) && second.advance(dt);
  const Eigen::Vector3d a = std::as_const(whole).system().displacement(1), b = std::as_const(second).system().displacement(1);
  report.near("I8 stopped and restarted: bit for bit", method, 0.0, going && a.norm() > 1e-3 ? (a - b).cwiseAbs().maxCoeff() : not_measured(), 0.0,
              "m, rad", "the state is saved whole");
}

/// Large enough for all that is shared among threads: a wall of bricks 2 m x 1 m, every other course shifted, its top course moving.
Scene large_wall(const std::string& method) {
  constexpr int courses = 25, bricks = 42;
  Scene scene = tumbling(method);
  scene.blocks = wall_with_moving_top(courses, bricks, 0.5);
  scene.method.linear_solver = LinearSolverKind::iterative;
  return scene;
}

/// Displacements of all blocks after some steps; empty if one fails, or if several threads were asked for and had nothing to do.
std::vector<double> moved_with(const Report& report, Scene scene, int threads) {
  constexpr int steps = 5;
  scene.method.threads = threads;
  const long before = times_shared(SharedWork::product);
  Simulation simulation = report.simulate(scene);
  for (int i = 0; i < steps; ++i) {
    if (!simulation.advance(scene.step.dt)) return {};
  }
  if (threads > 1 && times_shared(SharedWork::product) == before) return {};
  std::vector<double> moved;
  for (int b = 0; b < simulation.system().block_count(); ++b) {
    for (int k = 0; k < 3; ++k) moved.push_back(simulation.system().displacement(b)[k]);
  }
  return moved;
}

void threads_of(Report& report, const std::string& method) {
  const char* name = "I9 one thread and two: bit for bit";
  if (method == "dem") {
    report.leave_out(name, method, "its loop is not shared among threads");
    return;
  }
  const Scene scene = large_wall(method);
  const std::vector<double> one = moved_with(report, scene, 1), two = moved_with(report, scene, 2);
  double worst = one.empty() || two.empty() || std::abs(one[one.size() - 3]) < 1e-3 ? not_measured() : 0.0;
  for (std::size_t i = 0; i < one.size() && i < two.size(); ++i) worst = larger(worst, std::abs(one[i] - two[i]));
  report.near(name, method, 0.0, worst, 0.0, "m, rad", "each number is computed by the same operations in the same order");
}

/// I5, Galilei: everything that moves freely, without gravity and base, seen from a frame that moves along; contact is then between free blocks only.
void moving_frame(Report& report, const std::string& method) {
  Scene scene = tumbling(method);
  scene.gravity = Vec2::Zero();
  scene.blocks[0] = fixed_block("base", rectangle(-10.0, -101.0, 20.0, 1.0));
  const auto plain = motion(report, scene);
  Scene nudged = scene;
  for (Vec2& v : nudged.blocks[3].vertices) v.x() += nudge;
  const auto same = [](const Eigen::Vector3d& d) { return d; };
  const double growth = difference(plain, motion(report, nudged), same) / nudge;
  const Vec2 speed(3.0, 2.0);
  Scene moving = scene;
  for (int b = 1; b <= 3; ++b) moving.blocks[b].velocity += speed;
  const auto back = [&](const Eigen::Vector3d& d) { return Eigen::Vector3d(d[0] - end * speed.x(), d[1] - end * speed.y(), d[2]); };
  report.near("I5 in a frame that moves at 3.6 m/s", method, 0.0, difference(plain, motion(report, moving), back),
              std::max(growth, 1.0) * eps * 10.0 * roundings, "m, rad",
              text("growth {:.3g}, measured, times eps times coordinates times roundings", growth));
}

void invariance(Report& report) {
  for (const std::string& method : all_methods) {
    invariance_of(report, method);
    moving_frame(report, method);
    threads_of(report, method);
  }
}

const Registered<Case> registered{
    {"I", "invariance: units, mirror, turn, place, frame, order, strangers, restart", &invariance, Reference::invariance}};

}  // namespace
}  // namespace openclose::verification
