// One analysis at a time in a folder: two would mix their tables.
#pragma once

#include <string>

namespace openclose {

/// Holds a folder until it is destroyed, or until its process ends in whatever way. Programs other than openclose do not notice.
class FolderLock {
 public:
  /// Throws InputError if another process holds the folder. Where the file system has no locks, or the folder may not be read, nothing is held.
  explicit FolderLock(const std::string& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

  /// Throws WriteError if another folder has this name by now: what has been written lies elsewhere, or nowhere.
  void require_same_folder() const;

 private:
  std::string folder_;
  int descriptor_;  ///< -1: nothing is held
};

}  // namespace openclose
