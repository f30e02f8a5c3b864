#include "openclose/analysis/settling_trials.h"

namespace openclose {
namespace {

const std::string by_displacement = "displacement";  ///< see SettleResult::criterion

}  // namespace

SettlingTrials::SettlingTrials(Simulation& simulation, const SettleProgress& progress)
    : simulation_(simulation), search_(make_equilibrium_search(simulation)), points_(simulation), progress_(progress), initial_(simulation.save()) {}

TrialResult SettlingTrials::first(double srf) {
  simulation_.restore(initial_);
  simulation_.change_joints().reduce_strength(srf);
  const SettleResult settled = search_->settle_first(progress_);
  TrialResult result = result_of(settled);
  result.criterion = settled.verdict();
  if (result.outcome != TrialOutcome::stable) return result;
  settled_ = simulation_.save();
  points_.restart();
  result.displacement = 0.0;
  return result;
}

TrialResult SettlingTrials::next(double srf, OnBreak) {
  if (!settled_) throw DamagedState("the saved state has a stable trial without its blocks");
  simulation_.restore(*settled_);
  simulation_.change_joints().reduce_strength(srf);
  return result_of(search_->settle_trial(progress_));
}

void SettlingTrials::exchange(Archive& archive) {
  search_->exchange(archive);
  archive(points_, initial_, settled_, failed_);
  const bool sound = simulation_.fits(initial_) && (!settled_ || simulation_.fits(*settled_)) && (!failed_ || simulation_.fits(*failed_));
  archive.require(sound, "the saved state has blocks that are not there");
}

TrialResult SettlingTrials::result_of(const SettleResult& settled) {
  // The paper's criterion knows no other failure than too many steps.
  const bool paper = simulation_.scene().settle.criterion == SettleCriterion::paper;
  TrialResult result;
  result.criterion = settled.criterion;
  result.steps = settled.steps;
  result.displacement = points_.largest_displacement();
  if (settled.settled) {
    result.outcome = TrialOutcome::stable;
    return result;
  }
  if (settled.criterion == by_displacement || (paper && settled.criterion == "steps")) {
    result.outcome = TrialOutcome::failed;
    failed_ = simulation_.save();
  }
  return result;
}

}  // namespace openclose
