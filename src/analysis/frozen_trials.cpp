#include "openclose/analysis/frozen_trials.h"

#include <algorithm>
#include <cmath>

#include "openclose/statics/explicit_relaxation.h"
#include "openclose/statics/relaxation.h"

namespace openclose {
namespace {

/// [-] Of settle.max_steps. With the friction of the pass before, only short increments come to an end; of sixty random slopes three instead of six
/// are undecided with five times as many of them, and still three with twenty-five times.
constexpr int open_close_increments_per_step = 5;

/// [-] Of what a joint can lose, on the way to the next factor: more of it counts as a bond that breaks, whose loss depends on the stride.
constexpr double most_loss_on_a_stride = 0.1;
constexpr int trials_of_full_effort = 4;  ///< that stay undecided

/// Rigid contacts at rest carry what springs do, since only the ratios of stiffnesses count.
std::unique_ptr<FrozenSolver> solver_of(const Scene& scene, const FrozenSystem& system, const FrozenStrength& strength) {
  if (scene.method.contact == "dem")
    return std::make_unique<ExplicitRelaxation>(system, strength, scene.method.local_damping, scene.settle.max_explicit_steps);
  if (scene.method.contact == "shi")
    return std::make_unique<Relaxation>(system, strength, IncrementRule::open_close, open_close_increments_per_step * scene.settle.max_steps);
  return std::make_unique<Relaxation>(system, strength, IncrementRule::newton);
}

const char* word_of(RelaxationEnd end) {
  switch (end) {
    case RelaxationEnd::stable:
      return "equilibrium";
    case RelaxationEnd::mechanism:
      return "mechanism";
    case RelaxationEnd::escaped:
      return "moves on without a steady mechanism";
    case RelaxationEnd::undecided:
      return "neither equilibrium nor mechanism found";
  }
  return "";
}

}  // namespace

double smallest_multiplier(const FrozenSystem& system) {
  constexpr double smallest_part = 1e-3;  // [-] of a weight
  double largest = 0.0;
  for (const FrozenBlock& block : system.blocks()) largest = std::max(largest, block.live_load.norm() / block.weight);
  return largest > 0.0 ? smallest_part / largest : smallest_part;
}

FrozenTrials::FrozenTrials(const Scene& scene, FrozenSystem& system)
    : system_(system), strength_(system, scene), solver_(solver_of(scene, system, strength_)) {
  for (int row = 0; row < system.rows(); ++row) {
    const FrozenBlock& block = system.blocks()[row];
    if (scene.measured_points.empty()) points_.push_back({row, Vec2::Zero()});
    for (const MeasuredPoint& p : scene.measured_points) {
      if (p.block == block.block) points_.push_back({row, (p.point - block.centroid) / (block.radius * system.length_unit())});
    }
  }
}

void FrozenTrials::apply(double srf) {
  if (system_.has_live_load()) {
    system_.multiply_live_load(srf);
  } else {
    strength_.reduce(srf);
  }
}

TrialResult FrozenTrials::first(double srf) {
  apply(srf);
  const bool is_alike_at_all = !system_.has_live_load() && !strength_.has_tension();
  if (!is_alike_at_all) {
    bonded_.reset();
    bonded_failed_ = false;
    mechanism_.resize(0);
  }
  if (!bonded_ && !bonded_failed_) {
    RelaxationResult bonded = solver_->bonded_state();
    if (bonded.end == RelaxationEnd::stable) {
      bonded_ = std::move(bonded.state);
    } else {
      bonded_failed_ = true;
      if (bonded.end == RelaxationEnd::mechanism) mechanism_ = std::move(bonded.mechanism);
    }
  }
  if (bonded_failed_) {
    TrialResult none;
    const bool is_proved = mechanism_.size() > 0;
    none.at_every_strength = is_proved && !strength_.has_tension();
    none.outcome = is_proved ? TrialOutcome::failed : TrialOutcome::undecided;
    none.criterion = "no equilibrium even of joints that neither slip nor open in shear";
    return none;
  }
  RelaxationResult relaxed = solver_->relax(*bonded_, effort());
  const bool broke = has_broken(*bonded_, relaxed.state);
  if (relaxed.end == RelaxationEnd::stable) {  // a path of its own begins here
    stable_.reset();
    travel_ = {};
  }
  TrialResult result = result_of(std::move(relaxed), srf);
  result.displacement = 0.0;
  result.broke = broke;
  return result;
}

TrialResult FrozenTrials::next(double srf, OnBreak on_break) {
  if (!stable_) throw DamagedState("the saved state has a stable trial without its forces");
  apply(srf);
  RelaxationResult relaxed = solver_->relax(*stable_, effort());
  const bool broke = has_broken(*stable_, relaxed.state);
  TrialResult result;
  if (broke && on_break == OnBreak::go_back) {
    result.criterion = by_breaking_joints;
    result.steps = static_cast<int>(relaxed.steps);
    result.exhausted = solver_->is_exhausted();
  } else {
    result = result_of(std::move(relaxed), srf);
  }
  result.broke = broke;
  return result;
}

/// What is open at the beginning has no strength to lose: it breaks at every factor.
bool FrozenTrials::has_broken(const FrozenState& before, const FrozenState& after) const {
  for (std::size_t i = 0; i < before.contacts.size(); ++i) {
    const JointState &then = before.contacts[i].joint_state, &now = after.contacts[i].joint_state;
    if (before.contacts[i].status == ContactStatus::open || !strength_.can_lose(i, then)) continue;
    if (strength_.loss(i, then, now) > most_loss_on_a_stride) return true;
  }
  return false;
}

void FrozenTrials::end_search() {
  if (!found_) found_ = Found{stable_, mechanism_, travel_};
}

void FrozenTrials::exchange(Archive& archive) {
  archive(bonded_, bonded_failed_, first_stable_, stable_, stable_factor_, least_compliance_, mechanism_, undecided_, travel_, found_);
  bool sound = mechanism_.size() == 0 || mechanism_.size() == 3 * system_.rows();
  for (const std::optional<FrozenState>* state : {&bonded_, &first_stable_, &stable_}) sound = sound && (!*state || (*state)->fits(system_));
  if (found_) {
    sound = sound && (!found_->stable || found_->stable->fits(system_));
    sound = sound && (found_->mechanism.size() == 0 || found_->mechanism.size() == 3 * system_.rows());
  }
  archive.require(sound, "the saved state has blocks or contacts that are not there");
  solver_->exchange(archive);
}

/// Where several trials have stayed undecided, most of the others do.
Effort FrozenTrials::effort() const {
  return !reduced_ && undecided_ < trials_of_full_effort ? Effort::full : Effort::reduced;
}

TrialResult FrozenTrials::result_of(RelaxationResult&& relaxed, double srf) {
  TrialResult result;
  result.criterion = word_of(relaxed.end);
  result.steps = static_cast<int>(relaxed.steps);
  result.exhausted = solver_->is_exhausted();
  const bool is_first = !stable_;
  if (relaxed.end == RelaxationEnd::stable) {
    result.outcome = TrialOutcome::stable;
    if (is_first) first_stable_ = relaxed.state;
    if (!is_first) follow(relaxed.travel, srf);
    result.displacement = displacement_of_points(relaxed.state);
    stable_ = std::move(relaxed.state);
    stable_factor_ = srf;
    return result;
  }
  if (first_stable_) result.displacement = displacement_of_points(relaxed.state);
  if (relaxed.end == RelaxationEnd::mechanism) {
    result.outcome = TrialOutcome::failed;
    mechanism_ = std::move(relaxed.mechanism);
  } else if (stable_) {
    ++undecided_;
  }
  return result;
}

/// What the way from the last stable state to the one at this factor says.
void FrozenTrials::follow(double travel, double srf) {
  travel_.largest = std::max(travel_.largest, travel);
  bool is_jump = travel > jump_in_closures;
  if (system_.has_live_load() && srf != stable_factor_) {
    const double compliance = travel / std::abs(srf - stable_factor_);
    least_compliance_ = std::min(compliance, least_compliance_.value_or(compliance));
    is_jump = is_jump && compliance > jump_over_stiffest * *least_compliance_;
  }
  if (!is_jump) return;
  const TravelOnPath::Jump jump = {travel, stable_factor_, srf};
  if (!travel_.has_jumped()) travel_.first = jump;
  if (travel > travel_.farthest.travel) travel_.farthest = jump;
}

double FrozenTrials::displacement_of_points(const FrozenState& state) const {
  double largest = 0.0;
  for (const Point& p : points_) {
    const BlockVector d = state.displacement[p.row] - first_stable_->displacement[p.row];
    largest = std::max(largest, (d.head<2>() + d[2] * perpendicular(p.arm)).norm());
  }
  return largest * system_.closure_unit();
}

}  // namespace openclose
