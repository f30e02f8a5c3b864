// A mass on a spring with Coulomb friction (cases B10 and B11), free and driven. Free, released at rest: between two turns the friction is constant
// and shifts the middle of the swing by mu N/k against the motion, so that each half cycle takes pi/w and loses 2 mu N/k of the amplitude. It rests
// at the first turn at which the spring no longer overcomes friction.
#pragma once

namespace openclose::analytical {

struct CoulombOscillator {
  double mass = 0;       // [kg]
  double stiffness = 0;  // k [N/m]
  double friction = 0;   // mu N [N]
  double start = 0;      // [m] from the slack spring
};

struct CoulombRest {
  double place = 0;     // [m] from the slack spring, positive on the side of the start
  double time = 0;      // [s]
  int half_cycles = 0;  // until then
};

/// \throws std::invalid_argument unless mass, stiffness and friction are positive
CoulombRest coulomb_oscillator(const CoulombOscillator& oscillator);

/// Den Hartog (1931): amplitude [m] of the steady vibration under a force P sin(w t), where it never stops. With b = w/sqrt(k/m):
///   (P/k) sqrt(V^2 - (mu N/P)^2 U^2),  V = 1/(1 - b^2),  U = sin(pi/b)/(b (1 + cos(pi/b))).
/// The start of the oscillator is not read. \param force P [N]  \param frequency w [rad/s]
/// \throws std::domain_error where friction is so large that the formula has no real value
double driven_amplitude(const CoulombOscillator& oscillator, double force, double frequency);

}  // namespace openclose::analytical
