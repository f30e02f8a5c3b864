#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <memory>
#include <vector>

#include "openclose/core/process.h"
#include "support/catch.h"
#include "support/sanitized.h"

using namespace openclose;

namespace {

/// [bytes] Resident memory now; 0 where /proc does not tell.
[[maybe_unused]] long resident_memory() {
  std::ifstream sizes("/proc/self/statm");
  long whole = 0, resident = 0;
  return sizes >> whole >> resident ? resident * sysconf(_SC_PAGESIZE) : 0;
}

}  // namespace

#if defined(__GLIBC__) && defined(MADV_POPULATE_WRITE) && !defined(OPENCLOSE_ADDRESS_SANITIZER)
namespace {

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

/// Whether the kernel gives pages before they are touched. Old ones refuse to; emulators of a processor say that they do, and do not.
bool kernel_populates_pages() {
  constexpr std::size_t pages = 64;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const memory = mmap(nullptr, pages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  REQUIRE(memory != MAP_FAILED);
  const bool accepted = madvise(memory, pages * page, MADV_POPULATE_WRITE) == 0;
  const long before = page_faults();
  for (std::size_t i = 0; i < pages; ++i) static_cast<volatile char*>(memory)[i * page] = 1;
  const long touched = page_faults() - before;
  munmap(memory, pages * page);
  return accepted && touched < static_cast<long>(pages) / 2;
}

}  // namespace
#endif

TEST_CASE("the clock of the process is fine also under a limit of CPU time", "[core][process]") {
  // With a limit the kernel's clock of the process moves by ticks of milliseconds.
  rlimit limit{};
  getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = 3600;
  REQUIRE(setrlimit(RLIMIT_CPU, &limit) == 0);
  double finest = 1.0, last = process_cpu_time();
  const double begin = last;
  while (last - begin < 0.02) {
    const double now = process_cpu_time();
    if (now > last) finest = std::min(finest, now - last);
    last = now;
  }
  CHECK(finest < 5e-4);
}

TEST_CASE("CPU time is in seconds", "[core][process]") {
  // Each clock is read within what the other one spans, so that no other process can come between; ticks of the other clock may be 10 ms.
  const auto other = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  constexpr double tick = 0.01;
  const double outer = process_cpu_time(), outer_other = other(), inner = process_cpu_time();
  while (other() - outer_other < 0.1) continue;
  const double inner_end = process_cpu_time(), spent_by_other = other() - outer_other, spent = process_cpu_time() - outer;
  CHECK(spent >= spent_by_other - tick);
  CHECK(inner_end - inner <= spent_by_other + tick);
}

TEST_CASE("peak memory counts what was there and is gone", "[core][process]") {
  const long before = peak_memory();
  if (before == 0) return;  // no /proc here
  constexpr std::size_t bytes = 64u << 20;
  {
    const std::vector<char> block(bytes, 1);
    CHECK(std::count(block.begin(), block.end(), 1) == static_cast<long>(bytes));
  }
  CHECK(peak_memory() - before > static_cast<long>(bytes) * 9 / 10);
  CHECK(peak_memory() - before < static_cast<long>(bytes) * 12 / 10);
#ifndef OPENCLOSE_ADDRESS_SANITIZER  // whose allocator keeps what is freed
  CHECK(resident_memory() < peak_memory() - static_cast<long>(bytes) / 2);
#endif
  CHECK(memory_of_program() > 0);
  CHECK(memory_of_program() <= before);
}

#if defined(__GLIBC__) && !defined(OPENCLOSE_ADDRESS_SANITIZER)
#ifdef MADV_POPULATE_WRITE
TEST_CASE("memory that was provided at once is there when it is touched", "[core][process]") {
  if (!kernel_populates_pages()) return;
  constexpr std::size_t bytes = 8u << 20, piece = 100u << 10;
  return_large_memory();
  const long before = resident_memory();
  REQUIRE(provide_memory(bytes));
  const long faults_before = page_faults();
  std::vector<std::unique_ptr<std::vector<char>>> pieces;
  for (std::size_t got = 0; got < bytes; got += piece) pieces.push_back(std::make_unique<std::vector<char>>(piece, 1));
  // Without, one of the 2000 pages each; the last piece goes beyond what was provided.
  CHECK(page_faults() - faults_before < 100);
  if (before > 0) CHECK(resident_memory() - before < static_cast<long>(bytes) * 12 / 10);
}
#endif

TEST_CASE("memory that was freed between what is in use goes back", "[core][process]") {
  if (resident_memory() == 0) return;  // no /proc here
  // Small enough to come from the heap, and every tenth stays, so that the heap cannot shrink.
  constexpr std::size_t bytes = 64u << 10, count = 500, kept = 10;
  std::vector<std::unique_ptr<std::vector<char>>> pieces;
  for (std::size_t i = 0; i < count; ++i) pieces.push_back(std::make_unique<std::vector<char>>(bytes, 1));
  for (std::size_t i = 0; i < count; ++i) {
    if (i % kept != kept - 1) pieces[i].reset();
  }
  const long before = resident_memory();
  return_freed_memory();
  CHECK(before - resident_memory() > static_cast<long>(bytes * count) / 2);
  CHECK(std::count(pieces[kept - 1]->begin(), pieces[kept - 1]->end(), 1) == static_cast<long>(bytes));
}

TEST_CASE("large memory goes back as it is freed, also among what is in use", "[core][process]") {
  if (resident_memory() == 0) return;  // no /proc here
  return_large_memory();
  constexpr std::size_t bytes = 2u << 20, count = 20;
  { const std::vector<char> once(16u << 20, 1); }  // by which the library would learn to keep pieces of up to this size
  std::vector<std::unique_ptr<std::vector<char>>> pieces;
  for (std::size_t i = 0; i < count; ++i) pieces.push_back(std::make_unique<std::vector<char>>(bytes, 1));
  const long before = resident_memory();
  for (std::size_t i = 0; i < count; i += 2) pieces[i].reset();
  CHECK(before - resident_memory() > static_cast<long>(bytes * count) * 4 / 10);
}
#endif
