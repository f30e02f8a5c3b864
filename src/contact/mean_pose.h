// Where and in which directions the contact forces of a whole step act: normal, tangent and both arms are means of those at its start and its end.
//
// With nb the mean normal, rb the mean arm of the vertex and cb the mean of p - (centroid of the edge's block), unit forces act with [nb, rb x nb] on
// the vertex's block and -[nb, cb x nb] on the edge's, tangents alike. Both act at the mean of the two places of p, so that with velocities v0 + v1 =
// 2 d/dt the angular momentum of the two blocks stays to rounding. The work of these forces is their product with the change of gap and slip, exactly
// for translations and to the third order in the rotations of the step.
#pragma once

#include "openclose/contact/kinematics.h"

namespace openclose {

/// For exact rotation. Its normal is shorter than a unit vector where the edge turns. Four contacts for Real = Lanes.
/// \param start  with the members of StartNumbers
template <class Start, class Real>
OPENCLOSE_KERNEL ForcePlace<Real> mean_place(const Start& start, const ForcePlace<Real>& end) {
  return {0.5 * (start.normal_x + end.normal_x),
          0.5 * (start.normal_y + end.normal_y),
          0.5 * (start.vertex_arm_x + end.vertex_arm_x),
          0.5 * (start.vertex_arm_y + end.vertex_arm_y),
          0.5 * ((start.end_arm_x + start.lever_x) + end.edge_arm_x),
          0.5 * ((start.end_arm_y + start.lever_y) + end.edge_arm_y)};
}
/// Its changes of gap and slip are left at zero.
inline ContactPose mean_pose(const StartNumbers& start, const ContactPose& end) {
  return ContactPose(mean_place(start, force_place(end)));
}

}  // namespace openclose
