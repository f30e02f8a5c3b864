// Sizes as the legend and the labels of a drawing write them: four digits, in the unit in which they are between 1 and 1000 or so.
#pragma once

#include <fmt/format.h>

#include <string>

namespace openclose {

/// As the four digits that are written say it, so that 999.99 is 1 of the next unit.
inline double of_four_digits(double value) {
  return std::stod(fmt::format("{:.3e}", value));
}

/// \param newtons  [N] per metre of thickness
inline std::string force_text(double newtons) {
  newtons = of_four_digits(newtons);
  if (newtons >= 1e6) return fmt::format("{:.4g} MN/m", 1e-6 * newtons);
  if (newtons >= 1e3) return fmt::format("{:.4g} kN/m", 1e-3 * newtons);
  return fmt::format("{:.4g} N/m", newtons);
}

/// \param pascals  [Pa]
inline std::string pressure_text(double pascals) {
  pascals = of_four_digits(pascals);
  if (pascals >= 1e6) return fmt::format("{:.4g} MPa", 1e-6 * pascals);
  if (pascals >= 1e3) return fmt::format("{:.4g} kPa", 1e-3 * pascals);
  return fmt::format("{:.4g} Pa", pascals);
}

/// \param metres  [m]
inline std::string length_text(double metres) {
  metres = of_four_digits(metres);
  if (metres >= 1.0) return fmt::format("{:.4g} m", metres);
  if (metres >= 1e-3) return fmt::format("{:.4g} mm", 1e3 * metres);
  return fmt::format("{:.4g} \xc2\xb5m", 1e6 * metres);
}

}  // namespace openclose
