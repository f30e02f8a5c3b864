// Smallest cohesion c [Pa] that holds a settled block on a plane steeper than the friction angle (case B3). Two corner contacts of tributary length
// b/2 each, strength c b/2 + mu N_i, equal shear springs. Quasi-static: loads are applied slowly, no overshoot.
//
// Cohesion kept after slip (ductile; lost on opening is the same here, nothing opens): the upper corner yields first but keeps its strength, so
//   c b = W (sin alpha - mu cos alpha).
//
// Cohesion lost on first slip: both corners of a rigid block move alike along the plane (to first order in the tilt), so equal springs carry
// T = W sin(alpha)/2 each. The block holds if
//   nothing slips:          c b/2 >= T - mu N_up,    N_up = W (cos alpha/2 - h sin alpha/(2 b)), the weaker corner,
//   or the upper corner has slipped and the lower one carries the rest:  c b/2 >= W sin alpha - mu N_up - mu N_low = W (sin alpha - mu cos alpha).
// The threshold is the smaller of the two, which is the first as long as mu N_low < W sin(alpha)/2. (Only the first is given in the list of
// verification cases; at the default data it is the smaller one. The default block at friction angles above 24.1 degrees is governed by the second.)
// The elastic tilt (1e-4 rad at 50 MN/m) changes the share of each corner in the same relative order: a soft-contact run meets the ductile threshold
// exactly, this one to about 1e-4.
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

/// [Pa]; 0 where friction alone holds. The base length is block.width.
double ductile_cohesion_threshold(const BlockOnPlane& block);
/// [Pa]; 0 where friction alone holds both corners. Needs b/h > tan alpha.
double brittle_cohesion_threshold(const BlockOnPlane& block);

}  // namespace openclose::analytical
