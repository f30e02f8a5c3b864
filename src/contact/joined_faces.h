// The faces that lie on each other at a contact. Stiffness takes the whole tributary length, also of faces that part from each other by a few
// degrees, so that a block that rocks does not jump; cohesion and tensile strength are only where faces touch.
#pragma once

#include "openclose/contact/contact.h"
#include "openclose/contact/ground_outline.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// [-] of the size of blocks, BlockSystem::median_size(): faces that are no farther apart, or overlap by no more, lie on each other. Drawings of
/// blocks of a metre are rounded to the millimetre.
inline constexpr double closed_gap = 1e-3;

/// What of a contact lies on faces that touch each other [units of length].
struct Joined {
  double length = 0.0;               ///< those halves of the faces' overlaps that the contact stands for
  double ahead = 0.0, behind = 0.0;  ///< of them, what lies along the edge's direction from the corner, and against it
};

/// The faces at a corner that lie on the edge.
/// \param gap  [units of length] faces that are no farther apart lie on each other
Joined joined_at(const BlockSystem& system, const GroundOutline& ground, const Contact& contact, double gap);

}  // namespace openclose
