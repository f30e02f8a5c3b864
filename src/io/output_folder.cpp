#include "openclose/io/output_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string_view>

#include "openclose/core/error.h"
#include "openclose/io/formats.h"

namespace openclose {
namespace {

/// What grows with an analysis, so that one that is broken off can go on from there.
constexpr const char* growing_results[] = {"history.csv",      "energy.csv", "blocks.csv",          "contacts.csv",
                                           "block_states.csv", "cracks.csv", "contact_history.csv", checkpoint_name};
/// What comes at its end.
constexpr const char* last_results[] = {"block_properties.csv", "trials.csv",   "mechanism.csv", "curve.csv",
                                        "milestones.csv",       "summary.json", "drawing.svg",   "report.html"};
/// Of these: what other commands write later. They have a seal.
constexpr std::string_view later_results[] = {"drawing.svg", "report.html"};
/// The first line of the scene that belongs to the results: a file of that name without it is somebody's own.
constexpr std::string_view scene_heading = "# The scene as openclose has read it. The next run here writes it anew: copy it before you change it.\n";

constexpr std::string_view list_heading = "# Names of results in this folder that openclose may replace and remove.";
constexpr std::string_view part_ending = ".part";

std::string part_of(std::string path) {
  return path += part_ending;
}

[[noreturn]] void fail_unwritable(const std::string& path) {
  throw InputError({path, 0}, "", "cannot be written", "a file in a folder that exists or can be made, and may be written to");
}

/// Of a system: what is written and removed in it would be anybody's.
bool is_root(const std::string& folder) {
  std::error_code unknown;
  const std::filesystem::path place = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), unknown);
  return !unknown && place == place.root_path();
}

/// Links that lead nowhere are there, too: what is written under their names would go where they lead.
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

/// Whether it is as openclose has written a file of this kind: with a seal that holds, or, where its kind has none, with the same first line (the
/// columns of a table).
bool is_ours(const std::string& there, const TextFile& file) {
  if (there.empty()) return true;
  return file.seal == Seal::none ? first_line(there) == first_line(file.text) : is_sealed(there, file.seal);
}

/// A file that was not there before, whatever is at its path by now. \return whether it could be made
bool make_new(const std::string& path) {
  constexpr mode_t as_streams_do = 0666;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, as_streams_do);
  return file >= 0 && ::close(file) == 0;
}

void require_replaceable(const TextFile& file) {
  if (is_at(part_of(file.path)))
    throw InputError({part_of(file.path), 0}, "", "is there, and a file that is being written would have this name until it is complete",
                     "another name to write to, or none of this name: openclose leaves such a file where it is killed");
  if (!is_at(file.path) || file.replaces_ours) return;
  const std::string accepted = "the name of a new file, or of one that may be replaced";
  if (!std::filesystem::is_regular_file(file.path) || access(file.path.c_str(), W_OK) != 0)
    throw InputError({file.path, 0}, "", "is there and cannot be written over", accepted);
  if (!is_ours(content_of(file.path), file))
    throw InputError({file.path, 0}, "",
                     "is there and has not been written by openclose" + std::string(file.seal == Seal::none ? "" : ", or edited since"), accepted);
}

/// All that results may be called, those of formats as a folder: its name with a stroke.
std::vector<std::string> names_of_results() {
  std::vector<std::string> names(std::begin(growing_results), std::end(growing_results));
  names.insert(names.end(), std::begin(last_results), std::end(last_results));
  names.emplace_back(scene_copy_name);
  for (const OutputFormat& format : output_formats()) names.push_back(std::string(format.name) + "/");
  return names;
}

/// With those that they have until they are complete, and with the list itself.
std::vector<std::string> names_that_are_used() {
  std::vector<std::string> names = names_of_results();
  names.emplace_back(list_name);
  const std::size_t whole = names.size();
  for (std::size_t i = 0; i < whole; ++i) {
    if (names[i].back() != '/') names.push_back(part_of(names[i]));
  }
  return names;
}

[[noreturn]] void fail_removed(const std::string& path) {
  throw WriteError(path, "has been removed while it was written");
}

/// In place of what is there, which is ours. \param path  that the file has when it is complete
std::ofstream open_new(const std::string& path, const std::string& path_until_then) {
  std::error_code unknown;
  std::filesystem::remove(path_until_then, unknown);
  if (!make_new(path_until_then)) throw WriteError(path);
  return std::ofstream(path_until_then);
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

void require_no_root(const std::string& folder) {
  if (is_root(folder)) throw InputError({folder, 0}, "-o", "this is the root of the file system", "a folder for the results of one analysis alone");
}

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  require_no_root(path_);
  std::error_code error;
  std::filesystem::create_directories(path, error);
  const bool usable = !error && std::filesystem::is_directory(path) && access(path.c_str(), W_OK | X_OK) == 0;
  if (!usable)
    throw InputError({path, 0}, "", "cannot write to this output folder", "-o with a folder that exists or can be made, and may be written to");
  const auto require_replaceable_name = [&](const std::string& name) {
    const std::string file = path_of(name);
    if (!std::filesystem::exists(file)) return;
    if (std::filesystem::is_regular_file(file) && access(file.c_str(), W_OK) == 0) return;
    throw InputError({file, 0}, "", "is there and cannot be written over", "-o with another folder");
  };
  for (const std::string& name : names_that_are_used()) {
    if (name.back() != '/') require_replaceable_name(name);
  }
}

bool OutputFolder::has_own_scene_copy() const {
  std::ifstream file(path_of(scene_copy_name), std::ios::binary);
  std::string heading(scene_heading.size(), ' ');
  return file.read(heading.data(), static_cast<std::streamsize>(heading.size())) && heading == scene_heading;
}

bool OutputFolder::is_claimed() const {
  return is_there(list_name);
}

std::vector<std::string> OutputFolder::own_names() const {
  // Earlier versions kept no list, and wrote the scene first.
  if (!is_claimed()) return has_own_scene_copy() ? names_of_results() : std::vector<std::string>();
  std::vector<std::string> names = listed_names();
  // What had this name until it was complete has got its own since, unless it is still there.
  const std::size_t listed = names.size();
  for (std::size_t i = 0; i < listed; ++i) {
    if (names[i].ends_with(part_ending) && !is_there(names[i])) names.push_back(names[i].substr(0, names[i].size() - part_ending.size()));
  }
  return names;
}

std::vector<std::string> OutputFolder::listed_names() const {
  std::vector<std::string> names;
  if (!is_list(list_name)) return names;
  std::ifstream list(path_of(list_name));
  for (std::string name; std::getline(list, name);) names.push_back(name);
  return names;
}

std::vector<std::string> OutputFolder::own_names_there() const {
  const std::vector<std::string> own = own_names();
  std::vector<std::string> names = names_that_are_used();
  std::erase_if(names, [&](const std::string& name) {
    return name == list_name || !is_there(name) || (std::ranges::find(own, name) == own.end() && !is_own_picture(name));
  });
  return names;
}

void OutputFolder::claim(const std::vector<std::string>& read_files) const {
  require_ours(read_files);
  write_list(own_names_there());
}

void OutputFolder::require_ours(const std::vector<std::string>& read_files) const {
  const std::vector<std::string> own = own_names();
  for (const std::string& name : names_that_are_used()) {
    const std::string file = path_of(name);
    std::error_code unknown;
    if (!is_there(name)) continue;
    for (const std::string& read : read_files) {
      if (std::filesystem::equivalent(read, file, unknown))
        throw InputError({read, 0}, "", "is read, and a result of this name would replace it", "-o with another folder");
    }
    if (std::ranges::find(own, name) == own.end() && !is_own_picture(name) && !is_list(name))
      throw InputError({file, 0}, "", "is there and has not been written by openclose", "-o with another folder");
  }
}

void OutputFolder::claim_name(const std::string& name) const {
  if (!is_claimed()) return;
  const std::vector<std::string> own = own_names();
  if (std::ranges::find(own, name) == own.end() && is_there(name))
    throw WriteError(path_of(name), "has come into the folder of results, and not from openclose: it stays, and no result takes its place");
  const std::vector<std::string> listed = listed_names();
  if (std::ranges::find(listed, name) == listed.end()) list(name);
}

std::string OutputFolder::claim_whole_file(const std::string& name) const {
  // Until the new file is complete, an old one has its name; where there is none, the name is ours with the complete file only.
  if (is_there(name)) claim_name(name);
  claim_name(part_of(name));
  return path_of(name);
}

void OutputFolder::list_results() const {
  write_list(own_names_there());
}

bool OutputFolder::is_there(const std::string& name) const {
  return name.back() == '/' ? !format_files(name).empty() : is_at(path_of(name));
}

bool OutputFolder::is_own_picture(const std::string& name) const {
  return std::ranges::find(later_results, name) != std::end(later_results) && is_sealed(content_of(path_of(name)), Seal::xml);
}

bool OutputFolder::is_list(const std::string& name) const {
  if (!name.starts_with(list_name)) return false;
  const std::string content = content_of(path_of(name));
  // A run that is killed while it makes its list leaves an empty one.
  return content.empty() || first_line(content) == list_heading;
}

void OutputFolder::write_list(const std::vector<std::string>& names) const {
  std::ofstream list = open_new(path_of(list_name), part_of(path_of(list_name)));
  list << list_heading << '\n';
  for (const std::string& name : names) list << name << '\n';
  finish(list, path_of(list_name));
}

void OutputFolder::list(const std::string& name) const {
  std::ofstream list(path_of(list_name), std::ios::app);
  list << name << '\n';
  list.close();
  std::error_code unknown;
  if (!list && !std::filesystem::is_directory(path_, unknown)) throw WriteError(path_of(list_name), "its folder has been removed");
  if (!list) throw WriteError(path_of(list_name));
}

std::map<std::string, std::uintmax_t> OutputFolder::table_sizes() const {
  std::map<std::string, std::uintmax_t> sizes;
  for (const std::string& name : names_of_results()) {
    std::error_code missing;
    const std::uintmax_t size = name.ends_with(".csv") ? std::filesystem::file_size(path_of(name), missing) : 0;
    if (name.ends_with(".csv") && !missing) sizes.emplace(name, size);
  }
  return sizes;
}

void OutputFolder::write_scene_copy(const std::string& text) const {
  std::ofstream file = open(scene_copy_name);
  file << scene_heading << text;
  finish(file, path_of(scene_copy_name));
}

void OutputFolder::remove(const std::string& name) const {
  std::error_code error;
  std::filesystem::remove(path_of(name), error);
  if (error) throw WriteError(path_of(name), "is there from an earlier run and cannot be removed");
}

void OutputFolder::remove_results() const {
  for (const char* name : growing_results) remove(name);
  remove_last_results();
}

std::vector<std::string> OutputFolder::format_files(const std::string& folder_name) const {
  std::vector<std::string> names;
  for (const OutputFormat& format : output_formats()) {
    if (std::string(format.name) + "/" != folder_name) continue;
    const std::regex ours(format.files);
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(path_of(format.name), error)) {
      const std::string name = entry.path().filename().string();
      const std::string whole = name.ends_with(part_ending) ? name.substr(0, name.size() - part_ending.size()) : name;
      if (std::regex_match(whole, ours)) names.push_back(folder_name + name);
    }
  }
  return names;
}

void OutputFolder::remove_last_results() const {
  for (const char* name : last_results) remove(name);
  if (has_own_scene_copy()) remove(scene_copy_name);
  for (const std::string& name : own_names()) {
    if (name.ends_with(part_ending)) remove(name);
  }
  remove_format_files();
}

void OutputFolder::remove_format_files() const {
  for (const OutputFormat& format : output_formats()) {
    for (const std::string& name : format_files(std::string(format.name) + "/")) remove(name);
    // Only an empty folder goes.
    std::error_code error;
    std::filesystem::remove(path_of(format.name), error);
  }
}

void OutputFolder::write_format_file(const std::string& format, const std::string& name, const std::string& text) const {
  std::error_code error;
  claim_name(format + "/");
  std::filesystem::create_directories(path_of(format), error);
  const std::string path = path_of(format + "/" + name);
  std::ofstream file = open_new(path, part_of(path));
  file << text;
  finish(file, path);
}

bool OutputFolder::has(const std::string& checkpoint_file) const {
  std::error_code unknown;
  return std::filesystem::equivalent(std::filesystem::absolute(checkpoint_file).parent_path(), path_, unknown) ||
         std::filesystem::equivalent(checkpoint_file, path_of(checkpoint_name), unknown);
}

std::ofstream OutputFolder::open(const std::string& name) const {
  const std::string path = claim_whole_file(name);
  return open_new(path, part_of(path));
}

std::ofstream OutputFolder::open_growing(const std::string& name) const {
  claim_name(name);
  return open_new(path_of(name), path_of(name));
}

std::ofstream OutputFolder::open_growing(const std::string& name, const std::string& head, std::uintmax_t length) const {
  claim_name(name);
  const std::string full = path_of(name);
  std::error_code error, differs;
  if (!std::filesystem::equivalent(head, full, differs))
    std::filesystem::copy_file(head, full, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) std::filesystem::resize_file(full, length, error);
  std::ofstream file(full, std::ios::app);
  if (error || !file) throw WriteError(full);
  return file;
}

void require_replaceable(const std::vector<TextFile>& files) {
  for (const TextFile& file : files) require_replaceable(file);
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

void finish(std::ofstream& file, const std::string& path) {
  file.close();
  std::error_code error;
  if (!file) {
    std::filesystem::remove(part_of(path), error);
    throw WriteError(path);
  }
  std::filesystem::rename(part_of(path), path, error);
  if (error) fail_removed(path);
}

void finish_growing(std::ofstream& file, const std::string& path) {
  file.close();
  if (!file) throw WriteError(path);
  if (!is_at(path)) fail_removed(path);
}

}  // namespace openclose
