// What does not stand as it is drawn, before anything is run: rigid-block limit analysis at the scene's own strength, whose mechanism is a proof.
#pragma once

#include <string>

#include "openclose/scene/scene.h"

namespace openclose {

/// [-] Of the weight and loads of every block, to either side and as a couple: what so little moves is held by nothing, whether friction of zero, a
/// point that it balances on or a strength that is just used up.
inline constexpr double least_push = 1e-4;
/// Free blocks up to which the linear programs take seconds.
inline constexpr int most_blocks_to_try = 1000;

/// One line: which blocks move by themselves, or at the least push, how, and what would hold them (motion_in_words). Empty where all stand, where
/// there is no gravity, and for more blocks than most_blocks_to_try.
std::string loose_blocks_in_words(const Scene& scene);

}  // namespace openclose
