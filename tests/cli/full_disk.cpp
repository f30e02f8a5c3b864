// To be loaded before the C library (LD_PRELOAD): the disk is full under one file, whose path ends as FULL_DISK says, and under what it is called
// until it is complete. A link to /dev/full does not serve for that: openclose writes through no link.
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

bool is_full(int file) {
  const char* name = std::getenv("FULL_DISK");
  if (name == nullptr) return false;
  std::array<char, 4096> path{};
  const ssize_t length = readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path.data(), path.size());
  if (length <= 0) return false;
  std::string_view open(path.data(), static_cast<std::size_t>(length));
  constexpr std::string_view part = ".part";
  if (open.ends_with(part)) open.remove_suffix(part.size());
  return open.ends_with(std::string("/").append(name));
}

ssize_t no_space() {
  errno = ENOSPC;
  return -1;
}

}  // namespace

extern "C" ssize_t write(int file, const void* data, size_t size) {
  return is_full(file) ? no_space() : syscall(SYS_write, file, data, size);
}

extern "C" ssize_t writev(int file, const iovec* pieces, int count) {
  return is_full(file) ? no_space() : syscall(SYS_writev, file, pieces, count);
}
