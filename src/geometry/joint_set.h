// Families of parallel joints.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "openclose/geometry/polygon.h"
#include "openclose/geometry/segment.h"

namespace openclose {

/// Joints k = ..., -1, 0, 1, ... of one direction, numbered along the normal, which is the direction turned by +90 degrees; joint 0 passes through
/// the origin.
///
/// Scatter is drawn from uniform distributions by a generator of its own (see uniform), for each joint by its number, so that a joint does not
/// depend on how many others there are, on the domain, or on the machine. All scatters 0: no randomness at all.
struct JointSet {
  double dip = 0.0;                    ///< [rad] from the horizontal (x-axis), counter-clockwise: positive rises to the right
  double spacing = 0.0;                ///< [m] > 0, normal to the joints
  Vec2 origin = Vec2::Zero();          ///< [m] a point on joint 0
  std::optional<double> trace_length;  ///< [m] > 0; absent: the joints run through
  double gap = 0.0;                    ///< [m] >= 0 between the traces of one joint; trace 0 begins at the foot of the origin
  double stagger = 0.0;                ///< [-] of trace length + gap by which every joint is shifted along itself against the one before
  double dip_scatter = 0.0;            ///< [rad] each joint is turned by up to this much, about the foot of the origin on it
  double spacing_scatter = 0.0;        ///< [-] in [0, 1): each spacing differs by up to this part of it
  double trace_scatter = 0.0;          ///< [-] in [0, 1): each trace length and each gap differs by up to this part of it
  std::uint64_t seed = 1;
  Polygon region;  ///< [m] the joints exist inside it only; empty: everywhere
  /// What lies between and beside the traces of a line, in the region, is part of the set, too: bridges of rock. A line without a trace has none.
  bool has_bridges = false;
};

struct SetTrace : Segment {
  bool is_bridge = false;
  bool goes_on_from = false, goes_on_to = false;  ///< another one of the same line, bridge or not, follows at this end
};

/// The unit vector at this angle [rad] from the x-axis, exact for multiples of a right angle.
Vec2 direction(double angle);

/// A number in [-1, 1) that depends on its arguments only: the upper 53 bits of SplitMix64's output function (G. Steele, D. Lea, C. Flood, Fast
/// splittable pseudorandom number generators, OOPSLA 2014) applied to the seed, then to that mixed with the joint, the kind and the number of the
/// draw in turn.
double uniform(std::uint64_t seed, std::int64_t joint, std::uint64_t kind, std::int64_t draw);

/// The traces of a set within the box around the domain; those that run through end a little outside of it. None: more than `limit` of them.
std::optional<std::vector<SetTrace>> traces(const JointSet& set, const Polygon& domain, int limit);

}  // namespace openclose
