// The folder a run writes to. Made, and tried, before anything is computed, so that a run is never lost to a folder that cannot be written.
//
// A folder that is claimed keeps a list of the names that results have got there: what stands there under a name that results may get and is not
// listed is somebody else's, and the folder is refused. A name is listed when its file is made, so that a run that is killed claims no more than it
// has written. Files that are written as a whole get their names when they are complete; until then these end in ".part".
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "openclose/io/seal.h"

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
  /// if a name that results may get is a file that is read, or one that openclose has not written; nothing has changed then.
  void claim(const std::vector<std::string>& read_files) const;
  /// Throws as claim() would, and changes nothing.
  void require_ours(const std::vector<std::string>& read_files) const;
  /// A file of this name is about to be written as a whole. Throws WriteError if somebody else has put one there since the folder was claimed.
  /// Changes nothing in a folder that nobody has claimed. \return its path
  std::string claim_whole_file(const std::string& name) const;
  /// The analysis is over: from now on only those of the listed names are ours that are there.
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
  /// The same, but beginning with the first `length` bytes of the file `head`, which may be this one.
  std::ofstream open_growing(const std::string& name, const std::string& head, std::uintmax_t length) const;
  const std::string& path() const { return path_; }
  std::string path_of(const std::string& name) const { return path_ + "/" + name; }

 private:
  void remove(const std::string& name) const;
  bool has_own_scene_copy() const;
  std::vector<std::string> own_names() const;
  std::vector<std::string> own_names_there() const;
  bool is_claimed() const;
  bool is_there(const std::string& name) const;
  bool is_own_picture(const std::string& name) const;
  bool is_list(const std::string& name) const;
  std::vector<std::string> listed_names() const;
  void write_list(const std::vector<std::string>& names) const;
  void list(const std::string& name) const;
  void claim_name(const std::string& name) const;
  void remove_format_files() const;
  /// With the folder, as "vtk/a.vtu"; of the one of this name, which ends with a stroke.
  std::vector<std::string> format_files(const std::string& folder_name) const;

  std::string path_;
};

struct TextFile {
  std::string path;
  std::string text;
  bool replaces_ours = false;  ///< the caller has looked at what stands there: openclose has written it
  Seal seal = Seal::none;      ///< its last line, which is added to the text
};

/// Writes whole files, with the folders they need: all of them, or none and no folder. Old ones are replaced only when all new ones are complete;
/// until then these have ".part" after their names. Throws InputError if a file cannot be made, if something with its name and ".part" is there, or
/// if it is there and is not as openclose has written it, which its seal tells, or its first line where it has none; WriteError if one cannot be
/// written to its end.
void write_files(const std::vector<TextFile>& files);

/// Throws InputError as write_files() would of files with such seals, or that begin like these: to be asked before anything is computed.
void require_replaceable(const std::vector<TextFile>& files);

/// Closes a file after its last line and gives it its name; throws WriteError if anything of it was not written (a full disk, say) or if the file has
/// been removed.
void finish(std::ofstream& file, const std::string& path);
/// The same for a file that has had its name from the beginning.
void finish_growing(std::ofstream& file, const std::string& path);

}  // namespace openclose
