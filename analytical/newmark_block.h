// Newmark's sliding block (cases C1 to C3): a rigid block on a plane that is shaken, Coulomb friction, no rocking.
//
// Frame of block_on_plane.h, which moves with the ground; the plane falls to the right. With ground acceleration (a_h, a_v), to the right and
// upwards,
//   driving     s = (g + a_v) sin alpha - a_h cos alpha     [m/s2, downhill]
//   normal      n = (g + a_v) cos alpha + a_h sin alpha     [m/s2, > 0: the block stays on the plane]
//   slip in direction d (+1 downhill): x'' = s - d mu n until x' = 0;  stick while |s| <= mu n.
#pragma once

#include <vector>

#include "openclose/analytical/block_on_plane.h"
#include "openclose/analytical/ground_motion.h"

namespace openclose::analytical {

/// Level plane, ground acceleration `pulse` [m/s2] for a duration T, friction N g = g tan phi < pulse: the block reaches V = pulse T against an
/// observer at rest with the ground's last velocity and has slid d = V^2/(2 g N) (1 - N g/pulse) when it stops at t = T pulse/(N g).
struct PulseSlip {
  double distance;   // [m]
  double stop_time;  // [s] from the start of the pulse
};
/// slope_angle must be 0. \throws std::domain_error on a slope or if the pulse does not exceed friction
PulseSlip pulse_slip(const BlockOnPlane& block, double pulse, double duration);

/// Goodman & Seed (1966): downhill inertia A sin(w t) on an incline with phi > alpha, x'' = kappa (A sin w t - k_y), kappa = cos(phi - alpha)/cos
/// phi, k_y = g tan(phi - alpha). Slip starts at sin(w t1) = k_y/A and ends at t2, where the integral of A sin w t - k_y from t1 vanishes; d = kappa
/// {(A/w) [(t2 - t1) cos w t1 - (sin w t2 - sin w t1)/w] - k_y (t2 - t1)^2/2}.
struct CycleSlip {
  double yield;     // k_y [m/s2]
  double start;     // t1 [s] from the beginning of each cycle
  double end;       // t2 [s], before the next cycle's start
  double distance;  // [m] downhill in each cycle
};
/// \param amplitude A > k_y [m/s2], small enough that the block never slips uphill (A < g tan(phi + alpha))  \param frequency [Hz]
/// \throws std::domain_error outside that range, or if the slip of a cycle runs into the next
CycleSlip harmonic_slip(const BlockOnPlane& block, double amplitude, double frequency);

struct NewmarkState {
  double time = 0;      // [s]
  double x = 0;         // [m] downhill, against the ground
  double velocity = 0;  // [m/s]
};

struct NewmarkEvent {
  double time;    // [s]
  int direction;  // of the slip that begins; 0: it sticks
};

struct NewmarkMotion {
  std::vector<NewmarkState> states;  // at the times asked for
  std::vector<NewmarkEvent> events;
};

/// Between the block and the ground, along the plane.
struct GroundSpring {
  double stiffness_over_mass = 0;  // k/m [1/s2]
  double start = 0;                // [m] x from which the block is released; the spring is slack at 0
};

/// The motion from rest, by CVODE with the passages of velocity and of |s| - mu n through zero located.
/// \param times [s] ascending  \throws std::domain_error if the block lifts off
NewmarkMotion newmark_block(const BlockOnPlane& block, const GroundMotion& ground, const std::vector<double>& times,
                            double relative_tolerance = 1e-13, const GroundSpring& spring = {});

}  // namespace openclose::analytical
