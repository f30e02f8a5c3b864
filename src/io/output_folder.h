// The folder a run writes to. Made, and tried, before anything is computed, so that a run is never lost to a folder that cannot be written.
#pragma once

#include <fstream>
#include <string>

namespace openclose {

class OutputFolder {
 public:
  /// Creates the folder if it is missing. Throws InputError if the files of a run cannot be written there.
  explicit OutputFolder(const std::string& path);

  /// A new file, replacing an old one of that name.
  std::ofstream open(const std::string& name) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Writes a whole file of its own, with the folders it needs. Throws InputError if it cannot be made.
void write_file(const std::string& path, const std::string& text);

/// Closes a file after its last line; throws std::runtime_error if anything of it was not written (a full disk, say).
void finish(std::ofstream& file, const std::string& name);

}  // namespace openclose
