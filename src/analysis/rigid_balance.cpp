#include "openclose/analysis/rigid_balance.h"

#include <string>

#include "openclose/analysis/frozen_trials.h"
#include "openclose/analysis/named_states.h"

namespace openclose {
namespace {

/// In words the mechanism, or nothing.
std::string unreached_balance_in_words(const Simulation& simulation, const SettleResult& settled, double factor) {
  const SettleCriterion criterion = simulation.scene().settle.criterion;
  const bool is_rigid = !simulation.is_explicit() && !simulation.state().enforcement->has_elastic_contacts();
  // The ends of a joint with tensile strength, which a motion knows alone, bear more than its edge.
  if (!is_rigid || simulation.joints().has_tension() || criterion != SettleCriterion::unbalanced_force) return {};
  // What the passes find at once, each nearer than the one before, nothing has moved on the way to.
  if (!settled.settled || !settled.moved_on || settled.displacement > closed_gap * frozen_length_unit(simulation.scene())) return {};
  Scene scene = simulation.scene();
  scene.strength_reduction.increase.reset();
  FrozenSystem system(scene);
  FrozenTrials trials(scene, system);
  if (trials.first(factor).outcome != TrialOutcome::failed) return {};
  return motion_in_words(scene, mechanism_of(scene, system, trials.mechanism()).blocks);
}

}  // namespace

SettleResult without_unreached_balance(const Simulation& simulation, SettleResult settled, double factor) {
  const std::string words = unreached_balance_in_words(simulation, settled, factor);
  if (words.empty()) return settled;
  settled.settled = false;
  settled.criterion = "rigid contacts hold by locked forces that their joints' springs do not lead to: " + words;
  return settled;
}

}  // namespace openclose
