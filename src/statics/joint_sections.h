// The joints between two blocks, each along one line, for the stress in them: see edge_stress.h.
#pragma once

#include <functional>
#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/contact/ground_outline.h"
#include "openclose/contact/joined_faces.h"
#include "openclose/model/block_system.h"

namespace openclose {

/// A contact as a part of its joint.
struct PlaceInJoint {
  int contact;
  double at, low, high;  ///< [units of length] along the joint: of the corner, and of what it stands for
  double filled = 0.0;   ///< [units of length] of that, what lies beyond its halves, where corners that face nothing have left a hole
};

/// Contacts of two blocks whose faces lie on one line, however many corners these have, and however many blocks of the ground there are along it.
using JointSection = std::vector<PlaceInJoint>;
/// \param joined  of the contacts, with this gap; those of which nothing is joined are in no section
std::vector<JointSection> joint_sections(const BlockSystem& system, const GroundOutline& ground, const std::vector<Contact>& contacts,
                                         const std::vector<Joined>& joined, double gap);

/// What a contact carries, and what its joint bears there.
struct EndOfJoint {
  double normal;   ///< [N] compression positive
  double tension;  ///< [N] of the tensile strength, 0 where nothing is bonded
  double length;   ///< [units of length] that this strength is of
};

/// [-] For each contact, what the part of the joint that it stands for pulls with at most, over its tensile strength: from 1 on it cracks, see
/// edge_stress.h. 0 where nothing pulls.
std::vector<double> pulls_at_edges(const std::vector<JointSection>& sections, std::size_t contacts, const std::function<EndOfJoint(int)>& end_of);

}  // namespace openclose
