#include "openclose/scene/scene.h"

#include "openclose/core/memory.h"

namespace openclose {

const JointProperties* Scene::joint(int material_a, int material_b) const {
  for (const JointProperties& candidate : joints) {
    const auto& [first, second] = candidate.materials;
    if ((first == material_a && second == material_b) || (first == material_b && second == material_a)) return &candidate;
  }
  return nullptr;
}

std::size_t bytes_of_blocks(const Scene& scene) {
  // Short texts are in the string itself, longer ones beside it; counted as if all were.
  std::size_t bytes = bytes_of(scene.blocks);
  for (const BlockInput& block : scene.blocks) bytes += bytes_of(block.vertices, block.name, block.edge_joints);
  return bytes;
}

}  // namespace openclose
