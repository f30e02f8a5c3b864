#include "openclose/contact/joint_table.h"

#include <cmath>

#include "openclose/core/tolerance.h"
#include "openclose/scene/check.h"

namespace openclose {

JointTable::JointTable(const Scene& scene) : unreduced_(scene.joints) {
  require_joints(scene);
  for (const JointProperties& joint : scene.joints) joints_.emplace_back(joint);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (!joints_[j].has_materials()) continue;
    const auto& [a, b] = joints_[j].materials;
    of_materials_.push_back({std::minmax({a, b}), static_cast<int>(j)});
  }
  std::ranges::sort(of_materials_, {}, &OfMaterials::materials);
}

/// Whether neither edge at the corner faces the edge, to parallel_none.
bool JointTable::stands_alone(const BlockSystem& system, const Contact& contact) {
  static const double cosine_none = std::cos(tolerance::parallel_none_rad);
  const auto along = [&](int e) { return (system.arm(system.next(e)) - system.arm(e)).normalized(); };
  const Vec2 edge = along(contact.edge);
  const auto faces = [&](int e) { return -along(e).dot(edge) > cosine_none; };
  return !faces(contact.vertex) && !faces(system.previous(contact.vertex));
}

void JointTable::reduce_strength(double factor) {
  reduction_ = factor;
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j] = TabulatedJoint(unreduced_[j].reduced_by(factor));
}

void JointTable::exchange(Archive& archive) {
  archive(reduction_);
  if (!archive.reading()) return;
  if (reduction_) {
    reduce_strength(*reduction_);
  } else {
    for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j] = TabulatedJoint(unreduced_[j]);
  }
}

}  // namespace openclose
