#include "openclose/scene/limits.h"

#include <fmt/format.h>

#include <cmath>

namespace openclose {

bool Range::contains(double value) const {
  // What is no number is in no interval, which these comparisons say without an exception of the machine.
  const bool above = low_included ? std::isgreaterequal(value, low) : std::isgreater(value, low);
  const bool below = high_included ? std::islessequal(value, high) : std::isless(value, high);
  return above && below;
}

std::string Range::describe(const std::string& noun) const {
  const bool bounded_below = std::isfinite(low);
  const bool bounded_above = std::isfinite(high);
  if (bounded_below && bounded_above) return fmt::format("a {} in {}{}, {}{}", noun, low_included ? '[' : '(', low, high, high_included ? ']' : ')');
  if (bounded_below) return fmt::format("a {} {} {}", noun, low_included ? ">=" : ">", low);
  if (bounded_above) return fmt::format("a {} {} {}", noun, high_included ? "<=" : "<", high);
  return "a finite " + noun;
}

}  // namespace openclose
