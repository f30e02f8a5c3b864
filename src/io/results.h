// The files of a run. Units stand in the column names; numbers read back exactly (17 significant digits, of states the shortest that
// do), so that nothing is lost between run and evaluation.
#pragma once

#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/drawn_joints.h"
#include "openclose/analysis/measured_contacts.h"
#include "openclose/analysis/strength_reduction.h"
#include "openclose/io/checkpoint.h"
#include "openclose/io/output_folder.h"

namespace openclose {

/// The run that a run goes on from; its tables are continued.
struct RestartPoint {
  std::string checkpoint_file;
  Checkpoint checkpoint;
};

/// The ledger's entries with their names, in the order of the files.
std::vector<std::pair<const char*, double>> ledger_entries(const EnergyLedger& ledger);

/// A table that grows while a run goes on.
class RunTable {
 public:
  void close() { finish_growing(file_, path_); }
  /// What has reached the disk: everything so far. Throws WriteError if it has not.
  TableMark written();

 protected:
  /// With these column names, or with what the table had when the run it goes on from was saved.
  RunTable(const OutputFolder& folder, const std::string& name, const std::string& columns, const RestartPoint* restart);
  /// After rows: nobody waits for the end of a run whose table has stopped growing. Throws WriteError then.
  void require_written() const;
  std::ofstream file_;

 private:
  std::string path_;
  TableMark mark_;  ///< of what was written when it was last asked for
};

/// history.csv: motion of the measured points.
class HistoryFile : public RunTable {
 public:
  explicit HistoryFile(const OutputFolder& folder, const RestartPoint* restart = nullptr);
  void add(double time, const std::vector<PointMotion>& motions);
};

/// energy.csv: the ledger.
class EnergyFile : public RunTable {
 public:
  explicit EnergyFile(const OutputFolder& folder, const RestartPoint* restart = nullptr);
  void add(double time, const EnergyLedger& ledger);
};

/// blocks.csv: the polygons of all blocks in named states.
class BlocksFile : public RunTable {
 public:
  explicit BlocksFile(const OutputFolder& folder, const RestartPoint* restart = nullptr);
  void add(const std::string& state, const Simulation& simulation) { add(state, simulation.scene(), simulation.system()); }
  void add(const std::string& state, const Scene& scene, const BlockSystem& system);
};

/// contacts.csv: every contact of each state, with the forces that act there.
class ContactsFile : public RunTable {
 public:
  explicit ContactsFile(const OutputFolder& folder, const RestartPoint* restart = nullptr);
  void add(const std::string& state, const Scene& scene, const BlockSystem& system, const std::vector<Contact>& contacts);
};

/// block_states.csv: where the centroid of every block has gone, and how fast it moves. States without time have no velocities either.
class BlockStatesFile : public RunTable {
 public:
  explicit BlockStatesFile(const OutputFolder& folder, const RestartPoint* restart = nullptr);
  void add(const std::string& state, const Simulation& simulation);
  void add(const std::string& state, const Scene& scene, const BlockSystem& system);

 private:
  void add_place(std::string& rows, const std::string& state, const std::string& time, const Scene& scene, const BlockSystem& system, int b) const;
};

/// cracks.csv: opening and slip at the two ends of every joint of the drawing.
class CracksFile : public RunTable {
 public:
  CracksFile(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart = nullptr);
  void add(const std::string& state, const Scene& scene, const BlockSystem& system, JointDirection direction = JointDirection::moved);

 private:
  std::vector<DrawnJoint> joints_;
};

/// contact_history.csv: the measured contacts.
class ContactHistoryFile : public RunTable {
 public:
  explicit ContactHistoryFile(const OutputFolder& folder, const RestartPoint* restart = nullptr);
  void add(double time, const std::vector<ContactMotion>& motions);
};

/// The tables of states that belong together.
class StateTables {
 public:
  StateTables(const OutputFolder& folder, const Scene& scene, const RestartPoint* restart = nullptr);
  /// The drawing: nothing has moved, and no force acts yet.
  void add_drawing(const Scene& scene, const BlockSystem& drawn) { blocks_.add("initial", scene, drawn); }
  /// A moment of a run.
  void add(const std::string& state, const Simulation& simulation);
  /// A state of a factor of safety.
  void add(const NamedState& state, const Scene& scene);
  /// See RunTable::written().
  std::vector<TableMark> written();
  void close();

 private:
  BlocksFile blocks_;
  ContactsFile contacts_;
  BlockStatesFile states_;
  CracksFile cracks_;
};

/// block_properties.csv: what does not change.
void write_block_properties(const OutputFolder& folder, const Scene& scene, const BlockSystem& system);

/// mechanism.csv: the blocks that move when the scene fails.
void write_mechanism(const OutputFolder& folder, const Scene& scene, const std::vector<FailingBlock>& blocks);

/// trials.csv and, if the scene asks for motion, curve.csv. \param factor  see column_of_answer()
void write_trials(const OutputFolder& folder, const std::vector<StrengthTrial>& trials, const char* factor = "srf");
void write_curve(const OutputFolder& folder, const std::vector<CurvePoint>& curve);

/// milestones.csv, if the scene asks for any: of one that was not reached time and CPU times are empty.
void write_milestones(const OutputFolder& folder, const std::vector<Milestone>& milestones);

}  // namespace openclose
