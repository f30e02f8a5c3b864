// Products of blocks of three by three in single precision, packed without gaps, with vectors in which each block row is one register. For source
// files that are compiled without the warning about how vectors are passed (-Wno-psabi): all of this is inlined. Compiled for wide registers it takes
// one of them for eight of the nine entries; the results are the same to the last bit.
#pragma once

#include <cstdint>

#include "openclose/core/packs.h"

namespace openclose::packed {

typedef float LooseFour __attribute__((vector_size(4 * sizeof(float)), aligned(sizeof(float)), may_alias));
typedef float Eight __attribute__((vector_size(8 * sizeof(float)), aligned(8 * sizeof(float))));
typedef std::int16_t EightWholeNumbers __attribute__((vector_size(8 * sizeof(std::int16_t)), aligned(sizeof(std::int16_t)), may_alias));

OPENCLOSE_KERNEL FloatLanes four(const float* numbers) {
  return *reinterpret_cast<const LooseFour*>(numbers);
}
OPENCLOSE_KERNEL Eight eight(const std::int16_t* numbers) {
  typedef int EightIntegers __attribute__((vector_size(8 * sizeof(int)), aligned(8 * sizeof(int))));
  return __builtin_convertvector(__builtin_convertvector(*reinterpret_cast<const EightWholeNumbers*>(numbers), EightIntegers), Eight);
}
OPENCLOSE_KERNEL Lanes widened(FloatLanes numbers) {
  return __builtin_convertvector(numbers, Lanes);
}
OPENCLOSE_KERNEL void store(float* to, FloatLanes numbers) {
  *reinterpret_cast<LooseFour*>(to) = numbers;
}

/// The blocks of a row times their parts of a vector, added up in single precision.
class RowProduct {
 public:
  /// \param entries  of the block, column by column, and the last one
  OPENCLOSE_KERNEL void add(Eight entries, float last, FloatLanes x) {
    sums_ += entries * __builtin_shufflevector(x, x, 0, 0, 0, 1, 1, 1, 2, 2);
    last_ += last * x[2];
  }
  /// The fourth is zero.
  OPENCLOSE_KERNEL FloatLanes sum() const {
    const Eight zero{};
    const FloatLanes last{0.0f, 0.0f, last_, 0.0f};
    return (__builtin_shufflevector(sums_, zero, 0, 1, 2, 8) + __builtin_shufflevector(sums_, zero, 3, 4, 5, 8)) +
           (__builtin_shufflevector(sums_, zero, 6, 7, 8, 8) + last);
  }

 private:
  Eight sums_{};
  float last_ = 0.0f;
};

}  // namespace openclose::packed
