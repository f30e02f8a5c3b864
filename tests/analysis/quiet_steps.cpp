// A program of its own, because it counts every allocation: steps of the explicit loop between two detections search nothing and allocate nothing.
#include <cstdio>
#include <cstdlib>
#include <new>

#include "openclose/analysis/run.h"
#include "support/scenes.h"

namespace {
long allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto to = static_cast<std::size_t>(alignment);
  if (void* memory = std::aligned_alloc(to, (size + to - 1) / to * to)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

int main() {
  using namespace openclose;
  Scene scene = test::column_of_blocks(6);
  scene.method.contact = "dem";
  scene.joints[0].damping_ratio = 0.1;
  scene.blocks[6].velocity = {1e-3, 0.0};
  Simulation simulation(scene);
  bool good = settle(simulation).settled;
  simulation.restore_velocities();
  simulation.restart_clock();
  good = simulation.advance(scene.step.dt) && good;
  const DetectionCounters before = simulation.state().detector.counters();
  const long loads = simulation.state().counters.loads, steps = simulation.state().counters.steps, start = allocations;
  for (int i = 0; i < 20; ++i) good = simulation.advance(scene.step.dt) && good;
  const long allocated = allocations - start, searched = simulation.state().detector.counters().searches - before.searches;
  const long detected = simulation.state().detector.counters().narrow_phases - before.narrow_phases,
             loaded = simulation.state().counters.loads - loads;
  const long taken = simulation.state().counters.steps - steps;
  std::printf("%ld steps: %ld allocations, %ld searches, %ld narrow phases, %ld loads\n", taken, allocated, searched, detected, loaded);
  good = good && taken >= 20 && allocated == 0 && searched == 0 && detected == 0 && loaded == 0;
  // The counter counts: a step that moves the list on does allocate.
  simulation.positions_changed();
  good = simulation.advance(scene.step.dt) && good && allocations > start;
  return good ? 0 : 1;
}
