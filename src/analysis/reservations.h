// What is to be said about a factor though it is proved: that the state it stands on leans on one corner, that the cohesion of joints is not there
// because nothing presses on them, or that it is the lower end of a wide interval.
#pragma once

#include <optional>

#include "openclose/analysis/strength_reduction.h"
#include "openclose/statics/frozen_state.h"

namespace openclose {

/// Rows of the blocks of a mechanism.
std::vector<int> rows_of(const FrozenSystem& system, const std::vector<FailingBlock>& mechanism);

/// The lone corner that presses most on an edge.
struct CornerLoad {
  int contact = -1;    ///< of the system
  double share = 0.0;  ///< [-] of the weight of the blocks that were asked about
};

/// Of corners that stand alone on an edge, of blocks among the rows. A corner that stands alone may carry any force, as rigid blocks have it; rock
/// would crush. None if no such corner presses.
std::optional<CornerLoad> heaviest_lone_corner(const FrozenSystem& system, const FrozenState& state, const std::vector<int>& rows);

/// "the corner at (x, y) m of block a, alone on block b, carries so much of the weight of what fails".
std::string in_words(const Scene& scene, const FrozenSystem& system, const CornerLoad& corner);

/// [-] How much of cohesion and friction together the contacts of the rows do not have because their cohesion grows from nothing with the normal
/// force, see ShearLimit: limit analysis counts all of it.
double withheld_strength(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state, const std::vector<int>& rows);

/// Whether a joint of the rows is bent so far that it will crack from its edge at hardly less strength.
bool is_about_to_crack(const FrozenSystem& system, const FrozenStrength& strength, const FrozenState& state, const std::vector<int>& rows);

/// The strength withheld as a reason why limit analysis has more.
std::string withheld_in_words(double share);

/// How wide an interval is, from where on it is open, and what may narrow it; empty if no trial stayed undecided above its stable end.
std::string interval_in_words(const StrengthBracket& bracket, const std::vector<StrengthTrial>& trials);

}  // namespace openclose
