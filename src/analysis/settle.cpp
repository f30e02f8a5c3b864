#include "openclose/analysis/settle.h"

#include <algorithm>
#include <cmath>

namespace openclose {
namespace {

constexpr double growth = 10.0;         ///< [-] of the pseudo-time step after a success
constexpr double largest_growth = 1e3;  ///< [-] of the first step in all: beyond, the inertia term no longer holds sliding blocks in place
constexpr double cut = 0.3;             ///< [-] after a failure

}  // namespace

template <int N>
SettleResult settle(Simulation<N>& simulation) {
  if (simulation.is_explicit()) return settle_explicitly(simulation);
  const SettleInput& input = simulation.scene().settle;
  const auto& system = simulation.system();
  std::vector<typename Motion<N>::Unknowns> start;
  for (int b = 0; b < system.block_count(); ++b) start.push_back(system.displacement(b));
  simulation.system().stop();

  SettleResult result;
  double dt = input.first_dt;
  while (result.steps < input.max_steps) {
    const StepResult step = simulation.step(dt, true);
    if (!step.accepted) {
      dt *= cut;
      result.criterion = step.reason;
      if (dt < simulation.scene().step.smallest_fraction * input.first_dt) return result;
      continue;
    }
    ++result.steps;
    result.unbalanced_fraction = step.unbalanced_force / simulation.force_scale();
    for (int b : system.free_blocks()) {
      result.displacement = std::max(result.displacement, Motion<N>::displacement_bound(system.displacement(b) - start[b], system.block(b).radius));
    }
    // Forces that were in balance with cohesion that is gone now are to be balanced anew.
    if (result.unbalanced_fraction <= input.unbalanced_fraction && !step.lost_strength) {
      result.settled = true;
      result.criterion = "unbalanced force";
      return result;
    }
    if (result.displacement > input.failure_displacement) {
      result.criterion = "displacement";
      return result;
    }
    dt = std::min(dt * growth, largest_growth * input.first_dt);
  }
  result.criterion = "steps";
  return result;
}

template SettleResult settle<3>(Simulation<3>&);

}  // namespace openclose
