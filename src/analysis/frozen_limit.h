// Rigid-block limit analysis of a FrozenSystem: an upper bound of every factor at small displacements, and a proof of failure above it.
#pragma once

#include "openclose/limit_analysis/limit_analysis.h"
#include "openclose/statics/frozen_state.h"

namespace openclose {

/// What becomes of corners that stand alone on an edge.
enum class LoneCorners { counted, left_out };

/// The same blocks, contact points and strengths, in metres and newtons. Supports hold without limit. What varies is the strength, or the live load
/// of the system, if it has one. \param strength  at factor 1
limit_analysis::Problem limit_problem(const FrozenSystem& system, const FrozenStrength& strength, LoneCorners lone_corners = LoneCorners::counted);

}  // namespace openclose
