// The blocks that a mechanism moves.
#pragma once

#include "openclose/limit_analysis/problem.h"

namespace openclose::limit_analysis {

/// [-] of the speed of the fastest vertex: what moves more slowly is not said to fail. Velocities of a program are right to 1e-9, those of the last
/// steps of a path to a few thousandths.
inline constexpr double slow = 0.01;

struct FailingBlocks {
  std::vector<int> blocks;                          // in the order of the problem
  double area = 0;                                  // [m2]
  Point low = Point::Zero(), high = Point::Zero();  // [m] corners of the box around them
};

/// \param outlines  vertices of each block, in order either way round
FailingBlocks failing_blocks(const Problem& problem, const std::vector<std::vector<Point>>& outlines, const Mechanism& mechanism);

}  // namespace openclose::limit_analysis
