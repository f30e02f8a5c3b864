// Small vibration of a block about its rest on a level plane, both corners closed and sticking (case D3).
// Bounce: w^2 = 2 kn/m. Sway and rock are coupled; with the unknowns (x of the centroid, rotation), M = diag(m, I) and
//   K = [[2 ks,  ks h                              ],
//        [ks h,  kn b^2/2 + ks h^2/2 - W h/2       ]],
// since a corner at (+-b/2, -h/2) moves by x + (h/2) theta along the plane and +-(b/2) theta normal to it; the last term is the weight on springs
// that are already pressed in by N = W/2: the corners rise by (h/2)(1 - cos theta). kn, ks [N/m] per corner. slope_angle and friction play no part.
#pragma once

#include <array>

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

/// [rad/s]
double bounce_frequency(const BlockOnPlane& block);
/// The two sway-rock frequencies [rad/s], lower first. \throws std::domain_error if the springs are too soft to hold the block upright
std::array<double, 2> sway_rock_frequencies(const BlockOnPlane& block);
/// Highest of the three [rad/s].
double highest_frequency(const BlockOnPlane& block);
/// Largest stable step of explicit central differences, 2/w_max [s].
double critical_explicit_step(const BlockOnPlane& block);

}  // namespace openclose::analytical
