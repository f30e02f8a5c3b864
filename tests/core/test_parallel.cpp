#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "openclose/core/parallel.h"
#include "openclose/core/process.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("every part is done once, whatever the number of threads", "[core][parallel]") {
  for (int threads = 1; threads <= most_threads; ++threads) {
    for (int parts = 0; parts <= 20; ++parts) {
      std::vector<int> done(parts, 0);
      for (int call = 1; call <= 20; ++call) {
        for_each_part(SharedWork::product, threads, parts, [&](int i) { ++done[i]; });
        CHECK(std::count(done.begin(), done.end(), call) == parts);
      }
    }
  }
}

TEST_CASE("parts are done at the same time, and calls that are shared are counted", "[core][parallel]") {
  for (int threads = 1; threads <= 3; ++threads) {
    const long before = times_shared(SharedWork::product), others = times_shared(SharedWork::factorisation);
    // Each part waits for all others.
    std::atomic<int> begun = 0;
    for_each_part(SharedWork::product, threads, threads, [&](int) {
      ++begun;
      while (begun < threads) std::this_thread::yield();
    });
    CHECK(begun == threads);
    CHECK(times_shared(SharedWork::product) - before == (threads > 1 ? 1 : 0));
    CHECK(times_shared(SharedWork::factorisation) == others);
  }
}

TEST_CASE("one thread does the parts in their order", "[core][parallel]") {
  std::vector<int> order;
  for_each_part(SharedWork::product, 1, 5, [&](int i) { order.push_back(i); });
  CHECK(order == std::vector<int>{0, 1, 2, 3, 4});
}

TEST_CASE("ranges make up all rows, each once", "[core][parallel]") {
  for (const int threads : {1, 3}) {
    for (const int rows : {0, 1, 499, 500, 999, 1000, 1001, 4321}) {
      std::vector<int> done(rows, 0);
      for_each_range(SharedWork::product, threads, rows, [&](int first, int end) {
        for (int i = first; i < end; ++i) ++done[i];
      });
      CHECK(std::count(done.begin(), done.end(), 1) == rows);
    }
  }
}

TEST_CASE("CPU time counts all threads", "[core][parallel]") {
  for_each_part(SharedWork::product, 2, 2, [](int) {});
  constexpr double busy = 0.1;  // [s] of each thread
  const double begin = process_cpu_time();
  std::atomic<int> begun = 0;
  for_each_part(SharedWork::product, 2, 2, [&](int) {
    ++begun;
    while (begun < 2) std::this_thread::yield();
    for (const double from = thread_cpu_time(); thread_cpu_time() - from < busy;) continue;
  });
  // One thread alone would have spent half of it.
  CHECK(process_cpu_time() - begin > 1.5 * busy);
}
