#include <algorithm>
#include <limits>
#include <optional>

#include "openclose/analysis/farthest.h"
#include "openclose/analysis/settle.h"

namespace openclose {
namespace {

constexpr double cut = 0.5;              ///< [-] on a step that moves a block too far
constexpr int displacement_every = 100;  ///< steps between two looks at the displacement, which costs as much as a step

/// Displacement of the farthest block since this was made.
class Travel {
 public:
  explicit Travel(const Simulation& simulation) : simulation_(simulation), start_(simulation.system().state().displacement) {}
  double largest() const { return farthest_displacement(simulation_.system(), start_); }

 private:
  const Simulation& simulation_;
  std::vector<Motion::Unknowns> start_;
};

/// Notices blocks that swing without end: while the unbalanced force neither falls nor moves anything on, the way to rest leads nowhere.
///
/// It compares each stretch of steps with those before it, which together are as long: whatever falls at any rate shows in some stretch, and a block
/// that slides away goes farther in each.
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

/// The way of the explicit loop to rest, from where the blocks are.
class RestSearch {
 public:
  RestSearch(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress)
      : simulation_(simulation), stepper_(*simulation.explicit_stepper()), limits_(limits), progress_(progress) {
    const MassDamping asked = simulation.scene().method.damping;
    damping_ = asked == MassDamping::none ? MassDamping::local : asked;
    simulation.come_to_rest();
    travel_.emplace(simulation);
    scale_ = simulation.state().force_scale();
    wanted_ = limits.unbalanced_force / scale_;
  }

  SettleResult run() {
    result_.criterion = "steps";
    while (result_.steps < limits_.max_steps && goes_on()) {
    }
    if (result_.criterion == "steps") result_.limit = limits_.max_steps_key;
    simulation_.come_to_rest();
    return result_;
  }

 private:
  bool goes_on() {
    // Without contacts and supports nothing bounds the step but the way it may go.
    const double h = part_ * fraction_ * std::min(stepper_.longest_stable_step(damping_), simulation_.scene().settle.first_dt);
    const StepResult step = stepper_.step(h, damping_);
    if (step.relisted) return true;
    if (!step.accepted) {
      part_ *= cut;
      result_.criterion = step.reason;
      return part_ >= simulation_.scene().step.smallest_fraction;
    }
    if (step.stops) {
      result_.criterion = step.reason;
      return false;
    }
    part_ = std::min(1.0, part_ / cut);
    ++result_.steps;
    result_.criterion = "steps";
    return !is_at_rest(step) && !swings_without_end() && !has_failed();
  }

  bool is_at_rest(const StepResult& step) {
    result_.unbalanced_fraction = step.unbalanced_force / scale_;
    // A block may swing through its place of rest: what counts is the state after the step. Forces that were in balance with cohesion that is gone
    // now are to be balanced anew.
    if (result_.unbalanced_fraction <= wanted_)
      result_.unbalanced_fraction = stepper_.unbalanced_force(limits_.by_own_weight ? scale_ : 0.0) / scale_;
    result_.settled = result_.unbalanced_fraction <= wanted_ && !step.lost_strength;
    if (result_.settled || result_.steps % displacement_every == 0) {
      look_at_displacement();
      if (progress_) progress_(settled_share(result_.unbalanced_fraction, wanted_));
    }
    if (result_.settled) result_.criterion = "unbalanced force";
    return result_.settled;
  }

  bool swings_without_end() {
    standstill_.add(result_.unbalanced_fraction);
    if (!standstill_.is_due(result_.steps)) return false;
    look_at_displacement();
    if (!standstill_.ends_here(result_.displacement)) return false;
    if (fraction_ <= shortest) {
      result_.criterion = "blocks swing without end";
      result_.limit = "method.damping";
      return true;
    }
    fraction_ *= shorter;
    standstill_.begin_anew(result_.steps);
    return false;
  }

  bool has_failed() {
    if (result_.displacement <= limits_.failure_displacement) return false;
    result_.criterion = "displacement";
    result_.limit = "settle.failure_displacement_m";
    return true;
  }

  void look_at_displacement() {
    stepper_.collect();
    result_.displacement = std::max(result_.displacement, travel_->largest());
  }

  Simulation& simulation_;
  ExplicitStepper& stepper_;
  const RestLimits& limits_;
  const SettleProgress& progress_;
  MassDamping damping_;
  std::optional<Travel> travel_;
  double scale_ = 1.0, wanted_ = 0.0;  ///< [N], [-] of it
  SettleResult result_;
  Standstill standstill_;
  double fraction_ = 1.0, part_ = 1.0;  ///< [-] of the longest stable step: where blocks swing, and after a step that went too far
};

/// Where joints lose strength by slip, it counts which of them slip, and not by how the blocks swing before the springs carry them: the state in
/// which they carry the blocks without any slip, if there is one, and if it matters. If not, the blocks are where they were.
std::optional<Simulation::Snapshot> rest_without_slip(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress) {
  const auto loses_by_slip = [](const JointProperties& joint) { return can_lose_strength(joint, {}) && joint.weakens_by_slip(); };
  if (std::ranges::none_of(simulation.scene().joints, loses_by_slip)) return std::nullopt;
  const Simulation::Snapshot start = simulation.save();
  simulation.set_bonds(Bonds::last_without_slip);
  const bool settled = RestSearch(simulation, limits, progress).run().settled;
  simulation.set_bonds(Bonds::break_under_load);
  if (settled) return simulation.save();
  simulation.restore(start);
  return std::nullopt;
}

/// From where the blocks are, with all bonds. A load that comes at once pulls more than it does at rest, so that what hangs may part on the way and
/// fall: then from where the blocks were once more, now with joints that no tension parts before the blocks are at rest.
SettleResult rest_with_bonds(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress) {
  std::optional<Simulation::Snapshot> start;
  if (simulation.joints().has_tension()) start = simulation.save();
  const auto search = [&](Bonds bonds) {
    simulation.set_bonds(bonds);
    SettleResult result = RestSearch(simulation, limits, progress).run();
    simulation.set_bonds(Bonds::break_under_load);
    return result;
  };
  SettleResult parted = search(Bonds::last);
  if (parted.settled || !start) return parted;
  const Simulation::Snapshot end = simulation.save();
  simulation.restore(*start);
  SettleResult held = search(Bonds::last_unparted);
  if (held.settled) return held;
  simulation.restore(end);
  return parted;
}

SettleResult rest_in_legs(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress) {
  if (!limits.keep_bonds) return RestSearch(simulation, limits, progress).run();
  std::optional<Simulation::Snapshot> before = limits.from_rest ? simulation.save() : rest_without_slip(simulation, limits, progress);
  SettleResult kept = rest_with_bonds(simulation, limits, progress);
  if (!kept.settled) return kept;
  simulation.judge_bonds(before ? &*before : nullptr);
  RestLimits rest = limits;
  rest.max_steps -= kept.steps;
  SettleResult result = RestSearch(simulation, rest, progress).run();
  result.steps += kept.steps;
  result.displacement = std::max(result.displacement, kept.displacement);
  return result;
}

}  // namespace

SettleResult settle_explicitly(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress) {
  const Travel travel(simulation);  // through all legs
  SettleResult result = rest_in_legs(simulation, limits, progress);
  result.displacement = std::max(result.displacement, travel.largest());
  return result;
}

}  // namespace openclose
