// What kernels do with four numbers at a time. For source files that are compiled without the warning about how vectors are passed (-Wno-psabi): all
// of this is inlined.
#pragma once

#include <cmath>

#include "openclose/core/lane_memory.h"

namespace openclose::lanes {

using Mask = decltype(Lanes{} < Lanes{});

OPENCLOSE_KERNEL Lanes all(double x) {
  return Lanes{x, x, x, x};
}
/// x in the lanes of the mask, 0 in the others.
OPENCLOSE_KERNEL Lanes only_where(Mask mask, Lanes x) {
  return (Lanes)((Mask)x & mask);
}
/// a / b in the lanes of the mask, 0 in the others, whose b may be 0.
OPENCLOSE_KERNEL Lanes quotient(Mask mask, Lanes a, Lanes b) {
  return only_where(mask, a / (mask ? b : all(1.0)));
}
OPENCLOSE_KERNEL Lanes magnitude(Lanes x) {
  return (Lanes)((Mask)x & ~(Mask)-Lanes{});
}
/// In files that are compiled with -fno-math-errno one operation.
OPENCLOSE_KERNEL Lanes square_root(Lanes x) {
  Lanes root;
  for (int k = 0; k < batch_size; ++k) root[k] = std::sqrt(x[k]);
  return root;
}
/// As std::max.
OPENCLOSE_KERNEL Lanes larger(Lanes a, Lanes b) {
  return a < b ? b : a;
}
OPENCLOSE_KERNEL bool any(Mask m) {
  return (m[0] | m[1] | m[2] | m[3]) != 0;
}

OPENCLOSE_KERNEL void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

}  // namespace openclose::lanes
