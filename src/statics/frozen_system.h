// The scene at small displacements: directions, lever arms and tributary lengths of the contacts stay as drawn, so that gaps and slips are linear in
// the displacements. Contact forces of statics do then not depend on the scale of the joints' stiffness, only on the ratios of stiffnesses; what is
// computed from here is a property of the drawn geometry.
//
// Everything is without dimension. Units: of length the root of the median area of the free blocks; of force the weight of the heaviest free block
// (without gravity: its mass times the largest acceleration that the loads of the scene would give a block); of displacement the closure of a mean
// contact under that force. Unknowns of a block are (x, y, rotation times its radius).
//
// Contacts are those that the detection finds in the drawing, seen in the units above, so that a scene drawn a thousand times smaller has the same
// ones. Joints drawn open or overlapping by less than closed_gap are closed; whatever is farther apart does not touch.
// Cohesion acts where faces touch: not on a lone corner, nor where two faces open like a wedge, as limit analysis has it.
#pragma once

#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/contact/joint_table.h"
#include "openclose/model/block_system.h"
#include "openclose/scene/scene.h"
#include "openclose/statics/joint_sections.h"

namespace openclose {

/// [m] By which lengths are divided: the root of the median area of the free blocks; 1 if there are none.
double frozen_length_unit(const Scene& scene);

using BlockVector = Eigen::Vector3d;  ///< x, y, rotation times radius

struct FrozenBlock {
  int block = 0;                           ///< of the scene
  Vec2 centroid = Vec2::Zero();            ///< [m] of the scene
  double radius = 0.0;                     ///< [-] of the farthest vertex
  BlockVector mass = BlockVector::Zero();  ///< over that of the heaviest block
  BlockVector load = BlockVector::Zero();  ///< gravity and loads, at the present multiplier of what strength_reduction.increase names
  BlockVector dead_load = BlockVector::Zero();
  BlockVector live_load = BlockVector::Zero();  ///< what is multiplied, at 1
  bool rotation_locked = false;
  double weight = 0.0;  ///< [-] mass times the unit of acceleration: the scale of forces on this block
};

/// One corner on one edge. Force N > 0 is compression; T is the shear force on the corner's block along the edge, see contact.h.
struct FrozenContact {
  int a = -1, b = -1;              ///< block rows of the corner's and the edge's block, -1 for a fixed one
  BlockVector normal_a, normal_b;  ///< gradients of the gap; also the generalised forces of N = 1
  BlockVector shear_a, shear_b;    ///< of the slip
  double normal_stiffness = 0.0;   ///< [-]
  double shear_stiffness = 0.0;    ///< [-]
  Contact source;                  ///< blocks, corner, edge, joint; its length in metres
  double joined_length = 0.0;      ///< [m] of the faces that touch each other here, on which cohesion and tensile strength act; 0 at a lone corner
  Vec2 point = Vec2::Zero();       ///< [m] of the scene
  Vec2 normal = Vec2::Zero();      ///< from the edge's block into the corner's
};

/// A spring that holds a point of a block in one direction; slack in the drawing.
struct FrozenSupport {
  int row = 0;
  BlockVector direction;  ///< generalised force of a unit force
  double stiffness = 0.0;
};

class FrozenSystem {
 public:
  /// \throws InputError for a missing joint
  explicit FrozenSystem(const Scene& scene);

  /// Whether the scene asks for the multiplier of a load, which is its live load.
  bool has_live_load() const { return has_live_load_; }
  /// Every block carries its dead load and so many times [-] its live load; from the beginning the dead load alone.
  void multiply_live_load(double multiplier);

  const std::vector<FrozenBlock>& blocks() const { return blocks_; }  ///< the free ones, in the order of their rows
  const std::vector<FrozenContact>& contacts() const { return contacts_; }
  const std::vector<JointSection>& sections() const { return sections_; }
  const std::vector<FrozenSupport>& supports() const { return supports_; }
  int rows() const { return static_cast<int>(blocks_.size()); }

  double force_unit() const { return force_unit_; }      ///< [N]
  double closure_unit() const { return closure_unit_; }  ///< [m]
  double length_unit() const { return length_unit_; }    ///< [m]

 private:
  void find_contacts(const Scene& scaled, const BlockSystem& system);
  void set_units(const Scene& scene);

  std::vector<FrozenBlock> blocks_;
  std::vector<FrozenContact> contacts_;
  std::vector<JointSection> sections_;
  std::vector<FrozenSupport> supports_;
  bool has_live_load_ = false;
  double force_unit_ = 1.0, closure_unit_ = 1.0, length_unit_ = 1.0;
};

}  // namespace openclose
