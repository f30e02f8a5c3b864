// A set of numbers from 0 on, a bit each.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "openclose/core/memory.h"

namespace openclose {

class NumberSet {
 public:
  /// Of numbers below `end`; those that are in it stay.
  void resize(std::size_t end) { words_.resize(end / bits + 1); }
  void add(int number) { words_[number / bits] |= std::uint64_t{1} << (number % bits); }
  /// Fills the list with them in ascending order; the set is empty then.
  void take(std::vector<int>& numbers) {
    numbers.clear();
    for (std::size_t k = 0; k < words_.size(); ++k) {
      for (; words_[k] != 0; words_[k] &= words_[k] - 1) numbers.push_back(static_cast<int>(bits * k) + std::countr_zero(words_[k]));
    }
  }
  std::size_t bytes() const { return bytes_of(words_); }

 private:
  static constexpr int bits = 64;  ///< of a word
  std::vector<std::uint64_t> words_;
};

}  // namespace openclose
