// Normal forces at the two corners of a rigid block on a plane (case B2). W the weight, b along the plane, h normal to it; moments about the
// centroid: (N_low - N_up) b/2 = T h/2, T the total tangential force. Valid while both are positive: holding needs b/h > tan alpha, sliding b/h > mu.
// Springs of finite stiffness tilt the block by (N_low - N_up)/(kn b) and change these forces by that angle, relatively; steady_pose (incline.h) has
// the exact sliding pose.
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

struct CornerForces {
  double lower;  // [N] downhill corner
  double upper;  // [N] uphill corner
};

/// Block at rest, T = W sin alpha: N = W (cos alpha/2 +- h sin alpha/(2 b)).
CornerForces holding_corner_forces(const BlockOnPlane& block);
/// Block that slides downhill, T = mu W cos alpha: N = (W cos alpha/2)(1 +- mu h/b).
CornerForces sliding_corner_forces(const BlockOnPlane& block);

}  // namespace openclose::analytical
