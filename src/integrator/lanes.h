// Four numbers at a time, for the loops over contacts. What is written with them is compiled once for every processor and once for wide registers;
// each number is computed by the same operations in the same order, so that results do not depend on the processor.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define OPENCLOSE_HAS_WIDE_REGISTERS
#endif
#define OPENCLOSE_KERNEL [[gnu::always_inline]] inline

namespace openclose {

inline constexpr int batch_size = 4;
/// One number of each of four contacts. The alignment is said in full: left to itself it depends on the instructions that a function may use.
typedef double Lanes __attribute__((vector_size(batch_size * sizeof(double)), aligned(batch_size * sizeof(double))));

inline bool has_wide_registers() {
#ifdef OPENCLOSE_HAS_WIDE_REGISTERS
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace openclose
