#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "openclose/geometry/polygon.h"
#include "openclose/io/drawing.h"
#include "openclose/scene/angle.h"
#include "openclose/scene/scene.h"

namespace openclose {
namespace {

/// [rad] Less is the rounding of a sine that was typed.
constexpr double slightest_turn = 1e-9;

void add_seams(const Scene& scene, Picture& picture) {
  const std::vector<int> joints = joints_of_edges(scene);
  for (const int joint : joints) picture.seam_names.push_back(scene.joints[joint].name);
  // Blocks share their edges: each is drawn once, or dashes would fill each other's gaps.
  const auto less = [](const Vec2& a, const Vec2& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); };
  std::set<std::array<double, 4>> drawn;
  for (const BlockInput& block : scene.blocks) {
    for (std::size_t i = 0; i < block.edge_joints.size(); ++i) {
      if (block.edge_joints[i] == BlockInput::by_materials) continue;
      const auto number = static_cast<int>(std::ranges::lower_bound(joints, block.edge_joints[i]) - joints.begin());
      const auto [from, to] = std::minmax(block.vertices[i], block.vertices[(i + 1) % block.vertices.size()], less);
      if (drawn.insert({from.x(), from.y(), to.x(), to.y()}).second) picture.seams.push_back({from, to, number});
    }
  }
}

}  // namespace

std::vector<int> joints_of_edges(const Scene& scene) {
  std::set<int> joints;
  for (const BlockInput& block : scene.blocks) joints.insert(block.edge_joints.begin(), block.edge_joints.end());
  joints.erase(BlockInput::by_materials);
  return {joints.begin(), joints.end()};
}

std::string gravity_in_words(const Vec2& gravity) {
  if (gravity.isZero(0.0)) return "there is no gravity";
  if (std::abs(gravity.x()) <= slightest_turn * gravity.norm() && gravity.y() <= 0.0) return "";
  const double turn = degrees(std::atan2(gravity.x(), -gravity.y()));
  return fmt::format("gravity is turned by {:.4g} degrees to the {}", std::abs(turn), turn > 0.0 ? "right" : "left");
}

Picture picture_of(const Scene& scene) {
  Picture picture;
  if (std::string words = gravity_in_words(scene.gravity); !words.empty()) picture.notes.push_back(std::move(words));
  picture.title = fmt::format("{} ({} blocks)", scene.title.empty() ? "Blocks" : scene.title, scene.blocks.size());
  for (const Material& material : scene.materials) picture.colour_names.push_back(material.name);
  for (const BlockInput& block : scene.blocks) picture.blocks.push_back({block.name, block.vertices, block.material, block.fixed, 0.0});
  add_seams(scene, picture);
  for (const Support& s : scene.supports) {
    const Vec2 middle = polygon_properties(scene.blocks[s.block].vertices).centroid;
    picture.supports.push_back({s.point, s.stiffness.x() > 0.0, s.stiffness.y() > 0.0, s.point - middle});
  }
  for_each_force(scene, [&](const auto& force) {
    for (const DrawnForce& arrow : force.drawn()) picture.loads.push_back({arrow.point, arrow.force, arrow.spread});
  });
  for (const MeasuredPoint& point : scene.measured_points) picture.points.push_back({point.name, point.point});
  return picture;
}

}  // namespace openclose
