#include "openclose/core/process.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "openclose/core/parallel.h"

#ifdef __GLIBC__
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace openclose {
namespace {

/// [bytes] Not getrusage, whose maximum goes back to before the program was loaded and has the memory of who started it.
long status_of_process(const std::string& key) {
  constexpr long bytes_per_unit = 1024;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long value = 0;
    if (word == key && status >> value) return bytes_per_unit * value;
  }
  return 0;
}

/// [bytes] The number that follows the key in a file of the system, or the first one without a key; none where there is no such file or number.
std::optional<std::size_t> number_in(const char* path, std::string_view key, std::size_t unit) {
  std::ifstream file(path);
  std::string word;
  while (!key.empty() && file >> word && word != key) {
  }
  std::size_t value = 0;
  if (!(file >> value) || value > std::numeric_limits<std::size_t>::max() / unit) return std::nullopt;
  return unit * value;
}

std::size_t left_of(std::size_t limit, std::size_t used) {
  return limit > used ? limit - used : 0;
}

/// Far below what glibc takes for large, with or without return_large_memory().
[[maybe_unused]] constexpr std::size_t piece_of_heap_bytes = 64u << 10;

const auto program_start = std::chrono::steady_clock::now();
const long memory_at_start = status_of_process("VmRSS:");

}  // namespace

// Of the threads one by one: the clock of the process only ticks every few milliseconds where a limit on its CPU time is set.
double process_cpu_time() {
  return thread_cpu_time() + helpers_cpu_time();
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - program_start).count();
}

long peak_memory() {
  return status_of_process("VmHWM:");
}

long memory_of_program() {
  return memory_at_start;
}

std::size_t available_memory() {
  constexpr std::size_t kilobyte = 1024;
  std::size_t least = number_in("/proc/meminfo", "MemAvailable:", kilobyte).value_or(std::numeric_limits<std::size_t>::max());
  const auto group_limit = number_in("/sys/fs/cgroup/memory.max", "", 1), group_used = number_in("/sys/fs/cgroup/memory.current", "", 1);
  if (group_limit && group_used) least = std::min(least, left_of(*group_limit, *group_used));
#ifdef __GLIBC__
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY)
    least = std::min(least, left_of(addresses.rlim_cur, number_in("/proc/self/status", "VmSize:", kilobyte).value_or(0)));
#endif
  return least;
}

void return_large_memory() {
#ifdef __GLIBC__
  // Pieces of their own cost a page fault every 4 kB each time that they are asked for. In a slope of 4,887 blocks they are a megabyte from 200 bytes
  // a block on, and vectors of its equations are none; with this threshold, half of it or an eighth it peaks at 11.9 kB a block, with four times as
  // much at 12.3, left to the library at 12.7, which takes each freed piece for a reason to keep the next ones of its size.
  constexpr int large_bytes = 1 << 20;
  // The end of the heap comes and goes with every iteration.
  constexpr int kept_end_bytes = 16 << 20;
  mallopt(M_MMAP_THRESHOLD, large_bytes);
  mallopt(M_TRIM_THRESHOLD, kept_end_bytes);
#endif
}

bool provide_memory([[maybe_unused]] std::size_t bytes) {
#if defined(__GLIBC__) && defined(MADV_POPULATE_WRITE)
  // Of the heap's end, where it stays when it is given back: larger pieces would not.
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::vector<std::unique_ptr<char[]>> pieces;
  bool provided = true;
  for (std::size_t got = 0; got < bytes && provided; got += piece_of_heap_bytes) {
    pieces.emplace_back(new char[piece_of_heap_bytes]);
    const auto address = reinterpret_cast<std::uintptr_t>(pieces.back().get());
    const std::uintptr_t first = (address + page - 1) / page * page, end = (address + piece_of_heap_bytes) / page * page;
    provided = madvise(reinterpret_cast<void*>(first), end - first, MADV_POPULATE_WRITE) == 0;
  }
  return provided;
#else
  return false;
#endif
}

void return_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

void fail_beyond_size_limit() {
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace openclose
