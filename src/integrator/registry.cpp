#include "openclose/integrator/registry.h"

#include <fmt/format.h>

namespace openclose {

template <int N>
const std::vector<EnforcementEntry<N>>& enforcements() {
  static const std::vector<EnforcementEntry<N>> list = {
      {"soft", "springs of the joint's own stiffness (the paper's DDA-SC)", &make_soft<N>},
      {"hard", "no penetration beyond a tolerance, multipliers iterated in every step", &make_hard<N>},
      {"shi", "penalty springs with open-close iterations (the paper's DDA-Shi)", &make_shi<N>},
      {"dem", "explicit: central difference with the joint's own springs (the paper's UDEC)", &make_dem<N>},
  };
  return list;
}

template <int N>
std::unique_ptr<Enforcement<N>> make_enforcement(const MethodInput& method) {
  std::string names;
  for (const auto& entry : enforcements<N>()) {
    if (method.contact == entry.name) return entry.make();
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", entry.name);
  }
  throw InputError(method.contact_where, "method.contact", fmt::format("\"{}\" is no known contact enforcement", method.contact), names);
}

template const std::vector<EnforcementEntry<3>>& enforcements<3>();
template std::unique_ptr<Enforcement<3>> make_enforcement<3>(const MethodInput&);

}  // namespace openclose
