// checkpoint.bin: a run as it stood at one moment, or what a search for the factor of safety has found out, so that `openclose run --restart` and
// `openclose fos --restart` go on as if they had never stopped.
//
// A line that names format and version, the order of the bytes, the scene as text, the time, how long the tables of the run were, the state
// (analysis/run.h, analysis/strength_reduction.h), the command and a check sum over all of it. Numbers stand as they are in memory. The file takes
// the place of an older one only when it is complete.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "openclose/core/archive.h"
#include "openclose/scene/scene.h"

namespace openclose {

/// A table of a run as it was at the time of a checkpoint.
struct TableMark {
  std::string name;
  std::uint64_t length = 0;  ///< [bytes]
  std::uint64_t sum = 0;     ///< see core/check_sum.h, of so many bytes

  bool operator==(const TableMark&) const = default;
  void exchange(Archive& archive) { archive(name, length, sum); }
};

struct Checkpoint {
  double time = 0.0;              ///< [s] of the run
  std::vector<TableMark> tables;  ///< at that time
  std::string state;              ///< bytes of an Archive
  std::string command = "run";    ///< that goes on from it

  void exchange(Archive& archive) {
    auto& [a, b, c, d] = *this;
    archive(a, b, c, d);
  }
};

/// Throws WriteError if the file cannot be made or not be written to its end; the older one is still there then.
void write_checkpoint(const std::string& path, const Scene& scene, Checkpoint checkpoint);

/// What stands in the file. The check sum at its end is against disks and half copies, not against people.
std::string checkpoint_bytes(const Scene& scene, Checkpoint checkpoint);
void append_check_sum(std::string& bytes);

/// Throws InputError if there is no such file, if it is damaged or of another version of the program or another scene (other in more than the keys
/// that have may_change_on_restart in their row), if the scene ends before it, if one of the tables that were there when it was written is no longer
/// beside it, shorter, or begins otherwise, or if it is of another command.
Checkpoint read_checkpoint(const std::string& path, const Scene& scene, const std::string& command = "run");
/// The same for what stands in the file of that path.
Checkpoint checkpoint_of_bytes(const std::string& bytes, const std::string& path, const Scene& scene);

/// The file of a table that lay beside this checkpoint.
std::string table_beside(const std::string& checkpoint_path, const std::string& table);

}  // namespace openclose
