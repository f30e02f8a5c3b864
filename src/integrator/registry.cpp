#include "openclose/integrator/registry.h"

#include "openclose/integrator/integrators.h"

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
  return find_named(enforcements(), method.contact, method, "method.contact", "contact enforcement").make();
}

}  // namespace openclose
