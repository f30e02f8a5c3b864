#include "openclose/io/output_folder.h"

#include <unistd.h>

#include <filesystem>
#include <stdexcept>

#include "openclose/core/error.h"

namespace openclose {

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  const bool usable = !error && std::filesystem::is_directory(path) && access(path.c_str(), W_OK | X_OK) == 0;
  if (!usable)
    throw InputError({path, 0}, "", "cannot write to this output folder", "-o with a folder that exists or can be made, and may be written to");
  for (const char* name : {"history.csv", "energy.csv", "blocks.csv", "contacts.csv", "trials.csv", "curve.csv", "milestones.csv", "summary.json"}) {
    const std::string file = path + "/" + name;
    if (!std::filesystem::exists(file)) continue;
    if (std::filesystem::is_regular_file(file) && access(file.c_str(), W_OK) == 0) continue;
    throw InputError({file, 0}, "", "is there and cannot be written over", "-o with another folder");
  }
}

std::ofstream OutputFolder::open(const std::string& name) const {
  const std::string full = path_ + "/" + name;
  std::ofstream file(full);
  if (!file) throw InputError({full, 0}, "", "cannot be written", "an output folder in which files can be made");
  return file;
}

void write_file(const std::string& path, const std::string& text) {
  const std::filesystem::path place(path);
  const OutputFolder folder(place.has_parent_path() ? place.parent_path().string() : ".");
  std::ofstream file = folder.open(place.filename().string());
  file << text;
  finish(file, path);
}

void finish(std::ofstream& file, const std::string& name) {
  file.close();
  if (!file) throw std::runtime_error("writing " + name + " failed: is the disk full?");
}

}  // namespace openclose
