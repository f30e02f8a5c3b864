// What this process has used so far.
#pragma once

#include <cstddef>

namespace openclose {

/// [s] CPU time since the process began, of the thread that asks and of the helpers of for_each_part().
double process_cpu_time();
/// [s] Time since the program was started.
double wall_time();
/// [bytes] Largest resident memory since the program was loaded; 0 where /proc does not tell.
long peak_memory();
/// [bytes] Resident memory when the program began: its code and libraries, as far as they were read.
long memory_of_program();
/// [bytes] What this process can still have: of the machine, of its control group and below the limit on its addresses (ulimit -v); the largest
/// number where none of them is known.
std::size_t available_memory();
/// From now on large pieces of memory go back to the system as soon as they are freed, instead of lying in holes that fit nothing else; to be called
/// once, before much has been allocated. Nothing where the C library has no way to.
void return_large_memory();
/// Has the system provide memory [bytes] for what is allocated next in small pieces at once, which takes half of the time of page by page when they
/// are first touched; after return_large_memory(). False where the C library or the system has no way to.
bool provide_memory(std::size_t bytes);
/// Gives what has been freed, and lies between memory in use, back to the system. Nothing where the C library has no way to.
void return_freed_memory();

/// From now on a write beyond the limit on the size of files (RLIMIT_FSIZE) fails, as on a full disk, instead of ending the process.
void fail_beyond_size_limit();

}  // namespace openclose
