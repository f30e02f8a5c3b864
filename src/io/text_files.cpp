#include "openclose/io/text_files.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/io/part_files.h"

namespace openclose {
namespace {

[[noreturn]] void fail_unwritable(const std::string& path) {
  throw InputError({path, 0}, "", "cannot be written", "a file in a folder that exists or can be made, and may be written to");
}

/// Whether it is as openclose has written a file of this kind: with a seal that holds, or, where its kind has none, with the same first line (the
/// columns of a table).
bool is_ours(const std::string& there, const TextFile& file) {
  if (there.empty()) return true;
  return file.seal == Seal::none ? first_line(there) == first_line(file.text) : is_sealed(there, file.seal);
}

void require_replaceable(const TextFile& file) {
  if (is_at(part_of(file.path)))
    throw InputError({part_of(file.path), 0}, "", "is there, and a file that is being written would have this name until it is complete",
                     "another name to write to, or none of this name: openclose leaves such a file where it is killed");
  if (!is_at(file.path) || file.replaces_ours) return;
  const std::string accepted = "the name of a new file, or of one that may be replaced";
  if (!is_regular_file(file.path) || access(file.path.c_str(), W_OK) != 0)
    throw InputError({file.path, 0}, "", "is there and cannot be written over", accepted);
  if (!is_ours(content_of(file.path), file))
    throw InputError({file.path, 0}, "",
                     "is there and has not been written by openclose" + std::string(file.seal == Seal::none ? "" : ", or edited since"), accepted);
}

/// Takes away what was begun and not finished: files that have not got their names yet, and folders made for them that are empty.
class Unfinished {
 public:
  Unfinished() = default;
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
  ~Unfinished() {
    std::error_code ignored;
    for (auto path = paths_.rbegin(); path != paths_.rend(); ++path) std::filesystem::remove(*path, ignored);
  }

  std::string add(const std::string& path) {
    paths_.emplace_back(path);
    return path;
  }

  void make_folders(const std::string& file) {
    std::vector<std::filesystem::path> missing;
    std::error_code error;
    for (std::filesystem::path folder = std::filesystem::path(file).parent_path(); !folder.empty() && !std::filesystem::exists(folder, error);
         folder = folder.parent_path()) {
      missing.push_back(folder);
    }
    for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
      if (!std::filesystem::create_directory(*folder, error) && error) fail_unwritable(file);
      paths_.push_back(*folder);
    }
  }

 private:
  std::vector<std::filesystem::path> paths_;
};

}  // namespace

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

void require_replaceable(const std::vector<TextFile>& files) {
  for (const TextFile& file : files) require_replaceable(file);
}

void remove_left_part(const std::string& path, std::string_view start) {
  const std::string there = content_of(part_of(path));
  std::error_code was_none;
  if (is_regular_file(part_of(path)) && start.starts_with(std::string_view(there).substr(0, start.size())))
    std::filesystem::remove(part_of(path), was_none);
}

void write_files(const std::vector<TextFile>& files) {
  require_replaceable(files);
  Unfinished unfinished;
  for (const TextFile& file : files) {
    unfinished.make_folders(file.path);
    const std::string part = part_of(file.path);
    if (!make_new(part)) fail_unwritable(file.path);
    std::ofstream stream(unfinished.add(part));
    stream << file.text << seal_of(file.text, file.seal);
    stream.close();
    if (!stream) throw WriteError(file.path);
  }
  for (const TextFile& file : files) {
    std::error_code error;
    std::filesystem::rename(part_of(file.path), file.path, error);
    if (error) throw WriteError(file.path);
  }
}

}  // namespace openclose
