// What is at a path, as far as one can see: what lies in a folder that may not be searched is not there, and who writes to it is told why he cannot.
#pragma once

#include <filesystem>
#include <string>

namespace openclose {

inline bool is_there(const std::string& path) {
  std::error_code unknown;
  return std::filesystem::exists(path, unknown);
}

inline bool is_regular_file(const std::string& path) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(path, unknown);
}

inline bool is_folder(const std::string& path) {
  std::error_code unknown;
  return std::filesystem::is_directory(path, unknown);
}

/// As it is where the working directory is gone.
inline std::filesystem::path absolute_path(const std::string& path) {
  std::error_code unknown;
  const std::filesystem::path absolute = std::filesystem::absolute(path, unknown);
  return unknown ? std::filesystem::path(path) : absolute;
}

}  // namespace openclose
