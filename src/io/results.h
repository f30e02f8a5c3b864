// The files of a run. Units stand in the column names; numbers carry 17 significant digits, so that nothing is lost between run and evaluation.
#pragma once

#include <fstream>
#include <string>
#include <vector>

#include "openclose/analysis/strength_reduction.h"
#include "openclose/io/output_folder.h"

namespace openclose {

/// history.csv: motion of the measured points.
class HistoryFile {
 public:
  explicit HistoryFile(const OutputFolder& folder);
  void add(double time, const std::vector<PointMotion>& motions);
  void close() { finish(file_, "history.csv"); }

 private:
  std::ofstream file_;
};

/// energy.csv: the ledger.
class EnergyFile {
 public:
  explicit EnergyFile(const OutputFolder& folder);
  void add(double time, const EnergyLedger& ledger);
  void close() { finish(file_, "energy.csv"); }

 private:
  std::ofstream file_;
};

/// blocks.csv: the polygons of all blocks in named states.
template <int N>
class BlocksFile {
 public:
  explicit BlocksFile(const OutputFolder& folder);
  void add(const std::string& state, const Simulation<N>& simulation);
  void close() { finish(file_, "blocks.csv"); }

 private:
  std::ofstream file_;
};

/// contacts.csv: every contact at the end.
template <int N>
void write_contacts(const OutputFolder& folder, const std::string& state, Simulation<N>& simulation);

/// trials.csv and, if the scene asks for motion, curve.csv.
void write_trials(const OutputFolder& folder, const std::vector<StrengthTrial>& trials);
void write_curve(const OutputFolder& folder, const std::vector<CurvePoint>& curve);

/// milestones.csv, if the scene asks for any: of one that was not reached time and CPU times are empty.
void write_milestones(const OutputFolder& folder, const std::vector<Milestone>& milestones);

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
  std::vector<Milestone> milestones;  ///< see RunResult
  double cpu_of_start = 0.0;          ///< [s]
  double cpu_of_motion = 0.0;         ///< [s]
  double cpu_of_search = 0.0;         ///< [s] of a factor of safety, settling included
};

template <int N>
void write_summary(const OutputFolder& folder, const Summary& summary, const Simulation<N>& simulation, const FactorOfSafety<N>* safety = nullptr);

}  // namespace openclose
