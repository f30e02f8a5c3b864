// Static equilibrium by continuation: pseudo-time steps from rest, longer and longer, until the unbalanced force is below a stated fraction of the
// weight. Explicit methods damp their motion instead.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "openclose/analysis/simulation.h"

namespace openclose {

struct SettleResult {
  bool settled = false;
  std::string criterion;  ///< what decided: "unbalanced force", "displacement", "steps", or the reason of a step that failed
  int steps = 0;
  double unbalanced_fraction = 1.0;             ///< [-] of SimulationState::force_scale(), by emphasis_at_rest()
  double displacement = 0.0;                    ///< [m] largest of any block on the way
  std::optional<double> relative_displacement;  ///< [-] of the last step, see equilibrium.h; steps in time only, which know no unbalanced fraction
  std::string limit;                            ///< key of the limit that ended the search without equilibrium; empty where a step failed

  /// For messages: what decided, with the key to change.
  std::string verdict() const { return limit.empty() ? criterion : criterion + ", limited by " + limit; }

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f, g] = *this;
    archive(a, b, c, d, e, f, g);
  }
};

/// Told after every step which share of the way is behind; it may fall back.
using SettleProgress = std::function<void(double fraction)>;

/// From where a search for equilibrium starts.
enum class SettleFrom {
  anywhere,  ///< such as a drawing whose joints carry nothing yet
  rest,      ///< with other strengths of the joints: what slips by more than the springs it rests on can carry has slid
};

/// Where settle() stands between two of its steps. With the simulation as it was then it goes on as if it had never been stopped.
struct SettleCourse {
  bool has_begun = false, is_over = false;
  double dt = 0.0, growth = 0.0;        ///< [s, -] of the next step, and of the one after it
  std::vector<Motion::Unknowns> start;  ///< displacements of the blocks
  SettleResult result;                  ///< so far

  void exchange(Archive& archive) {
    auto& [a, b, c, d, e, f] = *this;
    archive(a, b, c, d, e, f);
  }
};

/// \param course  of a search that is to be gone on with where `progress` has thrown; explicit methods know none
SettleResult settle(Simulation& simulation, const SettleProgress& progress = {}, SettleFrom from = SettleFrom::anywhere,
                    SettleCourse* course = nullptr);

/// Before a motion, if settling has left more than tolerance::rest unbalanced: one more static step, which leaves nothing. Else what is left would
/// set blocks in motion, and each step would be solved anew until that has died away, for twenty steps in a wall of 10,040 bricks.
void balance_what_is_left(Simulation& simulation, const SettleResult& settled);

/// The share [-] of the way down to `wanted` on a logarithmic scale, 0 where `now` is 1 or more.
double settled_share(double now, double wanted);

/// When an explicit search for equilibrium has arrived and when it is given up.
struct RestLimits {
  double unbalanced_force;      ///< [N] largest on a block that counts as rest
  int max_steps;                ///< of the explicit loop
  std::string max_steps_key;    ///< that says so
  double failure_displacement;  ///< [m] a block that moved farther is failing
  bool keep_bonds;              ///< contacts lose strength at rest only, see below
  bool from_rest;               ///< see SettleFrom
  bool by_own_weight;           ///< on light blocks less force counts as rest, see emphasis_at_rest(); the paper's rule knows one force for all
};

/// What settle() does for explicit methods: steps at the longest stable length with damping of the motion (`local`, unless the scene asks for
/// `automatic`), from rest. What friction holds in the end depends on the way there, as always in this method.
///
/// That way is no motion of the slope: waves that the sudden change sends through it open contacts for a moment which equilibrium keeps closed. With
/// `keep_bonds` it is gone with all bonds (what users of distinct-element codes know as "elastic first"). At rest, contacts that are open (or, where
/// the joint says so, slide or have slid since the last rest) lose what they have to lose, and what this leaves settles again, now losing on the way,
/// too. A load that comes at once pulls more than it does at rest: where no rest is found so, joints with tensile strength are not parted on the way
/// either.
SettleResult settle_explicitly(Simulation& simulation, const RestLimits& limits, const SettleProgress& progress);

}  // namespace openclose
