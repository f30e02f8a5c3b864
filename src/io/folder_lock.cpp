#include "openclose/io/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "openclose/core/error.h"

namespace openclose {

FolderLock::FolderLock(const std::string& folder) : folder_(folder), descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw InputError({folder, 0}, "", "another openclose is writing to this folder", "-o with another folder, or to wait until that one has ended");
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void FolderLock::require_same_folder() const {
  if (descriptor_ < 0) return;
  struct stat held = {}, there = {};
  const bool is_same =
      ::fstat(descriptor_, &held) == 0 && ::stat(folder_.c_str(), &there) == 0 && held.st_dev == there.st_dev && held.st_ino == there.st_ino;
  if (!is_same) throw WriteError(folder_, "another folder has this name by now, or none: the results are not in it");
}

}  // namespace openclose
