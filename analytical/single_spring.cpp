#include "openclose/analytical/single_spring.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace openclose::analytical {
namespace {

struct Invariants {
  double half_trace;
  double determinant;
};

double denominator(const SpringStep& step) {
  return 1 + step.theta * step.phase() * step.phase() / 2;
}

Invariants invariants(const SpringStep& step) {
  const double half_square = step.phase() * step.phase() / 2;
  return {(1 - half_square / 2) / denominator(step), (1 + (1 - step.theta) * half_square) / denominator(step)};
}

}  // namespace

double free_vibration(double frequency, double time) {
  return std::cos(frequency * time);
}

double damped_vibration(double frequency, double damping_ratio, double time) {
  const double decay = damping_ratio * frequency;
  const double square = frequency * frequency - decay * decay;
  if (square > 0) return std::exp(-decay * time) * std::sin(std::sqrt(square) * time) / std::sqrt(square);
  if (square == 0) return std::exp(-decay * time) * time;
  return std::exp(-decay * time) * std::sinh(std::sqrt(-square) * time) / std::sqrt(-square);
}

std::array<std::array<double, 2>, 2> amplification_matrix(const SpringStep& step) {
  const double half_square = step.phase() * step.phase() / 2;
  const double d = denominator(step);
  return {{{(1 - (1 - step.theta) * half_square) / d, step.dt / d}, {-step.frequency * step.phase() / d, (1 - step.theta * half_square) / d}}};
}

double spectral_radius(const SpringStep& step) {
  const auto [half_trace, determinant] = invariants(step);
  const double discriminant = half_trace * half_trace - determinant;
  return discriminant < 0 ? std::sqrt(determinant) : std::abs(half_trace) + std::sqrt(discriminant);
}

double bifurcation_phase(double theta) {
  return theta > 0.5 ? 2 / (theta - 0.5) : std::numeric_limits<double>::infinity();
}

double period_ratio(const SpringStep& step) {
  if (step.phase() >= bifurcation_phase(step.theta)) throw std::domain_error("no period: the eigenvalues are real");
  const auto [half_trace, determinant] = invariants(step);
  return step.phase() / std::atan2(std::sqrt(determinant - half_trace * half_trace), half_trace);
}

}  // namespace openclose::analytical
