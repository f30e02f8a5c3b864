// Critical time step of the explicit method: the longest for which central difference is stable in linear vibration.
//
// With stiffness K, dashpots C (whose velocity is half a step old) and mass M a step h is stable while h^2 K + 2 h C < 4 M, which without dashpots is
// h < 2/w_max. Two numbers that bound the eigenvalues of M^-1 K and M^-1 C from above, a and b, give the step a h^2 + 2 b h = 4.
//
// They come from a bound of Gershgorin's kind, by blocks: what a contact stores, k (x_1 + x_2)^2/2 with x_i the parts of its two blocks in the closure,
// is at most the sum of k (1 + m_1/m_2) x_1^2/2 and k (1 + m_2/m_1) x_2^2/2, so that no eigenvalue exceeds the largest one of a single block with its
// contacts stiffened so (not at all against a fixed block). The factor makes it exact for two blocks on one spring, and for blocks on fixed ones.
// Power iteration was the other choice: it comes nearer (the bound's step is 5-15 % below 2/w_max in jointed slopes), but from the unsafe side, and at
// tens of passes over the contacts, which the run pays again whenever they change; the bound takes one.
#pragma once

#include "openclose/integrator/enforcement.h"

namespace openclose {

/// Whether a contact is closed or closes when its blocks approach by `approach` [m].
inline bool may_close(const ContactStrength& strength, double normal_stiffness, double gap, double approach) {
  return gap <= strength.tension / normal_stiffness + approach;
}

/// [s] Of all contacts that are closed or close when their blocks approach by `approach` [m], and of the supports; infinite without any. Sliding
/// counts as sticking.
template <int N>
double critical_step(const StepProblem<N>& problem, double approach);

}  // namespace openclose
