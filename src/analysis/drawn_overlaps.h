// Blocks that the drawing puts into each other. Springs take such an overlap for a closure that somebody has pressed, so that blocks are thrown or
// clamped by a force that comes from nothing but the drawing.
#pragma once

#include <string>
#include <vector>

#include "openclose/analysis/simulation.h"

namespace openclose {

namespace overlap_bound {

/// [m] Twice the rounding of the farthest coordinates that a scene may have (1e7 * 2^-52 each): no overlap but the rounding of two outlines.
inline constexpr double rounding_m = 4e-9;
/// [-] Of the weight and loads of a block: a smaller force that holds it changes its motion by no more than the watch lets pass of its energy.
inline constexpr double noticeable_force = 0.01;
/// [-] The same, from which on the drawing's error is as large as all that acts on the block, so that it decides whether the block stands.
inline constexpr double deciding_force = 1.0;
/// [-] Of the block's size, to which its overlaps' energy may move it: 0.1 % is what the lists of contacts neglect of positions, too
/// (tolerance::contact_skin_of_size); ten times that is a motion which every table of results shows.
inline constexpr double noticeable_way = 1e-3, deciding_way = 1e-2;

}  // namespace overlap_bound

/// What becomes of the blocks first.
enum class FirstMotion : unsigned char {
  settling,  ///< they come to rest, and what overlaps store goes
  at_once,   ///< they move from where they are drawn
};

/// Looks at the drawn blocks, before anything has moved. Overlaps whose forces balance what acts on the blocks, as those of an earlier result at rest
/// do, are none of the drawing. Throws InputError where overlaps decide the answer: where what they store can move a block by more than
/// overlap_bound::deciding_way of its size, or where fixed blocks clamp one and hold it so, by friction or
/// from more than two sides, with more than overlap_bound::deciding_force (rigid contacts: at all).
/// \return what may be noticed, at most one line for each kind
std::vector<std::string> judge_drawn_overlaps(Simulation& simulation, FirstMotion first_motion);

}  // namespace openclose
