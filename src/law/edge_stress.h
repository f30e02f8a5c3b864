// Bending of a joint with tensile strength. Two faces are joined at the two ends of what they have in common, and what these carry stands for
// stresses that are linear along the joint, as in a beam: with N1 and N2 at the ends of a length L, the force N1 + N2 and the moment (N1 - N2) L/2
// about the middle, so that the stress at end 1 is N/L + 6 M/L^2 = (4 N1 - 2 N2)/L. Rock cracks where that reaches its tensile strength, from the
// edge: as in flexural toppling (Aydan and Kawamoto 1992). Each end by itself bears three times the moment.
#pragma once

namespace openclose {

/// [N] The stress at an end of a joint times the length that the end stands for, compression positive.
/// \param here, there  [N] carried by the end and by the other one
inline double force_of_edge_stress(double here, double there) {
  return 2.0 * here - there;
}

}  // namespace openclose
