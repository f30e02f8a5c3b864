#include "openclose/limit_analysis/failing_blocks.h"

#include <algorithm>
#include <cmath>

namespace openclose::limit_analysis {
namespace {

/// Relative to a vertex, so that far from the origin no digits are lost.
double area_of(const std::vector<Point>& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point p = outline[i] - outline.front(), q = outline[(i + 1) % outline.size()] - outline.front();
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return std::abs(twice) / 2;
}

}  // namespace

FailingBlocks failing_blocks(const Problem& problem, const std::vector<std::vector<Point>>& outlines, const Mechanism& mechanism) {
  std::vector<double> speeds;
  for (std::size_t b = 0; b < outlines.size(); ++b) {
    double fastest = 0;
    for (const Point& vertex : outlines[b]) fastest = std::max(fastest, velocity_at(problem.blocks[b], mechanism[b], vertex).norm());
    speeds.push_back(fastest);
  }
  FailingBlocks result;
  const double fastest = speeds.empty() ? 0 : *std::max_element(speeds.begin(), speeds.end());
  for (std::size_t b = 0; b < outlines.size(); ++b) {
    if (!(speeds[b] > slow * fastest)) continue;
    if (result.blocks.empty()) result.low = result.high = outlines[b].front();
    result.blocks.push_back(static_cast<int>(b));
    result.area += area_of(outlines[b]);
    for (const Point& vertex : outlines[b]) {
      result.low = result.low.cwiseMin(vertex);
      result.high = result.high.cwiseMax(vertex);
    }
  }
  return result;
}

}  // namespace openclose::limit_analysis
