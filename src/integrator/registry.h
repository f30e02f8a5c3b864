// The list of contact enforcements. A new one is a source file like soft.cpp, a declaration here and a line in registry.cpp.
#pragma once

#include <string>
#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

template <int N>
std::unique_ptr<Enforcement<N>> make_soft();
template <int N>
std::unique_ptr<Enforcement<N>> make_hard();
template <int N>
std::unique_ptr<Enforcement<N>> make_shi();
template <int N>
std::unique_ptr<Enforcement<N>> make_dem();

template <int N>
struct EnforcementEntry {
  const char* name;
  const char* summary;
  std::unique_ptr<Enforcement<N>> (*make)();
};

template <int N>
const std::vector<EnforcementEntry<N>>& enforcements();

/// Throws InputError, naming the accepted ones, if there is none of that name.
template <int N>
std::unique_ptr<Enforcement<N>> make_enforcement(const MethodInput& method);

}  // namespace openclose
