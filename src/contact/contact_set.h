// All contacts of a system, with their history. Steps work on those of which a block moves; the others are set aside with the blocks at rest, and
// come back as they were when one of their blocks is woken (Detector::divide).
#pragma once

#include <vector>

#include "openclose/contact/contact.h"
#include "openclose/core/memory.h"

namespace openclose {

struct ContactSet {
  std::vector<Contact> moving;   ///< in the order of the pairs of their blocks
  std::vector<Contact> resting;  ///< between blocks of which neither moves, one at least being at rest; pairs in any order

  template <class F>
  void for_each(F f) const {
    for (const Contact& c : moving) f(c);
    for (const Contact& c : resting) f(c);
  }
  std::size_t size() const { return moving.size() + resting.size(); }
  std::size_t bytes() const { return bytes_of(moving, resting); }
  void exchange(Archive& archive) { archive(moving, resting); }
};

}  // namespace openclose
