// Blocks on top of each other: how far a stack can lean over an edge (case F2), and how a column vibrates (case F3).
#pragma once

#include <vector>

namespace openclose::analytical {

/// The largest overhang, in block lengths, of n equal blocks each of which carries the next one only: the k-th from the top may reach 1/(2k) over the
/// one below it (there the centroid of the k upper ones is at the edge), in all H_n/2. n >= 1.
double largest_overhang(int blocks);

/// Frequencies [rad/s], lowest first, of n equal masses [kg] one on top of the other between n equal springs [N/m], the lowest on a fixed base, the
/// uppermost free: w_j = 2 sqrt(k/m) sin((2j - 1) pi/(2 (2n + 1))).
std::vector<double> column_frequencies(int blocks, double mass, double stiffness);
/// Displacements of the masses, from below, in the mode of number 1 ... n: sin(i (2j - 1) pi/(2n + 1)) [-].
std::vector<double> column_shape(int blocks, int mode);

}  // namespace openclose::analytical
