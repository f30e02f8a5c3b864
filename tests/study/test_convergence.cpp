// Limits and orders of sequences whose limits and orders are known.
#include <cmath>

#include "openclose/study/convergence.h"
#include "support/catch.h"

using namespace openclose;

namespace {

/// q(h) = 3 + C h^p
std::vector<Refinement> sequence(double order, double factor, std::vector<double> steps) {
  std::vector<Refinement> list;
  for (const double h : steps) list.push_back({h, 3.0 + factor * std::pow(h, order)});
  return list;
}

}  // namespace

TEST_CASE("Richardson's extrapolation finds the limit and the order of a power law", "[study]") {
  for (const double order : {1.0, 1.5, 2.0, 2.9}) {
    for (const double factor : {2.0, -0.7}) {
      for (const double ratio : {2.0, 3.0}) {
        INFO(order << ' ' << factor << ' ' << ratio);
        const auto limit = richardson_limit(sequence(order, factor, {0.1 * ratio * ratio * ratio, 0.1 * ratio * ratio, 0.1 * ratio, 0.1}));
        REQUIRE(limit);
        CHECK(limit->value == Approx(3.0).epsilon(1e-9));
        CHECK(limit->order == Approx(order).epsilon(1e-6));
      }
    }
  }
}

TEST_CASE("steps that say nothing of a limit give none", "[study]") {
  CHECK_FALSE(richardson_limit(sequence(1.0, 1.0, {0.2, 0.1})));
  CHECK_FALSE(richardson_limit(sequence(1.0, 1.0, {0.3, 0.2, 0.1})));
  CHECK_FALSE(richardson_limit(sequence(0.2, 1.0, {0.4, 0.2, 0.1})));
  CHECK_FALSE(richardson_limit(sequence(4.0, 1.0, {0.4, 0.2, 0.1})));
  // Three that agree by chance, after one that does not.
  CHECK(richardson_limit(std::vector<Refinement>{{0.4, 1.4}, {0.2, 1.2}, {0.1, 1.1}}));
  CHECK(richardson_limit(std::vector<Refinement>{{0.8, 1.8}, {0.4, 1.4}, {0.2, 1.2}, {0.1, 1.1}}));
  CHECK_FALSE(richardson_limit(std::vector<Refinement>{{0.8, 1.0}, {0.4, 1.4}, {0.2, 1.2}, {0.1, 1.1}}));
  CHECK_FALSE(richardson_limit(std::vector<Refinement>{{0.8, 3.0}, {0.4, 1.4}, {0.2, 1.2}, {0.1, 1.1}}));
  // To and fro, away, and no change at all.
  CHECK_FALSE(richardson_limit(std::vector<Refinement>{{0.4, 1.0}, {0.2, 2.0}, {0.1, 1.5}}));
  CHECK_FALSE(richardson_limit(std::vector<Refinement>{{0.4, 1.0}, {0.2, 1.1}, {0.1, 1.4}}));
  CHECK_FALSE(richardson_limit(std::vector<Refinement>{{0.4, 1.0}, {0.2, 1.0}, {0.1, 1.0}}));
  // Differences of rounding that shrink by chance; the same ones of a result that is as small.
  CHECK_FALSE(richardson_limit(std::vector<Refinement>{{0.4, 1.0 + 4e-12}, {0.2, 1.0 + 2e-12}, {0.1, 1.0 + 1e-12}}));
  CHECK(richardson_limit(std::vector<Refinement>{{0.4, 8e-12}, {0.2, 6e-12}, {0.1, 5e-12}}));
}

TEST_CASE("observed orders are those between neighbouring steps", "[study]") {
  const std::vector<double> steps = {0.4, 0.2, 0.05, 0.025, 0.0125}, errors = {0.16, 0.04, 0.01, 0.0, 1e-9};
  const auto orders = observed_orders(steps, errors, 1.0);
  CHECK_FALSE(orders[0]);
  CHECK(orders[1].value() == Approx(2.0));
  CHECK(orders[2].value() == Approx(1.0));
  CHECK_FALSE(orders[3]);
  CHECK_FALSE(orders[4]);
}

TEST_CASE("an order that no integrator has is left out of the observed ones", "[study]") {
  const std::vector<double> steps = {0.4, 0.2, 0.1, 0.05};
  // Of order 4, of 2.9 and, where the error grows, of -1.
  const auto orders = observed_orders(steps, std::vector<double>{16.0, 1.0, std::pow(0.5, 2.9), 2.0 * std::pow(0.5, 2.9)}, 1.0);
  CHECK_FALSE(orders[1]);
  CHECK(orders[2].value() == Approx(2.9));
  CHECK(orders[3].value() == Approx(-1.0));
}

TEST_CASE("errors that differ by rounding have no order", "[study]") {
  const std::vector<double> steps = {0.4, 0.2, 0.1}, alike = {1e-3, 1e-3 * (1.0 + 5e-8), 1e-3}, tiny = {1e-14, 1.4e-13, 3e-12};
  for (const auto& errors : {alike, tiny}) {
    for (const auto& order : observed_orders(steps, errors, 1.0)) CHECK_FALSE(order);
  }
  CHECK(observed_orders(steps, tiny, 1e-12)[1]);
}
