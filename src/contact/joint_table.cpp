#include "openclose/contact/joint_table.h"

#include <cmath>

#include "openclose/scene/check.h"

namespace openclose {

JointTable::JointTable(const Scene& scene)
    : material_count_(static_cast<int>(scene.materials.size())),
      index_(scene.materials.size() * scene.materials.size(), -1),
      unreduced_(scene.joints) {
  require_joints(scene);
  for (const JointProperties& joint : scene.joints) joints_.push_back({joint, std::tan(joint.friction_angle)});
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto [a, b] = joints_[j].materials;
    index_[a * material_count_ + b] = index_[b * material_count_ + a] = static_cast<int>(j);
  }
}

void JointTable::reduce_strength(double factor) {
  reduction_ = factor;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    joints_[j].friction_angle = std::atan(std::tan(unreduced_[j].friction_angle) / factor);
    joints_[j].friction = std::tan(joints_[j].friction_angle);
    joints_[j].cohesion = unreduced_[j].cohesion / factor;
    joints_[j].tensile_strength = unreduced_[j].tensile_strength / factor;
  }
}

void JointTable::exchange(Archive& archive) {
  archive(reduction_);
  if (archive.reading() && reduction_) reduce_strength(*reduction_);
}

}  // namespace openclose
