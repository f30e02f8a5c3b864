// Numbers that can be computed with and that no rock, load or motion has: a wrong unit or a slip of the pen more often than not.
#pragma once

#include <string>
#include <vector>

#include "openclose/scene/scene.h"

namespace openclose {

/// [m/s2] More is refused in either direction: a hundred times what the fastest centrifuges for models reach (1000 g). Rounding of the forces alone
/// would move blocks there.
inline constexpr Range believable_gravity{.low = -1e6, .high = 1e6, .low_included = true, .high_included = true};

/// A warning for each number of a material, joint, block, load or base motion beyond what any has.
std::vector<std::string> implausible_numbers(const Scene& scene);

}  // namespace openclose
