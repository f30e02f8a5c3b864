// Blocks as a search at small displacements leaves them, to be drawn.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "openclose/analysis/strength_reduction.h"
#include "openclose/statics/frozen_state.h"

namespace openclose {

/// [-] Of the fastest block of a mechanism: slower ones are carried along by rounding and springs.
inline constexpr double slowest_of_mechanism = 1e-2;

/// The drawn blocks, moved by the closures, and the forces that hold them.
NamedState stable_state(const Scene& drawn, const FrozenSystem& system, const FrozenState& state);

/// The failed state, and the blocks that move in it.
struct Mechanism {
  NamedState state;
  std::vector<FailingBlock> blocks;
};

/// \param direction  three numbers a row of the system, of any length but zero: velocity and radius times angular velocity; the fastest block
///                   is drawn half a median block away
Mechanism mechanism_of(const Scene& drawn, const FrozenSystem& system, const Eigen::VectorXd& direction);

}  // namespace openclose
