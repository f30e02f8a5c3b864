// Joint properties by material pair and by the seams that name them, ready for look-up by integers.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/core/archive.h"
#include "openclose/model/block_system.h"
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

  /// -1 if there is none, which is so only of materials whose blocks cannot touch.
  int index(int material_a, int material_b) const {
    const std::pair<int, int> materials = std::minmax({material_a, material_b});
    const auto place = std::ranges::lower_bound(of_materials_, materials, {}, &OfMaterials::materials);
    return place != of_materials_.end() && place->materials == materials ? place->joint : -1;
  }
  /// Of a contact: what the scene names for the edge, if one of the two edges at the corner has the same name, for then both lie in one seam, or in
  /// two that are alike, or if neither of them runs along the edge, for then the corner has no face of its own there; else that of the materials.
  int index(const BlockSystem& system, const Contact& contact) const {
    const int seam = system.edge_joint(contact.edge);
    const bool is_in_seam =
        seam != BlockInput::by_materials &&
        (system.edge_joint(contact.vertex) == seam || system.edge_joint(system.previous(contact.vertex)) == seam || stands_alone(system, contact));
    return is_in_seam ? seam : index(system.block(contact.vertex_block).material, system.block(contact.edge_block).material);
  }
  int count() const { return static_cast<int>(joints_.size()); }
  const TabulatedJoint& joint(int i) const { return joints_[i]; }
  /// Whether any joint bears tension.
  bool has_tension() const {
    return std::ranges::any_of(joints_, [](const TabulatedJoint& joint) { return joint.tensile_strength > 0.0; });
  }

  /// Divides tan(friction angle), cohesion and tensile strength of every joint, as the scene gave them, by the strength reduction factor.
  void reduce_strength(double factor);
  const std::optional<double>& reduction() const { return reduction_; }  ///< [-] the last one's, from which the strengths follow
  void exchange(Archive& archive);

 private:
  static bool stands_alone(const BlockSystem& system, const Contact& contact);

  /// Scenes may name as many materials as blocks: what is kept goes with the number of joints, not of pairs.
  struct OfMaterials {
    std::pair<int, int> materials;  ///< the lower number first
    int joint;
  };

  std::vector<OfMaterials> of_materials_;  ///< ascending
  std::vector<TabulatedJoint> joints_;
  std::vector<JointProperties> unreduced_;
  std::optional<double> reduction_;  ///< by reduce_strength(), if it was called
};

}  // namespace openclose
