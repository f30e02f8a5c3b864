#include "openclose/core/parallel.h"

#include <pthread.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <thread>
#include <vector>

namespace openclose {
namespace {

/// Looks for work, some tenth of a millisecond on an idle processor, before a helper sleeps: the next call mostly comes sooner, and waking takes
/// longer than most parts. Each look leaves the processor to whoever else wants it.
constexpr int looks_before_sleep = 300;
/// Of a product, about ten microseconds: more than it takes to hand them over.
constexpr int rows_of_a_part = 500;

std::array<std::atomic<long>, kinds_of_shared_work> shared{};

double time_of(clockid_t clock) {
  constexpr double nanosecond = 1e-9;
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + nanosecond * static_cast<double>(now.tv_nsec);
}

/// The caller and its helpers take one part after the other from the same pile, so that the caller never waits for a helper which has not begun.
class Team {
 public:
  ~Team() {
    ends_ = true;
    wake();
    for (std::thread& helper : helpers_) helper.join();
  }

  void share(int threads, int parts, const std::function<void(int)>& work) {
    for (int i = static_cast<int>(helpers_.size()); i < threads - 1; ++i) helpers_.emplace_back([this, i] { help(i); });
    called_ = threads - 1;
    work_ = &work;
    parts_ = parts;
    finished_ = 0;
    left_ = parts;
    wake();
    while (take_part()) {
    }
    while (finished_ < parts) std::this_thread::yield();
  }

  double cpu_time() {
    double sum = 0.0;
    for (std::thread& helper : helpers_) {
      clockid_t clock{};
      if (pthread_getcpuclockid(helper.native_handle(), &clock) == 0) sum += time_of(clock);
    }
    return sum;
  }

 private:
  /// False if none is left. What the work is may only be looked at while a part of it is taken and not finished.
  bool take_part() {
    int left = left_;
    while (left > 0 && !left_.compare_exchange_weak(left, left - 1)) {
    }
    if (left <= 0) return false;
    (*work_)(parts_ - left);
    ++finished_;
    return true;
  }

  void help(int number) {
    for (unsigned seen = calls_; !ends_;) {
      while (number < called_ && take_part()) {
      }
      for (int looks = 0; looks < looks_before_sleep && calls_ == seen; ++looks) std::this_thread::yield();
      calls_.wait(seen);
      seen = calls_;
    }
  }

  void wake() {
    ++calls_;
    calls_.notify_all();
  }

  std::vector<std::thread> helpers_;
  std::atomic<unsigned> calls_{0};
  std::atomic<bool> ends_{false};
  std::atomic<int> called_{0}, left_{0}, finished_{0};
  const std::function<void(int)>* work_ = nullptr;
  int parts_ = 0;
};

Team& team() {
  static Team helpers;
  return helpers;
}

}  // namespace

void for_each_part(SharedWork kind, int threads, int parts, const std::function<void(int)>& work) {
  if (std::min(threads, parts) <= 1) {
    for (int i = 0; i < parts; ++i) work(i);
    return;
  }
  ++shared[static_cast<std::size_t>(kind)];
  team().share(threads, parts, work);
}

void for_each_range(SharedWork kind, int threads, int rows, const std::function<void(int, int)>& work) {
  const int parts = std::max(1, rows / rows_of_a_part);
  for_each_part(kind, threads, parts, [&](int part) { work(part * rows_of_a_part, part + 1 < parts ? (part + 1) * rows_of_a_part : rows); });
}

long times_shared(SharedWork kind) {
  return shared[static_cast<std::size_t>(kind)];
}

double thread_cpu_time() {
  return time_of(CLOCK_THREAD_CPUTIME_ID);
}

double helpers_cpu_time() {
  return team().cpu_time();
}

}  // namespace openclose
