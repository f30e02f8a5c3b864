#include "openclose/io/output_folder.h"

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
constexpr const char* last_results[] = {"block_properties.csv", "trials.csv",          "mechanism.csv", "curve.csv",  "milestones.csv",
                                        "summary.json",         "checkpoint.bin.part", "drawing.svg",   "report.html"};
/// Of these: what other commands write later. They name openclose where they begin.
constexpr std::string_view later_results[] = {"drawing.svg", "report.html"};
/// The first line of the scene that belongs to the results: a file of that name without it is somebody's own.
constexpr std::string_view scene_heading = "# The scene as openclose has read it. The next run here writes it anew: copy it before you change it.\n";

constexpr const char* list_heading = "# Names of results in this folder that openclose may replace and remove.";
constexpr const char* part_ending = ".part";

[[noreturn]] void fail_unwritable(const std::string& path) {
  throw InputError({path, 0}, "", "cannot be written", "a file in a folder that exists or can be made, and may be written to");
}

/// Of a system: what is written and removed in it would be anybody's.
bool is_root(const std::string& folder) {
  std::error_code unknown;
  const std::filesystem::path place = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), unknown);
  return !unknown && place == place.root_path();
}

/// The first line, or the first few of a file with long ones.
std::string beginning_of(const std::string& text) {
  constexpr std::size_t some_lines = 512;
  return text.substr(0, some_lines);
}

/// Whether a file of ours begins like this one: both name the program, or both have the same columns.
bool begins_as_ours(const std::string& there, const std::string& ours) {
  const auto names_us = [](const std::string& text) { return text.find("openclose") != std::string::npos; };
  return there.empty() || (names_us(there) && names_us(ours)) || there.substr(0, there.find('\n')) == ours.substr(0, ours.find('\n'));
}

void require_replaceable(const TextFile& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file.path, error);
  if (!std::filesystem::exists(status)) return;
  const std::string accepted = "the name of a new file, or of one that may be replaced";
  if (!std::filesystem::is_regular_file(status) || access(file.path.c_str(), W_OK) != 0)
    throw InputError({file.path, 0}, "", "is there and cannot be written over", accepted);
  std::ifstream stream(file.path, std::ios::binary);
  const std::string there{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!begins_as_ours(beginning_of(there), beginning_of(file.text)))
    throw InputError({file.path, 0}, "", "is there and has not been written by openclose", accepted);
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
  const auto require_replaceable_name = [&](const char* name) {
    const std::string file = path_of(name);
    if (!std::filesystem::exists(file)) return;
    if (std::filesystem::is_regular_file(file) && access(file.c_str(), W_OK) == 0) return;
    throw InputError({file, 0}, "", "is there and cannot be written over", "-o with another folder");
  };
  std::ranges::for_each(growing_results, require_replaceable_name);
  std::ranges::for_each(last_results, require_replaceable_name);
  require_replaceable_name(scene_copy_name);
}

bool OutputFolder::has_own_scene_copy() const {
  std::ifstream file(path_of(scene_copy_name), std::ios::binary);
  std::string heading(scene_heading.size(), ' ');
  return file.read(heading.data(), static_cast<std::streamsize>(heading.size())) && heading == scene_heading;
}

std::vector<std::string> OutputFolder::names_of_results() const {
  std::vector<std::string> names(std::begin(growing_results), std::end(growing_results));
  names.insert(names.end(), std::begin(last_results), std::end(last_results));
  names.emplace_back(scene_copy_name);
  for (const OutputFormat& format : output_formats()) names.push_back(std::string(format.name) + "/");
  return names;
}

std::vector<std::string> OutputFolder::own_names() const {
  std::ifstream list(path_of(list_name));
  // Earlier versions kept no list, and wrote the scene first.
  if (!list) return has_own_scene_copy() ? names_of_results() : std::vector<std::string>();
  std::vector<std::string> names;
  for (std::string name; std::getline(list, name);) names.push_back(name);
  return names;
}

void OutputFolder::claim(const std::vector<std::string>& read_files) const {
  require_ours(read_files);
  write_list(names_of_results());
}

void OutputFolder::require_ours(const std::vector<std::string>& read_files) const {
  const std::vector<std::string> own = own_names();
  for (const std::string& name : names_of_results()) {
    const std::string file = path_of(name);
    std::error_code unknown;
    if (!is_there(name)) continue;
    for (const std::string& read : read_files) {
      if (std::filesystem::equivalent(read, file, unknown))
        throw InputError({read, 0}, "", "is read, and a result of this name would replace it", "-o with another folder");
    }
    if (std::ranges::find(own, name) == own.end() && !is_own_picture(name))
      throw InputError({file, 0}, "", "is there and has not been written by openclose", "-o with another folder");
  }
}

void OutputFolder::list_results() const {
  std::vector<std::string> names = names_of_results();
  // What a killed run leaves unfinished under our own ending stays ours.
  std::erase_if(names, [&](const std::string& name) { return !is_there(name) && !name.ends_with(part_ending); });
  write_list(names);
}

bool OutputFolder::is_there(const std::string& name) const {
  std::error_code unknown;
  return name.back() == '/' ? !format_files(name).empty() : std::filesystem::exists(path_of(name), unknown);
}

bool OutputFolder::is_own_picture(const std::string& name) const {
  if (std::ranges::find(later_results, name) == std::end(later_results)) return false;
  std::ifstream file(path_of(name), std::ios::binary);
  return beginning_of({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()}).find("openclose") != std::string::npos;
}

void OutputFolder::write_list(const std::vector<std::string>& names) const {
  std::ofstream list = open(list_name);
  list << list_heading << '\n';
  for (const std::string& name : names) list << name << '\n';
  finish(list, path_of(list_name));
}

void OutputFolder::write_scene_copy(const std::string& text) const {
  std::ofstream file = open(scene_copy_name);
  file << scene_heading << text;
  finish(file, path_of(scene_copy_name));
}

void OutputFolder::remove(const char* name) const {
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
      if (std::regex_match(name, ours)) names.push_back(folder_name + name);
    }
  }
  return names;
}

void OutputFolder::remove_last_results() const {
  for (const char* name : last_results) remove(name);
  if (has_own_scene_copy()) remove(scene_copy_name);
  remove_format_files();
}

void OutputFolder::remove_format_files() const {
  for (const OutputFormat& format : output_formats()) {
    for (const std::string& name : format_files(std::string(format.name) + "/")) remove(name.c_str());
    // Only an empty folder goes.
    std::error_code error;
    std::filesystem::remove(path_of(format.name), error);
  }
}

void OutputFolder::write_format_file(const std::string& format, const std::string& name, const std::string& text) const {
  std::error_code error;
  std::filesystem::create_directories(path_of(format), error);
  const std::string in_folder = format + "/" + name;
  std::ofstream file = open(in_folder);
  file << text;
  finish(file, path_of(in_folder));
}

bool OutputFolder::has(const std::string& checkpoint_file) const {
  std::error_code unknown;
  return std::filesystem::equivalent(std::filesystem::absolute(checkpoint_file).parent_path(), path_, unknown) ||
         std::filesystem::equivalent(checkpoint_file, path_of(checkpoint_name), unknown);
}

std::ofstream OutputFolder::open(const std::string& name) const {
  std::ofstream file(path_of(name) + part_ending);
  if (!file) throw WriteError(path_of(name));
  return file;
}

std::ofstream OutputFolder::open_growing(const std::string& name) const {
  std::ofstream file(path_of(name));
  if (!file) throw WriteError(path_of(name));
  return file;
}

std::ofstream OutputFolder::open_growing(const std::string& name, const std::string& head, std::uintmax_t length) const {
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
  for (const TextFile& file : files) {
    if (!file.replaces_ours) require_replaceable(file);
  }
}

void write_files(const std::vector<TextFile>& files) {
  require_replaceable(files);
  Unfinished unfinished;
  for (const TextFile& file : files) {
    unfinished.make_folders(file.path);
    const std::string part = unfinished.add(file.path + part_ending);
    std::ofstream stream(part);
    if (!stream) fail_unwritable(file.path);
    stream << file.text;
    stream.close();
    if (!stream) throw WriteError(file.path);
  }
  for (const TextFile& file : files) {
    std::error_code error;
    std::filesystem::rename(file.path + part_ending, file.path, error);
    if (error) throw WriteError(file.path);
  }
}

void finish(std::ofstream& file, const std::string& path) {
  file.close();
  std::error_code error;
  if (!file) {
    std::filesystem::remove(path + part_ending, error);
    throw WriteError(path);
  }
  const bool is_part = std::filesystem::exists(path + part_ending, error);
  if (is_part) std::filesystem::rename(path + part_ending, path, error);
  if (error || !std::filesystem::exists(path, error)) throw WriteError(path, "has been removed while it was written");
}

}  // namespace openclose
