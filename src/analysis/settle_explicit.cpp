#include <algorithm>
#include <limits>
#include <utility>

#include "openclose/analysis/settle.h"

namespace openclose {
namespace {

constexpr double cut = 0.5;              ///< [-] on a step that moves a block too far
constexpr int displacement_every = 100;  ///< steps between two looks at the displacement, which costs as much as a step

/// Displacement of the farthest block since this was made.
class Travel {
 public:
  explicit Travel(const Simulation& simulation) : simulation_(simulation), start_(simulation.system().state().displacement) {}
  double largest() const {
    const BlockSystem& system = simulation_.system();
    double largest = 0.0;
    for (int b : system.free_blocks()) {
      largest = std::max(largest, Motion::displacement_bound(system.displacement(b) - start_[b], system.block(b).radius));
    }
    return largest;
  }

 private:
  const Simulation& simulation_;
  std::vector<Motion::Unknowns> start_;
};

/// Notices blocks that swing without end: while the unbalanced force neither falls nor moves anything on, the way to rest leads nowhere.
///
/// It compares one stretch of steps with the next, twice as long: whatever falls at any rate shows in some stretch, and a block that slides away goes
/// farther in the second one.
class Standstill {
 public:
  void add(double unbalanced) { lowest_ = std::min(lowest_, unbalanced); }
  bool is_due(int steps) const { return steps == end_; }
  /// Whether nothing has become better in the stretch that ends here.
  bool ends_here(double displacement) {
    const bool still = lowest_ > least_fall * before_ && displacement <= least_way * displacement_;
    before_ = std::min(before_, lowest_);
    displacement_ = displacement;
    lowest_ = std::numeric_limits<double>::infinity();
    end_ *= 2;
    return still;
  }
  /// After something has been changed.
  void begin_anew(int steps) {
    const double displacement = displacement_;
    *this = Standstill();
    displacement_ = displacement;
    end_ = steps + first_stretch;
  }

 private:
  /// A wave crosses a slope of 10,000 blocks some ten times in so many steps.
  static constexpr int first_stretch = 5000;
  static constexpr double least_fall = 0.9;  ///< [-] of the unbalanced force
  static constexpr double least_way = 1.01;  ///< [-] of the displacement
  int end_ = first_stretch;
  double lowest_ = std::numeric_limits<double>::infinity(), before_ = lowest_, displacement_ = 0.0;
};

/// [-] On the step where blocks swing without end: what the shortest step leaves swinging swings at any length.
constexpr double shorter = 0.5, shortest = 0.125;

SettleResult seek_rest(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress) {
  ExplicitStepper& stepper = *simulation.explicit_stepper();
  const MassDamping asked = simulation.scene().method.damping;
  const MassDamping damping = asked == MassDamping::none ? MassDamping::local : asked;
  simulation.come_to_rest();
  const Travel travel(simulation);
  const double scale = simulation.force_scale(), wanted = limits.unbalanced_force / scale;

  SettleResult result;
  result.criterion = "steps";
  Standstill standstill;
  double fraction = 1.0;
  for (double part = 1.0; result.steps < limits.max_steps;) {
    // Without contacts and supports nothing bounds the step but the way it may go.
    const double h = part * fraction * std::min(stepper.longest_stable_step(damping), simulation.scene().settle.first_dt);
    const StepResult step = stepper.step(h, damping);
    if (step.relisted) continue;
    if (!step.accepted) {
      part *= cut;
      result.criterion = step.reason;
      if (part < simulation.scene().step.smallest_fraction) break;
      continue;
    }
    if (step.stops) {
      result.criterion = step.reason;
      break;
    }
    part = std::min(1.0, part / cut);
    ++result.steps;
    result.criterion = "steps";
    result.unbalanced_fraction = step.unbalanced_force / scale;
    // A block may swing through its place of rest: what counts is the state after the step. Forces that were in balance with cohesion that is gone
    // now are to be balanced anew.
    if (result.unbalanced_fraction <= wanted) result.unbalanced_fraction = stepper.unbalanced_force() / scale;
    result.settled = result.unbalanced_fraction <= wanted && !step.lost_strength;
    if (result.settled || result.steps % displacement_every == 0) {
      stepper.collect();
      result.displacement = std::max(result.displacement, travel.largest());
      if (progress) progress(settled_share(result.unbalanced_fraction, wanted));
    }
    if (result.settled) result.criterion = "unbalanced force";
    if (result.settled) break;
    standstill.add(result.unbalanced_fraction);
    if (standstill.is_due(result.steps)) {
      stepper.collect();
      result.displacement = std::max(result.displacement, travel.largest());
      if (standstill.ends_here(result.displacement)) {
        if (fraction <= shortest) {
          result.criterion = "blocks swing without end";
          result.limit = "method.damping";
          break;
        }
        fraction *= shorter;
        standstill.begin_anew(result.steps);
      }
    }
    if (result.displacement > limits.failure_displacement) {
      result.criterion = "displacement";
      result.limit = "settle.failure_displacement_m";
      break;
    }
  }
  if (result.criterion == "steps") result.limit = limits.max_steps_key;
  simulation.come_to_rest();
  return result;
}

}  // namespace

SettleResult settle_explicitly(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress) {
  if (!limits.keep_bonds) return seek_rest(simulation, limits, progress);
  simulation.keep_bonds(true);
  SettleResult kept = seek_rest(simulation, limits, progress);
  simulation.keep_bonds(false);
  if (!kept.settled) return kept;
  simulation.judge_bonds();
  RestLimits rest = limits;
  rest.max_steps -= kept.steps;
  SettleResult result = seek_rest(simulation, rest, progress);
  result.steps += kept.steps;
  result.displacement = std::max(result.displacement, kept.displacement);
  return result;
}

}  // namespace openclose
