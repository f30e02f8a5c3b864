// Proofs that need no trust in the solver: they look at forces and motions only.
#pragma once

#include "openclose/statics/frozen_state.h"

namespace openclose {

/// [-] Unbalanced force that may be left on a block over its own weight.
inline constexpr double negligible_share_of_weight = 1e-8;
/// [-] What rounding may leave on a block over the sum of the magnitudes of the forces on it.
inline constexpr double rounding_of_forces = 1e-13;
/// [-] By how much a strength may be exceeded: rounding of a product with it.
inline constexpr double rounding_of_strength = 1e-12;
/// [-] What a mechanism's velocities and forces may miss of its conditions, over the largest.
inline constexpr double mechanism_tolerance = 1e-6;
/// In closures: farther than any that joints make, and no motion of blocks that nothing but joints holds is followed beyond.
inline constexpr double farthest_way = 1e6;
/// In closures: gaps have digits of 1e-16 of the way, and forces are to balance to negligible_share_of_weight.
inline constexpr double farthest_way_with_digits = 1e8;

/// In closures: where supports may stop a motion, blocks are followed as far as the size of the median one, and farthest_way at least.
double farthest_way_of(const FrozenSystem& system);

/// Normal and shear force within the strength, but for rounding.
bool is_within_strength(const ContactStrength& strength, const FrozenContactState& contact);

/// How far a state is from equilibrium.
struct EquilibriumCheck {
  double unbalanced = 0.0;  ///< [-] largest unbalanced force of a block over what is negligible on it; equilibrium up to 1
  int block = -1;           ///< row of that block
  bool in_balance() const { return unbalanced <= 1.0; }
  bool within_strength = true;
  bool holds() const { return in_balance() && within_strength; }
};

/// Proof that the blocks stand: forces that balance every block and lie within the strength of every contact.
EquilibriumCheck check_equilibrium(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state);

/// Proof that the blocks start to move: forces within the strength leave accelerations, under which every contact goes on as it is. Closed contacts
/// stay closed, sticking ones do not slip, sliding ones slip against their friction at its bound, open ones do not close, and no support is
/// stretched that could bring the motion to an end within farthest_way_of(). The accelerations are those of rigid blocks under these forces.
/// \param direction  of the accelerations, as the solver found it
bool is_mechanism(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state, const Eigen::VectorXd& direction);

/// Proof that no strength in shear, however large, could hold the blocks: a motion on which the loads do work, in which no contact closes or slips,
/// nor opens where it has tensile strength. Forces in equilibrium could do no work on it.
bool is_beyond_all_strength(const FrozenSystem& system, const FrozenStrength& strength, const Eigen::VectorXd& direction);

}  // namespace openclose
