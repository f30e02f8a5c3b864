// The list of contact enforcements. A new one is a source file like soft.cpp, a declaration here and a line in registry.cpp.
#pragma once

#include <string>
#include <vector>

#include "openclose/integrator/enforcement.h"

namespace openclose {

std::unique_ptr<Enforcement> make_soft();
std::unique_ptr<Enforcement> make_hard();
std::unique_ptr<Enforcement> make_shi();
std::unique_ptr<Enforcement> make_dem();

struct EnforcementEntry {
  const char* name;
  const char* summary;
  std::unique_ptr<Enforcement> (*make)();
};

const std::vector<EnforcementEntry>& enforcements();

/// Throws InputError, naming the accepted ones, if there is none of that name.
std::unique_ptr<Enforcement> make_enforcement(const MethodInput& method);

}  // namespace openclose
