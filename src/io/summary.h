// summary.json: what was asked, what came out, how far to trust it and what it has cost.
#pragma once

#include <string>
#include <vector>

#include "openclose/analysis/run.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/io/output_folder.h"

namespace openclose {

/// What summary.json says besides the simulation itself.
struct Summary {
  std::string command;
  std::string scene_file;
  std::vector<std::string> overrides;
  std::vector<std::string> warnings;
  bool converged = false;
  std::string reason;
  double max_penetration = 0.0;  ///< [m]
  EnergyLedger ledger;
  SettleResult settling;
  std::string ended_by;               ///< see RunResult
  WatchReport watch;                  ///< see RunResult
  std::vector<Milestone> milestones;  ///< see RunResult
  double cpu_of_start = 0.0;          ///< [s]
  double cpu_of_motion = 0.0;         ///< [s]
  double cpu_of_search = 0.0;         ///< [s] of a factor of safety, settling included
};

void write_summary(const OutputFolder& folder, const Summary& summary, const Simulation& simulation, const FactorOfSafety* safety = nullptr);

}  // namespace openclose
