#include "openclose/analytical/coulomb_oscillator.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace openclose::analytical {

namespace {

void require_valid(const CoulombOscillator& oscillator) {
  if (!(oscillator.mass > 0 && oscillator.stiffness > 0 && oscillator.friction > 0))
    throw std::invalid_argument("mass, stiffness and friction must be positive");
}

}  // namespace

CoulombRest coulomb_oscillator(const CoulombOscillator& oscillator) {
  require_valid(oscillator);
  const double shift = oscillator.friction / oscillator.stiffness;
  const double start = std::abs(oscillator.start);
  // Sticks at the first amplitude, start - 2 n shift, of at most the shift; one below zero is on the other side.
  const int half_cycles = start <= shift ? 0 : static_cast<int>(std::ceil((start / shift - 1) / 2));
  const double amplitude = start - 2 * half_cycles * shift;
  const double side = (half_cycles % 2 == 0 ? 1 : -1) * (oscillator.start < 0 ? -1 : 1);
  return {side * amplitude, half_cycles * std::numbers::pi / std::sqrt(oscillator.stiffness / oscillator.mass), half_cycles};
}

double driven_amplitude(const CoulombOscillator& oscillator, double force, double frequency) {
  require_valid(oscillator);
  const double ratio = frequency / std::sqrt(oscillator.stiffness / oscillator.mass), angle = std::numbers::pi / ratio;
  const double v = 1 / (1 - ratio * ratio), u = std::sin(angle) / (ratio * (1 + std::cos(angle)));
  const double square = v * v - std::pow(oscillator.friction / force * u, 2);
  if (!(square > 0)) throw std::domain_error("friction stops the vibration");
  return force / oscillator.stiffness * std::sqrt(square);
}

}  // namespace openclose::analytical
