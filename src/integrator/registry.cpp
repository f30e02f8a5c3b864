#include "openclose/integrator/registry.h"

#include <fmt/format.h>

#include "openclose/scene/nearest.h"

namespace openclose {

const std::vector<EnforcementEntry>& enforcements() {
  static const std::vector<EnforcementEntry> list = {
      {"soft", "springs of the joint's own stiffness (the paper's DDA-SC)", &make_soft},
      {"hard", "no penetration beyond a tolerance, multipliers iterated in every step", &make_hard},
      {"shi", "penalty springs with open-close iterations (the paper's DDA-Shi)", &make_shi},
      {"dem", "explicit: central difference with the joint's own springs (the paper's UDEC)", &make_dem},
  };
  return list;
}

std::unique_ptr<Enforcement> make_enforcement(const MethodInput& method) {
  std::string names;
  std::vector<std::string> words;
  for (const auto& entry : enforcements()) {
    if (method.contact == entry.name) return entry.make();
    names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", entry.name);
    words.emplace_back(entry.name);
  }
  throw InputError(method.contact_where, "method.contact",
                   fmt::format("\"{}\" is no known contact enforcement{}", method.contact, did_you_mean(method.contact, words)), names);
}

}  // namespace openclose
