#include "openclose/study/convergence.h"

#include <cmath>

namespace openclose {
namespace {

/// [-] Steps of 1e-2, 5e-3 and 2.5e-3 are written with rounding.
constexpr double accuracy_of_ratio = 1e-3;
/// A sequence that converges slower has not come to where its order shows.
constexpr double least_order = 0.5;
/// [-] Orders of two triples of steps in a row that differ by more say that the first of them, or both, have not come to where an order shows.
constexpr double most_change_of_order = 0.5;
/// [-] Of a result: what steps change by less is what their iterations leave, and its order is chance.
constexpr double rounding_of_results = 1e-9;
/// The integrators are of second order at most: where differences or errors shrink faster, two values agree by chance.
constexpr double highest_order = 3.0;

/// Of three values by falling steps: the ratio of the steps, and the order with which the differences shrink; none where they do not.
struct Triple {
  double difference = 0.0;  ///< between the last two values
  double reduction = 0.0;   ///< [-] of the differences
  double order = 0.0;
};

std::optional<Triple> triple_of(std::span<const Refinement> three) {
  const Refinement &coarse = three[0], &middle = three[1], &fine = three[2];
  const double ratio = middle.dt / fine.dt;
  if (!(ratio > 1.0) || std::abs(coarse.dt / middle.dt - ratio) > accuracy_of_ratio * ratio) return std::nullopt;
  const double before = coarse.value - middle.value, now = middle.value - fine.value;
  if (now == 0.0 || before / now <= 1.0) return std::nullopt;
  return Triple{now, before / now, std::log(before / now) / std::log(ratio)};
}

}  // namespace

std::optional<Limit> richardson_limit(std::span<const Refinement> refinements) {
  if (refinements.size() < 3) return std::nullopt;
  const std::optional<Triple> last = triple_of(refinements.last(3));
  if (!last || last->order < least_order || last->order > highest_order) return std::nullopt;
  if (std::abs(last->difference) <= rounding_of_results * std::abs(refinements.back().value)) return std::nullopt;
  if (refinements.size() > 3) {
    const std::optional<Triple> before = triple_of(refinements.last(4).first(3));
    if (!before || std::abs(before->order - last->order) > most_change_of_order) return std::nullopt;
  }
  return Limit{refinements.back().value - last->difference / (last->reduction - 1.0), last->order};
}

std::vector<std::optional<double>> observed_orders(std::span<const double> steps, std::span<const double> errors, double size) {
  std::vector<std::optional<double>> orders(steps.size());
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (!(errors[i - 1] > 0.0 && errors[i] > 0.0) || steps[i - 1] == steps[i]) continue;
    if (std::abs(errors[i - 1] - errors[i]) <= rounding_of_results * size) continue;
    const double order = std::log(errors[i - 1] / errors[i]) / std::log(steps[i - 1] / steps[i]);
    if (order <= highest_order) orders[i] = order;
  }
  return orders;
}

}  // namespace openclose
