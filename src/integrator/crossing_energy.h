// What a contact without tensile strength owes to central difference where it closes and opens within a step.
//
// One mass m on a spring k that only pushes, steps of h, gaps g_n (closed below 0). The force N_n = -k g_n changes the kinetic energy by
// N_n (g_n+1 - g_n-1)/2; summed by parts a closure does the work sum (N_n + N_n+1)/2 (g_n+1 - g_n). Between two closed positions this is what
// the spring stores, exactly. What is left comes from the two steps in which the contact changes:
//   - closing, from g_0 >= 0 to g_1 < 0: k g_0 g_1/2 <= 0, lost;
//   - opening, from g_n < 0 to g_n+1 >= 0: -k g_n g_n+1/2 >= 0, gained.
// Either is at most a quarter of (h w)^2, w^2 = k/m, of the kinetic energy. With e the sum of both the speed v returns as v sqrt(1 + 2 e/(m v^2)),
// between 1/r and r times what it was, r = 1/sqrt(1 - (h w/2)^2): 2.3 at h w = 1.8, 1.15 at h w = 1. The time of impact decides about the sign. Only
// where half a period is a whole number of steps, h w = 2 sin(pi/2n), does every bounce return the speed: h w = 1 (n = 3) is the longest but one, and
// that is half the critical step. A contact softer than that one, or a mode slower, has any h w below 1 and may gain 23 % of its energy.
//
// So what the opening shows is settled in the step after it: a force f, pulling for e > 0, with the work f (g_n+2 - g_n)/2 = e. With D = g_n+1 - g_n
// the mass moves by g_n+2 - g_n = 2 D - f h^2/m, and a step of p times the critical one has h^2/m <= 4 p^2/k, so that f with f (D - 2 p^2 f/k) = e
// takes at least e, and gives back no more than -e. No bounce gains energy at any step below the critical one; it loses less than 0.3 % in the mean
// at p = 0.5 and 3.2 % in the worst case, and nothing at h w = 1.
#pragma once

#include <algorithm>
#include <cmath>

namespace openclose {

// The shear spring is let go at the opening, too. Stretched by u with the force T = -k u it does half of T s in a slip s past its rest, which is more
// than it stored where -s u > u^2: the friction of that step is negative. What is gained so, at most k s^2/8, a shear force takes in the same way.
//
// A step that is shorter than the one before, h_1 < h_0, gains N a (h_0^2 - h_1^2)/8 at a contact with the force N, a the acceleration by which it
// opens: with a force at its largest as much as an opening. A longer one loses as much. This is added to what the contact owes.
//
// Until then it belongs to what the contact stores: a ledger that left it out would see energy go at a closing and come at an opening. The kinetic
// energy that goes with all this is v_n-1/2 m v_n+1/2/2, see CentralDifference::kinetic_ahead().
/// [J] k g_0 g_1/2 of a contact that closes, at most 0; 0 where it was found closed.
inline double closing_energy(double stiffness, double gap_before, double gap) {
  return 0.5 * stiffness * std::max(gap_before, 0.0) * gap;
}

/// [N] Normal force that settles `energy` [J] in the step after the opening, negative where it pulls.
/// \param way    [m] D
/// \param share  [-] p^2
inline double settling_force(double stiffness, double energy, double way, double share) {
  // A closing at another speed may have lost more than what an opening at this one can give back.
  const double e = std::max(energy, -0.125 * stiffness * (way * way));
  const double root = std::sqrt(std::max(0.0, way * way - 8.0 * share * e / stiffness));
  return way > 0.0 ? -2.0 * e / (way + root) : 0.0;
}

/// What an opening contact owes, and the forces that settle it.
struct Opening {
  double normal, shear;  ///< [N]
  double energy;         ///< [J] gained and not settled yet
};

/// Half of the forces' work is counted from the opening on, see kinetic_ahead().
/// \param energy          [J] what the opening has gained, and the closing before lost
/// \param gap_change      [m] of the step, as is slip
/// \param stretch, shear  [m], [N] of the shear spring before it
inline Opening settled(double energy, double normal_stiffness, double gap_change, double shear_stiffness, double slip, double stretch, double shear,
                       double share) {
  const double rubbed = -0.5 * shear * (slip + stretch), gained = std::max(0.0, -rubbed);
  const double normal_force = settling_force(normal_stiffness, energy, gap_change, share);
  const double shear_force = std::copysign(1.0, slip) * settling_force(shear_stiffness, gained, std::abs(slip), share);
  return {normal_force, shear_force, energy + gained + 0.5 * (normal_force * gap_change + shear_force * slip)};
}

}  // namespace openclose
