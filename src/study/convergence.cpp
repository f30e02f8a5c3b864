#include "openclose/study/convergence.h"

#include <cmath>

namespace openclose {
namespace {

/// [-] Steps of 1e-2, 5e-3 and 2.5e-3 are written with rounding.
constexpr double accuracy_of_ratio = 1e-3;
/// A sequence that converges slower has not come to where its order shows.
constexpr double least_order = 0.5;
/// The integrators are of second order at most: where differences shrink faster, two of them agree by chance.
constexpr double highest_order = 3.0;

}  // namespace

std::optional<Limit> richardson_limit(std::span<const Refinement> refinements) {
  if (refinements.size() < 3) return std::nullopt;
  const Refinement *coarse = &refinements[refinements.size() - 3], *middle = coarse + 1, *fine = coarse + 2;
  const double ratio = middle->dt / fine->dt;
  if (!(ratio > 1.0) || std::abs(coarse->dt / middle->dt - ratio) > accuracy_of_ratio * ratio) return std::nullopt;
  const double before = coarse->value - middle->value, now = middle->value - fine->value;
  if (now == 0.0 || before / now <= 1.0) return std::nullopt;
  const double order = std::log(before / now) / std::log(ratio);
  if (order < least_order || order > highest_order) return std::nullopt;
  return Limit{fine->value - now / (before / now - 1.0), order};
}

std::vector<std::optional<double>> observed_orders(std::span<const double> steps, std::span<const double> errors) {
  std::vector<std::optional<double>> orders(steps.size());
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (errors[i - 1] > 0.0 && errors[i] > 0.0 && steps[i - 1] != steps[i])
      orders[i] = std::log(errors[i - 1] / errors[i]) / std::log(steps[i - 1] / steps[i]);
  }
  return orders;
}

}  // namespace openclose
