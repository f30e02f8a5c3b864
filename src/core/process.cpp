#include "openclose/core/process.h"

#include <chrono>
#include <fstream>
#include <string>

#include "openclose/core/parallel.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace openclose {
namespace {

const auto program_start = std::chrono::steady_clock::now();

}  // namespace

// Of the threads one by one: the clock of the process only ticks every few milliseconds where a limit on its CPU time is set.
double process_cpu_time() {
  return thread_cpu_time() + helpers_cpu_time();
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - program_start).count();
}

// Not getrusage: its maximum goes back to before the program was loaded and has the memory of who started it.
long peak_memory() {
  constexpr long bytes_per_unit = 1024;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long value = 0;
    if (word == "VmHWM:" && status >> value) return bytes_per_unit * value;
  }
  return 0;
}

void return_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace openclose
