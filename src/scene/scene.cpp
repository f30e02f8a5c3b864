#include "openclose/scene/scene.h"

namespace openclose {

const JointProperties* Scene::joint(int material_a, int material_b) const {
  for (const JointProperties& candidate : joints) {
    const auto& [first, second] = candidate.materials;
    if ((first == material_a && second == material_b) || (first == material_b && second == material_a)) return &candidate;
  }
  return nullptr;
}

}  // namespace openclose
