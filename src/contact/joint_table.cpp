#include "openclose/contact/joint_table.h"

#include <fmt/format.h>

#include <cmath>

namespace openclose {

JointTable::JointTable(const Scene& scene)
    : material_count_(static_cast<int>(scene.materials.size())),
      index_(scene.materials.size() * scene.materials.size(), -1),
      joints_(scene.joints),
      unreduced_(scene.joints) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto [a, b] = joints_[j].materials;
    index_[a * material_count_ + b] = index_[b * material_count_ + a] = static_cast<int>(j);
  }
  std::vector<int> blocks_of(scene.materials.size(), 0), free_blocks_of(scene.materials.size(), 0);
  for (const BlockInput& block : scene.blocks) {
    ++blocks_of[block.material];
    if (!block.fixed) ++free_blocks_of[block.material];
  }
  for (int a = 0; a < material_count_; ++a) {
    for (int b = a; b < material_count_; ++b) {
      const bool can_touch = a == b ? free_blocks_of[a] > 0 && blocks_of[a] > 1
                                    : (free_blocks_of[a] > 0 && blocks_of[b] > 0) || (free_blocks_of[b] > 0 && blocks_of[a] > 0);
      if (can_touch && index(a, b) < 0) {
        throw InputError(scene.where, "joint", fmt::format("none for materials \"{}\" and \"{}\"", scene.materials[a].name, scene.materials[b].name),
                         "a [[joint]] for every pair of materials whose blocks can touch");
      }
    }
  }
}

void JointTable::reduce_strength(double factor) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    joints_[j].friction_angle = std::atan(std::tan(unreduced_[j].friction_angle) / factor);
    joints_[j].cohesion = unreduced_[j].cohesion / factor;
    joints_[j].tensile_strength = unreduced_[j].tensile_strength / factor;
  }
}

}  // namespace openclose
