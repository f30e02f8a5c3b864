// F8: joints with tensile strength that are bent crack from their edge: an overhang and a column that is pushed, as beams.
#include <cmath>
#include <utility>
#include <vector>

#include "harness.h"
#include "scenes.h"

namespace openclose::verification {
namespace {

constexpr double width = 1e-4;  // [-] of factor and multiplier
constexpr const char* bracket = "; width of the bracket";

/// The joint bears any shear: what fails, bends.
Scene bonded(const analytical::BlockOnPlane& data, const std::string& method, double tension) {
  Scene scene = empty_scene(data);
  scene.method.contact = method;
  scene.strength_reduction.width = width;
  scene.joints[0].tensile_strength = tension;
  scene.joints[0].cohesion = 1e3 * tension;
  return scene;
}

/// A block of `data` that a wall of some blocks holds at its left side. If they are of one rock the joint is one. With n rocks it has n pieces, each
/// of which is held at two ends: the springs at x = +-L/2, +-(L/2 - L/n), ... with lengths of L/(2n), each twice but the outermost, bear k theta
/// L^3/12 (1 + 2/n^2), and the stress at the edge follows from the outermost piece, k theta L/2 (1 + 2/n).
void overhang(Report& report, const std::string& method, int pieces, bool of_one_rock) {
  analytical::BlockOnPlane data;
  data.width = 2.0;
  data.height = 1.0;
  const double moment = data.weight() * 0.5 * data.width, section = data.height * data.height / 6.0, n = pieces;
  const double tension = 1.6 * moment / section;
  Scene scene = bonded(data, method, tension);
  for (int i = 0; i < pieces; ++i) {
    scene.blocks.push_back(fixed_block("wall " + std::to_string(i), rectangle(-1.0, data.height * i / n, 1.0, data.height / n)));
    if (of_one_rock || i == 0) continue;
    scene.blocks.back().material = static_cast<int>(scene.materials.size());
    scene.materials.push_back(scene.materials[0]);
    scene.materials.back().name = "rock " + std::to_string(i);
    scene.joints.push_back(scene.joints[0]);
    scene.joints.back().materials = {0, scene.blocks.back().material};
  }
  scene.blocks.push_back(free_block("beam", rectangle(0.0, 0.0, data.width, data.height)));
  const double part = of_one_rock ? 1.0 : (1.0 + 2.0 / (n * n)) / (1.0 + 2.0 / n);
  report.relative(text(of_one_rock ? "overhang, blocks of the wall: {:g}" : "overhang, pieces of its joint: {:g}", n), method,
                  part * tension * section / moment, strength_reduction_factor(report, scene), width, "-",
                  std::string(of_one_rock ? "sigma L^2/(6 M)" : "sigma L^2/(6 M) (1 + 2/n^2)/(1 + 2/n)") + bracket);
}

/// A drawing has corners in faces, out of the straight line or in it by its rounding: the joint stays one.
void drawn_overhang(Report& report, const std::string& method, double off) {
  analytical::BlockOnPlane data;
  data.width = 2.0;
  data.height = 1.0;
  const double moment = data.weight() * 0.5 * data.width, section = data.height * data.height / 6.0, tension = 1.6 * moment / section;
  Scene scene = bonded(data, method, tension);
  scene.blocks = {fixed_block("wall", rectangle(-1.0, -1.0, 1.0, 3.0)), free_block("beam", rectangle(0.0, 0.0, data.width, data.height))};
  // Down the left side of the beam, and up the right one of the wall.
  for (const auto& [side, at] : {std::pair{off, 0.8}, {-off, 0.5}, {off, 0.3}}) scene.blocks[1].vertices.push_back({side, at * data.height});
  std::vector<Vec2>& wall = scene.blocks[0].vertices;
  wall.insert(wall.begin() + 2, {Vec2(off, -0.3), Vec2(-off, 0.4 * data.height), Vec2(off, 0.6 * data.height)});
  report.relative(text("overhang with corners {:+g} m off its face", off), method, 1.6, strength_reduction_factor(report, scene),
                  width + 2.0 * std::abs(off) / data.height, "-", "sigma L^2/(6 M); width of the bracket, and arms of the moment");
}

/// 6 M/b^2 - W/b at the foot.
void column(Report& report, const std::string& method) {
  analytical::BlockOnPlane data;
  data.width = 0.5;
  data.height = 2.0;
  data.slope_angle = 0.0;
  const double push = 1e3, arm = 1.5, tension = 4.0 * data.weight() / data.width;
  Scene scene = bonded(data, method, tension);
  scene.blocks = {fixed_block("base", rectangle(-5.0, -1.0, 10.0, 1.0)), free_block("column", rectangle(0.0, 0.0, data.width, data.height))};
  scene.loads = {{1, {data.width, arm}, {-push, 0.0}, "push"}};
  report.relative("column cracks at its foot at a push, in kN", method,
                  (tension + data.weight() / data.width) * data.width * data.width / (6.0 * arm) / push, load_multiplier(report, scene, "push"),
                  width, "kN", std::string("(sigma + W/b) b^2/(6 y)") + bracket);
}

void bending(Report& report) {
  for (const std::string& method : all_methods) {
    for (const int pieces : {1, 2, 4}) overhang(report, method, pieces, false);
    for (const int blocks : {2, 4}) overhang(report, method, blocks, true);
    for (const double off : {5e-4, -5e-4, 1e-6}) drawn_overhang(report, method, off);
    column(report, method);
  }
}

const Registered<Case> registered{{"F8", "joints with tensile strength that are bent", &bending}};

}  // namespace
}  // namespace openclose::verification
