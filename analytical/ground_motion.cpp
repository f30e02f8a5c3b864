#include "openclose/analytical/ground_motion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

namespace openclose::analytical {
namespace {

constexpr double pi = std::numbers::pi;

/// Park and Miller's minimal standard generator, with its later multiplier; the same everywhere.
class Uniform {
 public:
  explicit Uniform(unsigned seed) : state_(seed) {
    if (seed == 0 || seed >= modulus) throw std::invalid_argument("the seed must be in [1, 2^31 - 2]");
  }
  /// In (0, 1).
  double operator()() {
    state_ = 48271 * state_ % modulus;
    return static_cast<double>(state_) / modulus;
  }

 private:
  static constexpr std::uint64_t modulus = 2147483647;
  std::uint64_t state_;
};

std::array<double, 2> at_rest(double) {
  return {0, 0};
}

}  // namespace

GroundMotion rectangular_pulse(double acceleration, double duration) {
  return {{0, duration, [acceleration](double) { return std::array<double, 2>{acceleration, 0}; }}};
}

GroundMotion half_sine_pulse(double peak, double duration) {
  return {{0, duration, [=](double t) { return std::array<double, 2>{peak * std::sin(pi * t / duration), 0}; }}};
}

GroundMotion harmonic_motion(double amplitude, double frequency, double end) {
  return {{0, end, [amplitude, frequency](double t) { return std::array<double, 2>{amplitude * std::sin(2 * pi * frequency * t), 0}; }}};
}

GroundMotion record_motion(const std::vector<double>& times, const std::vector<double>& horizontal, const std::vector<double>& vertical) {
  if (times.size() != horizontal.size() || times.size() != vertical.size()) throw std::invalid_argument("as many times as values");
  GroundMotion motion;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double from = times[i - 1], span = times[i] - from;
    if (!(span > 0)) throw std::invalid_argument("the times must increase");
    const std::array<double, 2> a = {horizontal[i - 1], vertical[i - 1]}, b = {horizontal[i], vertical[i]};
    motion.push_back({from, times[i], [=](double t) {
                        const double part = (t - from) / span;
                        return std::array<double, 2>{a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])};
                      }});
  }
  return motion;
}

GroundMotion without_gaps(GroundMotion motion, double end) {
  GroundMotion whole;
  double now = 0;
  for (GroundPiece& piece : motion) {
    if (piece.from > now) whole.push_back({now, piece.from, at_rest});
    now = piece.to;
    whole.push_back(std::move(piece));
  }
  if (end > now) whole.push_back({now, end, at_rest});
  return whole;
}

std::vector<double> synthetic_record(unsigned seed, double peak, double duration, double dt) {
  constexpr int waves = 20;
  constexpr double lowest = 0.5, highest = 10;
  Uniform random(seed);
  std::array<double, waves> frequency, phase, amplitude;
  for (int i = 0; i < waves; ++i) {
    frequency[i] = lowest * std::pow(highest / lowest, (i + random()) / waves);
    phase[i] = 2 * pi * random();
    amplitude[i] = 0.5 + 0.5 * random();
  }
  std::vector<double> record;
  double largest = 0;
  const double rise = duration / 5;
  for (long k = 0; k <= std::lround(duration / dt); ++k) {
    const double t = dt * static_cast<double>(k);
    double sum = 0;
    for (int i = 0; i < waves; ++i) sum += amplitude[i] * std::sin(2 * pi * frequency[i] * t + phase[i]);
    const double taper = std::clamp(10 * (1 - t / duration), 0.0, 1.0);
    record.push_back(sum * taper * t / rise * std::exp(1 - t / rise));
    largest = std::max(largest, std::abs(record.back()));
  }
  for (double& a : record) a *= peak / largest;
  return record;
}

}  // namespace openclose::analytical
