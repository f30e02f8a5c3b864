// A contact: one vertex of a block against one edge of another, with its history.
#pragma once

#include "openclose/contact/joint_state.h"
#include "openclose/core/archive.h"

namespace openclose {

enum class ContactStatus : unsigned char { open, sticking, sliding };

/// Signs: gap > 0 open; normal force > 0 compression; slip and shear force are measured along the edge's direction (counter-clockwise around its
/// block), the force is the one on the vertex's block. All forces per metre of thickness.
struct Contact {
  // Who touches whom. Constant while the contact lives.
  int vertex_block = 0;
  int vertex = 0;
  int edge_block = 0;
  int edge = 0;   ///< first vertex of the edge
  int joint = 0;  ///< index into the joint table

  // History, as the last accepted step left it; more of it below. Here because a number of one byte costs nothing beside the others.
  ContactStatus status = ContactStatus::open;
  JointState joint_state;

  // Geometry at the start of the step.
  double length = 0.0;    ///< [m] tributary length: stiffness, cohesion and tensile strength are per length
  double gap = 0.0;       ///< [m]
  double rest_gap = 0.0;  ///< [m] at which the normal spring carries nothing, see history.h

  // History, as the last accepted step left it.
  double elastic_slip = 0.0;     ///< [m] stretch of the shear spring; the spring's part of the shear force is -shear stiffness * elastic slip
  double normal_force = 0.0;     ///< [N] spring and dashpot; `dem`, of a contact that has just opened: what settles its crossing
  double shear_force = 0.0;      ///< [N]
  double stored_energy = 0.0;    ///< [J] in both springs, less the next
  double crossing_energy = 0.0;  ///< [J] `dem`: what closing has lost (negative) or opening has gained, see crossing_energy.h; not in the springs
  double slack = 0.0;            ///< [m] `hard` at rest: by how much an open contact would have parted, see hard.cpp

  /// [m] What the normal spring reads: the gap from where the spring rests.
  double stretch() const { return gap - rest_gap; }

  bool operator==(const Contact&) const = default;

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = *this;
    archive(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
  }
};

}  // namespace openclose
