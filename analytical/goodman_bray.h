// Toppling columns on a stepped base (Goodman & Bray, ASCE Specialty Conf. Rock Eng. for Foundations and Slopes, 1976; case E4), in the frame of the
// base: x up the dip of the steps, y normal to it. Block k = 1 ... n from the toe has the width dx and stands on a step b above that of block k - 1;
// towards the crest each top is a1 above the lower neighbour's, beyond it a2 below. So the heights are y_k = k (a1 - b) to the crest and
// y_k = y_(k-1) - a2 - b beyond.
//
// The recursion takes the force P_k that block k + 1 exerts on block k to act at the upper end of their common side with the shear tan(phi) P_k.
// About the lower corner of block k, M_k and L_k being the heights of P_k and P_(k-1) above its base,
//   topples: P_(k-1) = [P_k (M_k - dx tan(phi)) + W_k (y_k sin(a) - dx cos(a))/2]/L_k,
//   slides:  P_(k-1) = P_k - W_k (cos(a) tan(phi) - sin(a))/(1 - tan(phi)^2),
// whichever is larger, and at least 0; M_k = y_k and L_k = y_k - a1 below the crest, M_k = y_k - a2 and L_k = y_k - a1 at it, M_k = y_k - a2 and
// L_k = y_k above. The slope is at its limit where the toe block needs nothing to hold it, P_0 = 0. Whether block 1 topples says nothing there, since
// no force could act below its neighbour's top (L_1 < 0).
#pragma once

#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/rigid_block_assembly.h"

namespace openclose::analytical {

struct GoodmanBray {
  int count = 16;
  int crest = 10;             // number of the highest block
  double width = 10;          // dx [m]
  double dip = 30 * degree;   // a [rad] of the steps
  double rise_to_crest = 5;   // a1 [m]
  double fall_beyond = 5;     // a2 [m]
  double step = 1;            // b [m]
  double unit_weight = 25e3;  // [N/m3]
  double gravity = 10;        // [m/s2]

  double height(int k) const;  // y_k [m]
};

/// P_0 [N] of the recursion.
double toe_force(const GoodmanBray& columns, double friction);

/// tan(phi) at which it vanishes; 0.7855442 for the defaults.
double limiting_friction(const GoodmanBray& columns);

/// The blocks with the base (the last block, fixed), gravity inclined, tan(phi) on all interfaces.
RigidBlockAssembly assembly_of(const GoodmanBray& columns, double friction);

}  // namespace openclose::analytical
