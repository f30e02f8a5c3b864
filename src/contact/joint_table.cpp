#include "openclose/contact/joint_table.h"

#include "openclose/scene/check.h"

namespace openclose {

JointTable::JointTable(const Scene& scene)
    : material_count_(static_cast<int>(scene.materials.size())),
      index_(scene.materials.size() * scene.materials.size(), -1),
      unreduced_(scene.joints) {
  require_joints(scene);
  for (const JointProperties& joint : scene.joints) joints_.emplace_back(joint);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (!joints_[j].has_materials()) continue;
    const auto [a, b] = joints_[j].materials;
    index_[a * material_count_ + b] = index_[b * material_count_ + a] = static_cast<int>(j);
  }
}

void JointTable::reduce_strength(double factor) {
  reduction_ = factor;
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j] = TabulatedJoint(unreduced_[j].reduced_by(factor));
}

void JointTable::exchange(Archive& archive) {
  archive(reduction_);
  if (archive.reading() && reduction_) reduce_strength(*reduction_);
}

}  // namespace openclose
