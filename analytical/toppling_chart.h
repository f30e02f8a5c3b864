// What a block that is laid on a plane does first: it stays, slides, topples about its lower corner, or both (case B5). Frame, b = width and
// h = height as in block_on_plane.h, t = b/h, mu = tan(phi), rotation here positive downhill. Rigid block, two corners.
//
// Topples without sliding: moments about the lower corner, m (b^2 + h^2)/3 theta'' = W (h sin(alpha) - b cos(alpha))/2, so that
//   theta'' = 3 g (h sin(alpha) - b cos(alpha))/(2 (b^2 + h^2)),   positive for t < tan(alpha).
// The centroid then accelerates by (h/2, b/2) theta'': T = m (g sin(alpha) - theta'' h/2), N = m (g cos(alpha) + theta'' b/2), and the corner holds
// while
//   T/N <= mu:   mu* = [(4 t^2 + 1) tan(alpha) + 3 t]/[4 + t^2 + 3 t tan(alpha)].
// Slides and topples: T = mu N; moments about the centroid, m (b^2 + h^2)/12 theta'' = N (mu h - b)/2, hence theta'' = k N with
//   k = 6 (mu h - b)/(m (b^2 + h^2)),   and the corner stays on the plane: N = m g cos(alpha) + m theta'' b/2 = m g cos(alpha)/(1 - m k b/2).
// At t = tan(alpha) mu* is t, and both formulas agree at mu = mu*: the four modes fill the chart without gap or overlap (Bray & Goodman, Int. J. Rock
// Mech. Min. Sci. 18, 1981, correct the chart of static moments alone).
#pragma once

#include "openclose/analytical/block_on_plane.h"

namespace openclose::analytical {

enum class BlockMode { stays, slides, topples, slides_and_topples };

/// phi* [rad], the smallest friction angle at which a block that topples does not slide; t < tan(alpha).
double toppling_friction_angle(const BlockOnPlane& block);

BlockMode first_mode(const BlockOnPlane& block);

/// theta'' at the start [rad/s2], downhill positive; 0 for blocks that do not topple. \throws std::domain_error where no normal force carries the
/// sliding corner (m k b/2 >= 1)
double first_rotation_acceleration(const BlockOnPlane& block);

/// Angular velocity [rad/s] after toppling by `angle` about a corner that holds, from rest, by the work of the weight:
/// w^2 = 3 g/(b^2 + h^2) [h cos(alpha) + b sin(alpha) - h cos(alpha + angle) - b sin(alpha + angle)].
double toppling_velocity(const BlockOnPlane& block, double angle);

/// Slope angle at which the block tips over its lower corner, atan(b/h) [rad]; friction must hold it.
double tipping_angle(const BlockOnPlane& block);

/// The same on springs: with the whole weight on the lower corner, which closes by W cos(alpha)/kn, and the upper one just touching, the block is
/// tilted by sin(theta) = W cos(alpha)/(kn b), and alpha + theta = atan(b/h). Valid while the springs hold the block upright before, kn b^2 > W h.
double elastic_tipping_angle(const BlockOnPlane& block);

}  // namespace openclose::analytical
