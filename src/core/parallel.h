// Work in parts that do not depend on each other, shared among threads.
//
// Not by OpenMP: there every thread of a team must arrive at the end of a loop, even one that the system has not let run meanwhile. On a machine with
// other work that made two threads four times as slow as one. Here a helper which comes late finds nothing left to do.
//
// Results must not depend on the number of threads: how work is divided, and the order in which the parts' results are put together, is for the
// caller to decide from the work alone.
#pragma once

#include <functional>

namespace openclose {

/// More threads than this have nothing to do: the work is divided into about as many parts.
inline constexpr int most_threads = 8;

/// What is shared, for the counters.
enum class SharedWork {
  factorisation,  ///< subtrees and rows of a factor
  substitution,   ///< of the same
  product,        ///< matrix times vector
};
inline constexpr int kinds_of_shared_work = 3;

/// Calls work(i) for i from 0 to parts - 1, on `threads` threads at a time; in this order if that is 1. The work must
/// neither throw nor call this again, and only one thread of the program may call it at a time.
void for_each_part(SharedWork kind, int threads, int parts, const std::function<void(int)>& work);
/// The same for rows of a matrix: calls work(first, end) for ranges that make up 0 to rows - 1.
void for_each_range(SharedWork kind, int threads, int rows, const std::function<void(int, int)>& work);

/// How often this process has called upon more than one thread.
long times_shared(SharedWork kind);
/// [s] CPU time of the thread that asks, and of all those that have helped it in for_each_part().
double thread_cpu_time();
double helpers_cpu_time();

}  // namespace openclose
