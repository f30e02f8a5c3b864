// Packs of four numbers from and to memory. For source files that are compiled without the warning about how vectors are passed (-Wno-psabi): all of
// this is inlined.
#pragma once

#include <cstring>

#include "openclose/core/packs.h"

namespace openclose::lanes {

/// By value: clang++ takes what a reference refers to for aligned in full.
OPENCLOSE_KERNEL Lanes load(const double* from) {
  Lanes x;
  std::memcpy(&x, from, sizeof x);
  return x;
}
OPENCLOSE_KERNEL void store(double* to, Lanes x) {
  std::memcpy(to, &x, sizeof x);
}

}  // namespace openclose::lanes
