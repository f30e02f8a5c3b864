// Bending of a joint with tensile strength. Two blocks are joined at some points of a line, each of which stands for a part of it, and what these
// carry stands for stresses that are linear along the line, as in a beam: with the length A of the parts that hold, their middle x_0 and their second
// moment I about it, the force N and the moment M make the stress N/A + M (x - x_0)/I. Rock cracks where that reaches its tensile strength, from the
// edge: as in flexural toppling (Aydan and Kawamoto 1992). A joint of length L that is held at its two ends with N1 and N2 has (4 N1 - 2 N2)/L at the
// first; each end by itself would bear three times the moment.
#pragma once

#include <span>

namespace openclose {

/// A part of a joint and the point at which it is held, along the joint.
struct PartOfJoint {
  double low, high;  ///< [m]
  double at;         ///< [m]
  double normal;     ///< [N] compression positive
};

/// Normal stress that is linear along a joint.
struct LinearStress {
  double mean = 0.0, middle = 0.0, slope = 0.0;                      ///< [Pa], [m], [Pa/m]
  double at(double x) const { return mean + slope * (x - middle); }  ///< [Pa] compression positive

  /// What stands for the forces of the parts; there is at least one, and none is without length.
  explicit LinearStress(std::span<const PartOfJoint> parts);
};

}  // namespace openclose
