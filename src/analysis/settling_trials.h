// Trials at large displacements: blocks move as far as they do. Stable is what settles; failed is what has moved beyond
// settle.failure_displacement_m. With settle.criterion = "paper" that is what its steps have not brought to rest.
#pragma once

#include "openclose/analysis/equilibrium.h"
#include "openclose/analysis/measured_points.h"
#include "openclose/analysis/strength_search.h"

namespace openclose {

class SettlingTrials : public StrengthTrials {
 public:
  SettlingTrials(Simulation& simulation, const SettleProgress& progress);

  TrialResult first(double srf) override;
  /// From the first state that settled, on which joints break one after the other in time.
  TrialResult next(double srf, OnBreak on_break) override;

  using Snapshot = Simulation::Snapshot;
  const std::optional<Snapshot>& settled() const { return settled_; }
  /// Whose displacements count from the settled state. No others may be followed during the search: snapshots would not know them.
  MeasuredPoints& points() { return points_; }
  const std::optional<Snapshot>& failed() const { return failed_; }  ///< of the last trial that failed
  void exchange(Archive& archive) override;
  const EquilibriumSearch& search() const { return *search_; }

 private:
  TrialResult result_of(const SettleResult& settled);

  Simulation& simulation_;
  std::unique_ptr<EquilibriumSearch> search_;
  MeasuredPoints points_;
  SettleProgress progress_;
  Snapshot initial_;
  std::optional<Snapshot> settled_, failed_;
};

}  // namespace openclose
