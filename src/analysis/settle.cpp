#include "openclose/analysis/settle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "openclose/analysis/farthest.h"
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

void begin(Simulation& simulation, SettleCourse& course) {
  const BlockSystem& system = simulation.system();
  const bool is_first = simulation.state().counters.steps + simulation.state().counters.cuts == 0;
  const int blocks = system.block_count();
  if (is_first && blocks >= fewest_blocks_with_fresh_memory && blocks <= most_blocks_in_heap) provide_memory(fresh_bytes_of_a_block * blocks);
  course = {true, false, simulation.scene().settle.first_dt, fastest_growth, system.state().displacement, {}};
  simulation.change_system().stop();
}

/// Takes account of a step; true if it was the last one.
bool follow(const Simulation& simulation, const StepResult& step, SettleCourse& course) {
  const SettleInput& input = simulation.scene().settle;
  const BlockSystem& system = simulation.system();
  const double limit = simulation.state().lengths.longest_displacement;
  SettleResult& result = course.result;
  if (!step.accepted) {
    course.dt *= step.moved > limit ? std::clamp(factor_to_limit(limit, step.moved), deepest_cut, 1.0) : cut;
    course.growth = growth_after_cut;
    result.criterion = step.reason;
    return course.dt < simulation.scene().step.smallest_fraction * input.first_dt;
  }
  ++result.steps;
  result.unbalanced_fraction = step.unbalanced_force / simulation.state().force_scale();
  result.displacement = std::max(result.displacement, farthest_displacement(system, course.start));
  const bool is_balanced = result.unbalanced_fraction <= input.unbalanced_fraction;
  // Forces that were in balance with cohesion that is gone now are to be balanced anew.
  if (is_balanced && !step.lost_strength) {
    result.settled = true;
    result.criterion = "unbalanced force";
    return true;
  }
  if (result.displacement > input.failure_displacement) {
    result.criterion = "displacement";
    result.limit = "settle.failure_displacement_m";
    return true;
  }
  // A balance that a loss of strength has upset gives no reason for longer steps.
  if (!is_balanced) {
    course.dt = std::min(course.dt * std::min(course.growth, factor_to_limit(limit, step.moved)), largest_growth * input.first_dt);
    course.growth = std::min(course.growth * course.growth, fastest_growth);
  }
  if (result.steps < input.max_steps) return false;
  result.criterion = "steps";
  result.limit = "settle.max_steps";
  return true;
}

}  // namespace

double settled_share(double now, double wanted) {
  return now > 0.0 ? std::clamp(std::log(now) / std::log(wanted), 0.0, 1.0) : 1.0;
}

SettleResult settle(Simulation& simulation, const SettleProgress& progress, SettleFrom from, SettleCourse* course) {
  const SettleInput& input = simulation.scene().settle;
  if (simulation.is_explicit()) {
    const double force = input.unbalanced_fraction * simulation.state().force_scale();
    const RestLimits limits{
        force, input.max_explicit_steps, "settle.max_explicit_steps", input.failure_displacement, input.keep_bonds, from == SettleFrom::rest, true};
    return settle_explicitly(simulation, limits, progress);
  }
  SettleCourse own;
  SettleCourse& c = course ? *course : own;
  if (!c.has_begun) begin(simulation, c);
  Neglect neglect(simulation);
  while (!c.is_over) {
    neglect.renew();
    const StepResult step = simulation.step(c.dt, true);
    c.is_over = follow(simulation, step, c);
    if (step.accepted && progress) progress(settled_share(c.result.unbalanced_fraction, input.unbalanced_fraction));
  }
  return c.result;
}

void balance_what_is_left(Simulation& simulation, const SettleResult& settled) {
  if (!simulation.is_explicit() && settled.unbalanced_fraction > tolerance::rest)
    simulation.step(largest_growth * simulation.scene().settle.first_dt, true);
}

}  // namespace openclose
