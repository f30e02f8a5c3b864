// Whether rigid contacts that hold blocks at rest do so by forces that their joints lead to.
//
// Between rigid blocks friction may lock any number of forces that balance each other, and the passes of `hard`, on whose way there blocks give way
// and come back, may end on such: a block that topples off a ledge jams against a wall that it only slides along. The joints' springs, from which
// rigid contacts take how they share what they leave undetermined, know one way from the intact rock to the joints' strength; where that ends in a
// mechanism, nothing brings the locked forces about.
#pragma once

#include "openclose/analysis/settle.h"

namespace openclose {

/// What settling has found: not settled where the blocks stand as they are drawn, by rigid contacts, and the springs of the joints lead to a
/// mechanism at this strength reduction factor [-]. Of blocks that have moved, of a balance that was found at once, and of methods with springs
/// nothing is asked.
SettleResult without_unreached_balance(const Simulation& simulation, SettleResult settled, double factor);

}  // namespace openclose
