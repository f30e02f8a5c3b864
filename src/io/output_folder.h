// The folder a run writes to. Made, and tried, before anything is computed, so that a run is never lost to a folder that cannot be written.
//
// A folder that is claimed keeps a list of the names that results have got there: what stands there under a name that results may get and is not
// listed is somebody else's, and the folder is refused. A name is listed when its file is made, so that a run that is killed claims no more than it
// has written. At the end of an analysis the sums of the files are listed, too: one that somebody has changed since is not ours any more. Files that
// are written as a whole get their names when they are complete; until then these end in ".part".
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "openclose/io/part_files.h"

namespace openclose {

inline constexpr const char* checkpoint_name = "checkpoint.bin";
inline constexpr const char* scene_copy_name = "scene_as_read.toml";
inline constexpr const char* list_name = ".openclose";

/// Throws InputError for "/", which is no place for results.
void require_no_root(const std::string& folder);

class OutputFolder {
 public:
  /// Creates the folder if it is missing. Throws InputError if the files of a run cannot be written there.
  explicit OutputFolder(const std::string& path);
  /// From now on the names of files that are made in this folder are listed as ours, beside those of an earlier run that are there. Throws InputError
  /// if a name that results may get is a file that is read, or one that openclose has not written or that has been changed since; nothing has changed
  /// then.
  void claim(const std::vector<std::string>& read_files) const;
  /// Throws as claim() would, and changes nothing.
  void require_ours(const std::vector<std::string>& read_files) const;
  /// A file of this name is about to be written as a whole. Throws WriteError if somebody else has put one there since the folder was claimed.
  /// Changes nothing in a folder that nobody has claimed. \return its path
  std::string claim_whole_file(const std::string& name) const;
  /// From now on only those of the listed names are ours that are there.
  void forget_removed() const;
  /// The analysis is over: the same, and of these only as long as they are not changed.
  void list_results() const;
  /// [bytes] Of the tables of results that are there, by name.
  std::map<std::string, std::uintmax_t> table_sizes() const;
  /// The scene as it was read, with its blocks cut and its overrides applied.
  void write_scene_copy(const std::string& text) const;
  /// A file of this name in the folder of a format, which is made where it is missing.
  void write_format_file(const std::string& format, const std::string& name, const std::string& text) const;

  /// Removes what an earlier run or factor of safety has left, by the names that this program gives; nothing else. Throws WriteError if it cannot.
  void remove_results() const;
  /// Of these only what comes at the end of an analysis, not the tables and the checkpoint with which one that was broken off goes on.
  void remove_last_results() const;
  /// Of an analysis that is over and leaves nothing to go on from.
  void remove_checkpoint() const { remove(checkpoint_name); }
  /// Whether a run that goes on from this checkpoint goes on in this folder, whatever the paths look like.
  bool has(const std::string& checkpoint_file) const;

  /// A new file, which gets its name with finish(), replacing an old one. Throws WriteError if it cannot be made any more.
  std::ofstream open(const std::string& name) const;
  /// A new file that has its name at once, for rows that a broken-off run is to leave behind; to be closed by finish_growing().
  std::ofstream open_growing(const std::string& name) const;
  /// The same, but beginning with the first `length` bytes of the file `head`, which may be this one: it is a new file all the same, since another
  /// name may lead to the old one.
  std::ofstream open_growing(const std::string& name, const std::string& head, std::uintmax_t length) const;
  const std::string& path() const { return path_; }
  std::string path_of(const std::string& name) const { return path_ + "/" + name; }

 private:
  /// The names that are listed, with the sum of what the file held where the analysis has ended.
  using OwnNames = std::map<std::string, std::optional<std::uint64_t>>;

  void remove(const std::string& name) const;
  bool has_own_scene_copy() const;
  OwnNames own_names() const;
  bool is_own(const OwnNames& own, const std::string& name) const;
  /// Throws InputError.
  void require_own(const OwnNames& own, const std::string& name) const;
  std::vector<std::string> used_names_there() const;
  std::vector<std::string> own_names_there() const;
  bool is_claimed() const;
  bool has_file(const std::string& name) const;
  bool is_own_picture(const std::string& name) const;
  bool is_list(const std::string& name) const;
  OwnNames listed_names() const;
  void write_list(const OwnNames& names) const;
  void list(const std::string& name) const;
  void claim_name(const std::string& name) const;
  void remove_format_files() const;
  /// Those that are there under names that a format gives, with its folder, as "vtk/a.vtu".
  std::vector<std::string> format_files() const;

  std::string path_;
};

}  // namespace openclose
