// Joint properties by material pair, ready for look-up by two integers.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "openclose/core/archive.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// A joint with what is derived from it once, not in every contact and step.
struct TabulatedJoint : JointProperties {
  explicit TabulatedJoint(const JointProperties& joint)
      : JointProperties(joint),
        friction(std::tan(joint.friction_angle)),
        residual_friction(joint.softens() ? std::tan(*joint.residual_friction_angle) : friction) {}

  double friction;           ///< [-] tan(friction angle)
  double residual_friction;  ///< [-] of contacts that are not bonded
};

class JointTable {
 public:
  /// Throws InputError as require_joints does.
  explicit JointTable(const Scene& scene);

  int index(int material_a, int material_b) const { return index_[material_a * material_count_ + material_b]; }
  int count() const { return static_cast<int>(joints_.size()); }
  const TabulatedJoint& joint(int i) const { return joints_[i]; }

  /// Divides tan(friction angle), cohesion and tensile strength of every joint, as the scene gave them, by the strength reduction factor.
  void reduce_strength(double factor);
  const std::optional<double>& reduction() const { return reduction_; }  ///< [-] the last one's, from which the strengths follow
  void exchange(Archive& archive);

 private:
  int material_count_ = 0;
  std::vector<int> index_;
  std::vector<TabulatedJoint> joints_;
  std::vector<JointProperties> unreduced_;
  std::optional<double> reduction_;  ///< by reduce_strength(), if it was called
};

}  // namespace openclose
