// Where and in which directions the contact forces of a whole step act: normal, tangent and both arms are means of those at its start and its end.
//
// With nb the mean normal, rb the mean arm of the vertex and cb the mean of p - (centroid of the edge's block), unit forces act with [nb, rb x nb] on
// the vertex's block and -[nb, cb x nb] on the edge's, tangents alike. Both act at the mean of the two places of p, so that with velocities v0 + v1 =
// 2 d/dt the angular momentum of the two blocks stays to rounding. The work of these forces is their product with the change of gap and slip, exactly
// for translations and to the third order in the rotations of the step.
#pragma once

#include "openclose/contact/kinematics.h"

namespace openclose {

/// For exact rotation. Its changes of gap and slip are left at zero; its normal is shorter than a unit vector where the edge turns.
inline ContactPose mean_pose(const ContactStart& start, const ContactPose& end) {
  ContactPose mean;
  mean.normal = 0.5 * (start.normal + end.normal);
  mean.vertex_arm = 0.5 * (start.vertex_arm + end.vertex_arm);
  mean.edge_arm = 0.5 * ((start.end_arm + start.lever) + end.edge_arm);
  return mean;
}

}  // namespace openclose
