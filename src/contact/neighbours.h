// The blocks that may come within reach of each block.
#pragma once

#include <utility>
#include <vector>

namespace openclose {

/// A view of the pairs of blocks that a detector looks at, by block.
class Neighbours {
 public:
  /// \param start, of  the pairs of block b are of[start[b]] to before of[start[b + 1]]
  Neighbours(const std::vector<std::pair<int, int>>& pairs, const std::vector<int>& start, const std::vector<int>& of)
      : pairs_(pairs), start_(start), of_(of) {}

  template <class F>
  bool any_of(int block, F f) const {
    for (int k = start_[block]; k < start_[block + 1]; ++k) {
      const auto& [first, second] = pairs_[of_[k]];
      if (f(first == block ? second : first)) return true;
    }
    return false;
  }

 private:
  const std::vector<std::pair<int, int>>& pairs_;
  const std::vector<int>&start_, &of_;
};

}  // namespace openclose
