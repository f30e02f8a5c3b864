// Which of many segments can meet.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "openclose/geometry/segment.h"

namespace openclose {

/// Pairs (i, j), i < j, in ascending order, of segments that may come within the margin [m] of each other. No pair that does is left out; of the
/// others only such as lie end to end.
///
/// The plane is halved at the median of the segments, across x, y or along most of them, as long as that lessens the number of pairs; so clusters of
/// short segments, long lines across everything, needles side by side at any angle and all together cost O(n log n) plus the pairs themselves.
/// None: more than `limit` pairs were compared (some of them perhaps twice).
std::optional<std::vector<std::pair<int, int>>> near_pairs(const std::vector<Segment>& segments, double margin, std::size_t limit);

}  // namespace openclose
