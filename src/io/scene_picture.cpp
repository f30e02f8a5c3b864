#include <fmt/format.h>

#include <map>

#include "openclose/geometry/polygon.h"
#include "openclose/io/drawing.h"
#include "openclose/scene/scene.h"

namespace openclose {
namespace {

/// Those joints that edges name, in the order of the scene.
void add_seams(const Scene& scene, Picture& picture) {
  std::map<int, int> number_of;
  for (const BlockInput& block : scene.blocks) {
    for (const int joint : block.edge_joints) {
      if (joint != BlockInput::by_materials) number_of.emplace(joint, 0);
    }
  }
  for (auto& [joint, number] : number_of) {
    number = static_cast<int>(picture.seam_names.size());
    picture.seam_names.push_back(scene.joints[joint].name);
  }
  for (const BlockInput& block : scene.blocks) {
    for (std::size_t i = 0; i < block.edge_joints.size(); ++i) {
      const auto number = number_of.find(block.edge_joints[i]);
      if (number == number_of.end()) continue;
      picture.seams.push_back({block.vertices[i], block.vertices[(i + 1) % block.vertices.size()], number->second});
    }
  }
}

}  // namespace

Picture picture_of(const Scene& scene) {
  Picture picture;
  picture.title = fmt::format("{} ({} blocks)", scene.title.empty() ? "Blocks" : scene.title, scene.blocks.size());
  for (const Material& material : scene.materials) picture.colour_names.push_back(material.name);
  for (const BlockInput& block : scene.blocks) picture.blocks.push_back({block.name, block.vertices, block.material, block.fixed, 0.0});
  add_seams(scene, picture);
  for (const Support& s : scene.supports) {
    const Vec2 middle = polygon_properties(scene.blocks[s.block].vertices).centroid;
    picture.supports.push_back({s.point, s.stiffness.x() > 0.0, s.stiffness.y() > 0.0, s.point - middle});
  }
  for_each_force(scene, [&](const auto& force) {
    for (const DrawnForce& arrow : force.drawn()) picture.loads.push_back({arrow.point, arrow.force});
  });
  for (const MeasuredPoint& point : scene.measured_points) picture.points.push_back({point.name, point.point});
  return picture;
}

}  // namespace openclose
