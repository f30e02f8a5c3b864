// What a joint law remembers of a contact beside its springs. A law that remembers more adds it here: contacts, the loop of `dem`, the states of
// statics, checkpoints and the hash of the state keep it as a whole, and who inherits a contact inherits it.
#pragma once

#include <array>

#include "openclose/core/archive.h"

namespace openclose {

struct JointState {
  bool bonded = true;  ///< cohesion and tensile strength are there, or what slip has left of them
  double slip = 0.0;   ///< [m] of friction while it was bonded; of joints with a slip-weakening distance

  bool operator==(const JointState&) const = default;
  /// For sums and comparisons.
  std::array<double, 2> numbers() const {
    const auto& [a, b] = *this;  // all of them: one more does not compile here
    return {a ? 1.0 : 0.0, b};
  }
  void exchange(Archive& archive) {
    auto& [a, b] = *this;
    archive(a, b);
  }
};

}  // namespace openclose
