// Accelerations of the ground as smooth pieces of time, and a synthetic record.
#pragma once

#include <array>
#include <functional>
#include <vector>

namespace openclose::analytical {

/// Between two times [s]: horizontal (to the right) and vertical (upwards) acceleration [m/s2], smooth, also defined a little beyond both.
struct GroundPiece {
  double from, to;
  std::function<std::array<double, 2>(double time)> acceleration;
};

/// In order of time; zero where there is no piece.
using GroundMotion = std::vector<GroundPiece>;

/// A constant horizontal acceleration [m/s2] from time 0 for a duration [s].
GroundMotion rectangular_pulse(double acceleration, double duration);
/// Half a sine, peak sin(pi t/duration), horizontally [m/s2] from time 0 on.
GroundMotion half_sine_pulse(double peak, double duration);
/// amplitude sin(2 pi frequency t) horizontally [m/s2, Hz] from time 0 to `end` [s].
GroundMotion harmonic_motion(double amplitude, double frequency, double end);
/// Straight lines between points of a record: one list of times [s] that increase, two of accelerations [m/s2].
GroundMotion record_motion(const std::vector<double>& times, const std::vector<double>& horizontal, const std::vector<double>& vertical);
/// The same motion with nothing between its pieces: where there is none the ground is at rest, up to `end` [s].
GroundMotion without_gaps(GroundMotion motion, double end);

/// A record that looks like that of an earthquake and belongs to nobody. Twenty waves of frequencies from 0.5 to 10 Hz, each with a phase, an
/// amplitude between 1/2 and 1 and a frequency within its twentieth of the (logarithmic) range, all drawn by the generator x -> 48271 x mod (2^31 -
/// 1) from the seed; their sum under the envelope (t/t1) exp(1 - t/t1), t1 a fifth of the duration, scaled to the peak, tapered linearly to zero over
/// its last tenth. \param peak [m/s2], duration [s], dt [s] between the values, the first of which stands at time 0; seed in [1, 2^31 - 2]
std::vector<double> synthetic_record(unsigned seed, double peak, double duration, double dt);

}  // namespace openclose::analytical
