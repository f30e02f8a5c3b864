// Part of every program of a build with OPENCLOSE_TRAPS: a division by zero, an operation without a result (0/0, inf - inf, the root of a negative
// number, a comparison with NaN) and an overflow end the program with SIGFPE where they happen. Infinities that mean "no limit" are stored and
// compared without any of these.
#include <cfenv>

namespace {

const int traps_before_main = feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);

}  // namespace
