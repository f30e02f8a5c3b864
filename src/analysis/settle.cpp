#include "openclose/analysis/settle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/core/process.h"
#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

constexpr double fastest_growth = 10.0;   ///< [-] of the pseudo-time step after a success
constexpr double growth_after_cut = 1.5;  ///< [-] the first time; squared with each further success
constexpr double largest_growth = 1e3;    ///< [-] of the first step in all: beyond, the inertia term no longer holds sliding blocks in place
constexpr double cut = 0.3;               ///< [-] after a failure
/// [-] After a step that moved too far, at once: a displacement to which the iteration has run away (1e65 m have been seen) tells nothing of the
/// step.
constexpr double deepest_cut = 1e-2;
constexpr double part_of_limit = 0.8;  ///< [-] of the largest displacement of a step, to be aimed at

/// [-] Of the unbalanced force that ends settling: what its steps may leave for themselves, so that the rest is for the inertia of the last one.
constexpr double negligible_part = 0.5;

/// What the first static step touches a block of memory that nobody has touched yet, in slopes of 482 blocks with `soft`; a fifth of its time is for
/// that, when it comes page by page.
constexpr std::size_t fresh_bytes_of_a_block = 4050;
/// Fewer blocks find what they need where the scene was read; of more the arrays are pieces of their own, which the end of the heap does not serve.
constexpr int fewest_blocks_with_fresh_memory = 200, most_blocks_in_heap = 1000;

/// What a static step may leave unbalanced, while it lives.
class Neglect {
 public:
  explicit Neglect(Simulation& simulation) : simulation_(simulation) {}
  ~Neglect() { simulation_.solved_stepper().neglect(0.0); }
  Neglect(const Neglect&) = delete;
  Neglect& operator=(const Neglect&) = delete;

  /// Before a step: the forces that it is a part of change.
  void renew() {
    simulation_.solved_stepper().neglect(negligible_part * simulation_.scene().settle.unbalanced_fraction * simulation_.state().force_scale());
  }

 private:
  Simulation& simulation_;
};

/// From rest a failing block moves with the square of the step: the factor on a step that moved so far which makes full use of the limit.
double factor_to_limit(double limit, double moved) {
  return moved > 0.0 ? std::sqrt(part_of_limit * limit / moved) : std::numeric_limits<double>::infinity();
}

}  // namespace

double settled_share(double now, double wanted) {
  return now > 0.0 ? std::clamp(std::log(now) / std::log(wanted), 0.0, 1.0) : 1.0;
}

SettleResult settle(Simulation& simulation, const SettleProgress& progress, SettleFrom from) {
  const SettleInput& input = simulation.scene().settle;
  if (simulation.is_explicit()) {
    const double force = input.unbalanced_fraction * simulation.state().force_scale();
    const RestLimits limits{
        force, input.max_explicit_steps, "settle.max_explicit_steps", input.failure_displacement, input.keep_bonds, from == SettleFrom::rest};
    return settle_explicitly(simulation, limits, progress);
  }
  const auto& system = simulation.system();
  const bool is_first = simulation.state().counters.steps + simulation.state().counters.cuts == 0;
  const int blocks = system.block_count();
  if (is_first && blocks >= fewest_blocks_with_fresh_memory && blocks <= most_blocks_in_heap) provide_memory(fresh_bytes_of_a_block * blocks);
  std::vector<Motion::Unknowns> start;
  for (int b = 0; b < system.block_count(); ++b) start.push_back(system.displacement(b));
  simulation.change_system().stop();
  Neglect neglect(simulation);

  SettleResult result;
  double dt = input.first_dt, growth = fastest_growth;
  const double limit = simulation.scene().step.max_displacement;
  while (result.steps < input.max_steps) {
    neglect.renew();
    const StepResult step = simulation.step(dt, true);
    if (!step.accepted) {
      dt *= step.moved > limit ? std::clamp(factor_to_limit(limit, step.moved), deepest_cut, 1.0) : cut;
      growth = growth_after_cut;
      result.criterion = step.reason;
      if (dt < simulation.scene().step.smallest_fraction * input.first_dt) return result;
      continue;
    }
    ++result.steps;
    result.unbalanced_fraction = step.unbalanced_force / simulation.state().force_scale();
    if (progress) progress(settled_share(result.unbalanced_fraction, input.unbalanced_fraction));
    for (int b : system.free_blocks()) {
      result.displacement = std::max(result.displacement, Motion::displacement_bound(system.displacement(b) - start[b], system.block(b).radius));
    }
    // Forces that were in balance with cohesion that is gone now are to be balanced anew.
    if (result.unbalanced_fraction <= input.unbalanced_fraction && !step.lost_strength) {
      result.settled = true;
      result.criterion = "unbalanced force";
      return result;
    }
    if (result.displacement > input.failure_displacement) {
      result.criterion = "displacement";
      result.limit = "settle.failure_displacement_m";
      return result;
    }
    // A balance that a loss of strength has upset gives no reason for longer steps.
    if (result.unbalanced_fraction <= input.unbalanced_fraction) continue;
    dt = std::min(dt * std::min(growth, factor_to_limit(limit, step.moved)), largest_growth * input.first_dt);
    growth = std::min(growth * growth, fastest_growth);
  }
  result.criterion = "steps";
  result.limit = "settle.max_steps";
  return result;
}

void balance_what_is_left(Simulation& simulation, const SettleResult& settled) {
  if (!simulation.is_explicit() && settled.unbalanced_fraction > tolerance::rest)
    simulation.step(largest_growth * simulation.scene().settle.first_dt, true);
}

}  // namespace openclose
