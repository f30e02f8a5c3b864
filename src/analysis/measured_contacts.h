// The measured contacts of a scene: what the joint between two blocks carries at one of its faces, and how it has opened and slipped.
#pragma once

#include <string>
#include <vector>

#include "openclose/analysis/drawn_joints.h"
#include "openclose/analysis/simulation.h"

namespace openclose {

/// Forces are sums over all contacts on the two edges that face each other at the point: corners of either block on the edge of the other.
struct ContactMotion {
  std::string name;
  double normal_force = 0.0;                   ///< [N] positive in compression
  double shear_force = 0.0;                    ///< [N] on a along the edge of b, counter-clockwise around b
  double gap = 0.0;                            ///< [m] at the point, see JointGap; known beyond the reach of detection, too
  double slip = 0.0;                           ///< [m] at the point, since the drawing
  ContactStatus status = ContactStatus::open;  ///< open if all contacts are, sliding if all that are closed slide
  int closed = 0;                              ///< contacts
};

class MeasuredContacts {
 public:
  explicit MeasuredContacts(const Scene& scene);
  std::vector<ContactMotion> motions(const Simulation& simulation) const;

 private:
  std::vector<DrawnJoint> joints_;
};

}  // namespace openclose
