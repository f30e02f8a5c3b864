// Every numerical threshold of the program that is not a user's input: name, value, unit, reason. None is scaled by the size of the model.
#pragma once

#include <limits>

namespace openclose::tolerance {

/// [m] Edges shorter than this are not edges: two orders above the rounding of coordinates of 1e6 m (1e6 * 2^-52 = 2e-10 m).
inline constexpr double shortest_edge_m = 1e-8;

/// [m] Width (2 area / longest edge) below which a polygon is a sliver that carries no usable mass or normal.
inline constexpr double thinnest_block_m = 1e-6;

/// [m] Width (2 area / longest edge) below which a block that the joints cut out is united with a neighbour, unless the scene says otherwise: joints
/// drawn to the millimetre that should meet in a point leave triangles of that size between them.
inline constexpr double sliver_width_m = 1e-3;

/// [m] The least width that can be asked for instead: a block four times as wide as a sliver cannot lie within thinnest_block_m of a line.
inline constexpr double least_sliver_width_m = 4.0 * thinnest_block_m;

/// [m] A joint that ends this near to another joint or to the boundary of the domain ends on it, unless the scene says otherwise: drawings are
/// rounded to millimetres.
inline constexpr double joint_end_reach_m = 1e-3;

/// [m] A block touches a line if it lies this near to it: points copied from vertices are written with six decimals.
inline constexpr double touching_m = 1e-6;

/// [-] of gravity: a smaller acceleration leaves a block at rest that is at rest, and a block that is slower than what this gives it in a step has
/// come to rest. The balance of a step, 1e-12 of the largest force, leaves that much where forces are a thousand times a block's weight; a slope must
/// be that near to its limit for it to matter.
inline constexpr double rest = 1e-9;

/// [m] Depth to which blocks may overlap in the file: drawings are rounded to millimetres, joint closures under load are of that size.
inline constexpr double deepest_initial_overlap_m = 1e-3;

/// [rad] An interior angle this close to pi is no corner: the vertex is dropped. An edge of 100 m then bends by less than 1e-7 m.
inline constexpr double straight_corner_rad = 1e-9;

/// [rad] Two edges face each other along their overlap up to parallel_full; beyond parallel_none a corner stands alone. Between them the tributary
/// length passes from one rule to the other linearly. Joint sets in rock mostly cross at more than parallel_none, so that of four blocks that meet in
/// one corner none face each other across it; a rocking block stays below parallel_full until long after its far corner has opened.
inline constexpr double parallel_full_rad = 5.0 * 3.14159265358979323846 / 180.0;
inline constexpr double parallel_none_rad = 15.0 * 3.14159265358979323846 / 180.0;

/// [rad] A side of a corner that points into an edge's half-plane by no more than this still leaves it: faces that are flush in the drawing turn by
/// their closures. The tip of a needle between a face and a joint is sharper only in slivers.
inline constexpr double flush_tilt_rad = 1.0 * 3.14159265358979323846 / 180.0;

/// [m] Overlaps of edges shorter than this carry no contact. Hard contacts carry whatever their length is, so this lies above what rounding and the
/// tolerance of the gap can make of edges that only meet end to end; it lies far below any joint that matters.
inline constexpr double shortest_overlap_m = 1e-6;

/// [m] and [-] A corner rides over the end of an edge that stands up no higher before it than this plus this many times what its contacts have
/// closed: two blocks whose faces were flush in the drawing differ by their closures under load. A real step of a millimetre is met once the corner
/// is behind it.
inline constexpr double seam_height_m = 1e-3;
inline constexpr double seam_closures = 2.0;

/// [m] A corner this far beyond the end of an edge still counts as opposite to it: corners that coincide in a drawing differ by rounding.
inline constexpr double edge_end_m = 1e-6;

/// [m] and [-] of the size of the free blocks, the root of their median area: room around a block's box within which candidates are kept although
/// they cannot touch yet, the smaller of the two. Larger: fewer searches, more candidates; a model with blocks of a centimetre, all of it smaller
/// than the length, would have each block as the candidate of each.
inline constexpr double search_skin_m = 0.25, search_skin_of_size = 0.5;

/// [m] and [-] of the size of the free blocks: how far a vertex may move in a step, the smaller of the two, unless the scene says otherwise. Blocks
/// twice that far apart are contacts, since they may meet in the step: less than one block's size away.
inline constexpr double longest_displacement_m = 0.1, longest_displacement_of_size = 0.25;

/// [m] and [-] of the size of the free blocks, the root of their median area: the list of contacts stays as it is until blocks may have moved this
/// much against each other, the smaller of the two, unless the scene says otherwise. Tributary lengths are off by less, 0.1 % of a joint, and corners
/// that come over the end of an edge are found by less too late, while gaps are followed exactly and corners that come off an end are found at once.
inline constexpr double contact_skin_m = 1e-3, contact_skin_of_size = 1e-3;

/// [-] Part of the cohesion's force, as a normal force, over which the shear strength of a bonded contact rises from zero (a jump there has no
/// solution on either side and makes contact states cycle; 0.1 changed 8 s of slope failure by 0.1 %).
inline constexpr double cohesion_ramp = 0.1;

/// [m] What rounding may leave in the ways of blocks against each other, and in the gaps between blocks that touch in the drawing: coordinates of 1e7
/// m have it twice over (1e7 * 2^-52 = 2e-9 m).
inline constexpr double rounding_of_ways_m = 1e-8;

/// [-] What rounding may leave in a residual, of the forces that meet in it: a dozen products and sums per contact, of which each rounds by a unit in
/// the last place at most.
inline constexpr double rounding_of_sums = 16.0 * std::numeric_limits<double>::epsilon();

/// [-] What rounding may leave in a time that is a multiple of the step, and in a quotient of times: some thousand units in the last place, and far
/// below a step of the longest runs, which have 1e9.
inline constexpr double rounding_of_times = 1e-12;

/// [m/s] `hard`: speed at which a penetration found at closing, or left by earlier steps, is pushed out at most.
inline constexpr double hard_recovery_m_per_s = 0.1;

/// [m] Coordinates in the file beyond this are refused: rounding (1e7 * 2^-52 = 2e-9 m) would come near the length of the shortest edge.
inline constexpr double farthest_coordinate_m = 1e7;

/// [m] A measured, loaded or supported point may lie this far outside its block: points copied from vertices are written with six decimals.
inline constexpr double farthest_point_outside_block_m = 1e-6;

/// [m] Two edges of a drawing that are no farther apart, or overlap by no more, are the sides of one joint; a point this near to both is a point of
/// it: drawings are rounded to millimetres. Where blocks are large, a thousandth of the median block's size is taken, as for what fos takes as
/// closed.
inline constexpr double farthest_point_from_joint_m = 1e-3;

}  // namespace openclose::tolerance
