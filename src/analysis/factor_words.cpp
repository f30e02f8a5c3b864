// What tables, summary and messages call a factor of safety and its verdict.
#include "openclose/analysis/strength_reduction.h"

namespace openclose {

std::string name_of_answer(const std::optional<std::string>& increase) {
  return increase ? "multiplier of " + *increase : "factor of safety";
}

const char* column_of_answer(const std::optional<std::string>& increase) {
  return increase ? "multiplier" : "srf";
}

const char* factor_verdict_word(FactorVerdict verdict) {
  switch (verdict) {
    case FactorVerdict::certified:
      return "certified";
    case FactorVerdict::interval:
      return "interval";
    case FactorVerdict::no_failure:
      return "no_failure";
    case FactorVerdict::no_equilibrium:
      return "no_equilibrium";
    case FactorVerdict::undecided:
      return "undecided";
  }
  return "";
}

}  // namespace openclose
