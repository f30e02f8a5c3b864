#include "openclose/core/parallel.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace openclose {
namespace {

std::array<std::atomic<long>, kinds_of_shared_work> shared{};

}  // namespace

void for_each_part(SharedWork kind, int threads, int parts, const std::function<void(int)>& work) {
  const int team = std::min(threads, parts);
  if (team <= 1) {
    for (int i = 0; i < parts; ++i) work(i);
    return;
  }
  ++shared[static_cast<std::size_t>(kind)];
#pragma omp parallel for num_threads(team) schedule(dynamic, 1)
  for (int i = 0; i < parts; ++i) work(i);
}

long times_shared(SharedWork kind) {
  return shared[static_cast<std::size_t>(kind)];
}

bool has_used_threads() {
  return std::any_of(shared.begin(), shared.end(), [](const std::atomic<long>& times) { return times > 0; });
}

}  // namespace openclose
