// A block thrown along the plane comes to a stop by friction (case B4). v0 the speed, d = v0^2/(2 r), t = v0/r with the retardation
//   level r = mu g;  uphill r = g (mu cos alpha + sin alpha);  downhill r = g (mu cos alpha - sin alpha).
// Rigid contact, no tumbling; springs follow below.
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

struct Stop {
  double time;      // [s]
  double distance;  // [m] travelled
};

/// \param speed [m/s] >= 0  \param direction +1 downhill, -1 uphill; the same on a level plane
/// \throws std::domain_error if the block never stops (downhill with phi <= alpha)
Stop stopping(const BlockOnPlane& block, double speed, int direction);

/// Soft contact on a level plane, rotation locked, started in the steady sliding state: the block stops at d with the shear springs at their bound
/// mu W, and they throw it back: it oscillates about d - mu W/(2 ks) with that amplitude, w^2 = 2 ks/m, without touching the bound again.
struct Rebound {
  double centre;     // [m] from the start, along the motion
  double amplitude;  // [m]
  double frequency;  // [rad/s]
};

/// slope_angle must be 0. \throws std::domain_error on a slope
Rebound rebound_after_stop(const BlockOnPlane& block, double speed);

}  // namespace openclose::analytical
