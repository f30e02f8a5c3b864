#include "openclose/scene/angle.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace openclose {

double radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}

double degrees(double angle) {
  const double first_guess = angle / (std::numbers::pi / 180.0);
  const double infinity = std::numeric_limits<double>::infinity();
  double candidate = std::nextafter(std::nextafter(first_guess, -infinity), -infinity);
  std::optional<double> shortest;
  for (int i = 0; i < 5; ++i, candidate = std::nextafter(candidate, infinity)) {
    if (radians(candidate) != angle) continue;
    if (!shortest || fmt::formatted_size("{}", candidate) < fmt::formatted_size("{}", *shortest)) shortest = candidate;
  }
  return shortest.value_or(first_guess);
}

}  // namespace openclose
