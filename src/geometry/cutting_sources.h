// The segments that cut a domain: its rings and the joint traces, in an order that does not depend on how they were written.
#pragma once

#include <vector>

#include "openclose/geometry/arrangement.h"
#include "openclose/geometry/block_cutting.h"

namespace openclose {

/// Numbers of the rings of the domain among the sources, which are joints from 0 up.
inline int source_of_ring(int ring) {
  return -1 - ring;
}
inline bool is_ring(int source) {
  return source < 0;
}
inline int ring_of_source(int source) {
  return -1 - source;
}

/// Every trace from its lower left end, and all of them in order.
void make_canonical(std::vector<JointTrace>& traces);

/// \param reach  [m] see CuttingLimits::end_reach
std::vector<SourceSegment> sources_of(const PolygonWithHoles& domain, const std::vector<JointTrace>& traces, double reach);

}  // namespace openclose
