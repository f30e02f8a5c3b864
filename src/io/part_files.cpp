#include "openclose/io/part_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>

#include "openclose/core/error.h"

namespace openclose {
namespace {

[[noreturn]] void fail_removed(const std::string& path) {
  throw WriteError(path, "has been removed while it was written");
}

}  // namespace

std::string part_of(std::string path) {
  return path += part_ending;
}

bool is_at(const std::string& path) {
  std::error_code unknown;
  return std::filesystem::exists(std::filesystem::symlink_status(path, unknown));
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

bool make_new(const std::string& path) {
  constexpr mode_t as_streams_do = 0666;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, as_streams_do);
  return file >= 0 && ::close(file) == 0;
}

std::ofstream open_new(const std::string& path, const std::string& path_until_then) {
  std::error_code unknown;
  std::filesystem::remove(path_until_then, unknown);
  if (!make_new(path_until_then)) throw WriteError(path);
  return std::ofstream(path_until_then);
}

void finish(std::ofstream& file, const std::string& path) {
  file.close();
  // The part stays: its name is listed, and the next analysis removes it. Without it, it would look as if it had got its own name.
  if (!file) throw WriteError(path);
  std::error_code error;
  std::filesystem::rename(part_of(path), path, error);
  if (error) fail_removed(path);
}

void finish_growing(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) throw WriteError(path);
  if (!is_at(path)) fail_removed(path);
}

}  // namespace openclose
