// Packs of four numbers, for the loops over contacts and over the rows of a matrix. What is written with them is compiled once for every processor
// and once for wide registers; each number is computed by the same operations in the same order, so that results do not depend on the processor.
#pragma once

/// A part of a loop: inlined into each of its two versions.
#define OPENCLOSE_KERNEL [[gnu::always_inline]] inline

/// A plain function with such a loop: the version is chosen when the program starts. Compilers other than g++, and g++'s thread sanitizer, which is
/// not there yet when the version is chosen, make the one for every processor only.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define OPENCLOSE_FOR_WIDE_REGISTERS_TOO [[gnu::target_clones("avx2", "default")]]
#else
#define OPENCLOSE_FOR_WIDE_REGISTERS_TOO
#endif

namespace openclose {

inline constexpr int batch_size = 4;
/// One number of each of four contacts, or a row of a block and what fills it up. The alignment is said in full: left to itself it depends on the
/// instructions that a function may use.
typedef double Lanes __attribute__((vector_size(batch_size * sizeof(double)), aligned(batch_size * sizeof(double))));
/// The same in single precision; a register that every processor has.
typedef float FloatLanes __attribute__((vector_size(batch_size * sizeof(float))));

}  // namespace openclose
