// What a joint law remembers of a contact beside its springs. A law that remembers more adds it here: contacts, the loop of `dem`, the states of
// statics (which start with new ones), checkpoints and the hash of the state keep it as a whole, and who inherits a contact inherits it.
#pragma once

#include <array>
#include <limits>

#include "openclose/core/archive.h"

namespace openclose {

struct JointState {
  bool bonded = true;   ///< cohesion and tensile strength are there, or what slip has left of them
  double slip = 0.0;    ///< [m] of friction while it was bonded; of joints with a slip-weakening distance
  double joined = 1.0;  ///< [-] part of the tributary length along which the drawing has faces on each other: what cohesion and tension act on
  /// [m] that part of the drawing. However long the contact grows, surfaces that meet later are not bonded; ductile cohesion needs no bond.
  double bonded_length = std::numeric_limits<double>::max();

  bool operator==(const JointState&) const = default;
  /// For sums and comparisons.
  std::array<double, 4> numbers() const {
    const auto& [a, b, c, d] = *this;  // all of them: one more does not compile here
    return {a ? 1.0 : 0.0, b, c, d};
  }
  void exchange(Archive& archive) {
    auto& [a, b, c, d] = *this;
    archive(a, b, c, d);
  }
};

}  // namespace openclose
