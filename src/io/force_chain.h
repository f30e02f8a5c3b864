// The links of force chains: what two blocks press on each other with, drawn from one into the other.
#pragma once

#include <vector>

#include "openclose/io/drawing.h"

namespace openclose {

/// What the contacts of two blocks carry together.
struct PairForce {
  int a = 0, b = 0;
  Vec2 on_a = Vec2::Zero();   ///< [N] not zero
  Vec2 point = Vec2::Zero();  ///< [m] between the contacts, by what they carry
};

/// Through its point along its direction, so far into either block that what passes through a block makes a chain.
/// \param size  [m] of the median block
Picture::Force force_through(const PairForce& pair, const std::vector<Picture::Block>& blocks, double size);

}  // namespace openclose
