#include "openclose/io/output_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <regex>
#include <string_view>

#include "openclose/core/check_sum.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/io/formats.h"
#include "openclose/io/seal.h"

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

/// Of a system: what is written and removed in it would be anybody's.
bool is_root(const std::string& folder) {
  std::error_code unknown;
  const std::filesystem::path place = std::filesystem::weakly_canonical(absolute_path(folder), unknown);
  return !unknown && place == place.root_path();
}

/// All that results may be called, but for the files of formats.
std::vector<std::string> names_of_results() {
  std::vector<std::string> names(std::begin(growing_results), std::end(growing_results));
  names.insert(names.end(), std::begin(last_results), std::end(last_results));
  names.emplace_back(scene_copy_name);
  return names;
}

/// With those that they have until they are complete, and with the list itself.
std::vector<std::string> names_that_are_used() {
  std::vector<std::string> names = names_of_results();
  names.emplace_back(list_name);
  const std::size_t whole = names.size();
  for (std::size_t i = 0; i < whole; ++i) names.push_back(part_of(names[i]));
  return names;
}

/// What a file of a format stands for in lists of earlier versions: its folder, with a stroke. Empty for other files.
std::string folder_of(const std::string& name) {
  return name.substr(0, name.find('/') + 1);
}

/// Its files are listed one by one: what is no folder, or cannot be looked into, holds what nobody knows.
void require_folder_of_format(const std::string& path) {
  std::error_code missing, unreadable;
  const std::filesystem::file_status status = std::filesystem::symlink_status(path, missing);
  if (!std::filesystem::exists(status)) return;
  if (std::filesystem::is_directory(status)) std::filesystem::directory_iterator(path, unreadable);
  // What is in it is replaced and removed, and what stands before that is removed first.
  const bool can_change = access(path.c_str(), R_OK | W_OK | X_OK) == 0;
  if (!std::filesystem::is_directory(status) || unreadable || !can_change)
    throw InputError({path, 0}, "", "is no folder that can be read and written to", "-o with another folder, or that one in another place");
}

std::uint64_t sum_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  constexpr std::size_t part = 1 << 16;  // [B] read at a time
  std::string bytes(part, '\0');
  std::uint64_t sum = empty_check_sum;
  while (file.read(bytes.data(), static_cast<std::streamsize>(part)) || file.gcount() > 0)
    sum = check_sum(std::string_view(bytes).substr(0, static_cast<std::size_t>(file.gcount())), sum);
  return sum;
}

[[noreturn]] void fail_come_in(const std::string& path) {
  throw WriteError(path, "has come into the folder of results, and not from openclose: it stays, and no result takes its place");
}

}  // namespace

void require_no_root(const std::string& folder) {
  if (is_root(folder)) throw InputError({folder, 0}, "-o", "this is the root of the file system", "a folder for the results of one analysis alone");
}

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  require_no_root(path_);
  std::error_code error;
  std::filesystem::create_directories(path, error);
  const bool usable = !error && is_folder(path) && access(path.c_str(), W_OK | X_OK) == 0;
  if (!usable)
    throw InputError({path, 0}, "", "cannot write to this output folder", "-o with a folder that exists or can be made, and may be written to");
  const auto require_replaceable_name = [&](const std::string& name) {
    const std::string file = path_of(name);
    if (!is_there(file)) return;
    if (is_regular_file(file) && access(file.c_str(), W_OK) == 0) return;
    throw InputError({file, 0}, "", "is there and cannot be written over", "-o with another folder");
  };
  for (const std::string& name : names_that_are_used()) require_replaceable_name(name);
  for (const std::string& name : format_files()) require_replaceable_name(name);
}

bool OutputFolder::has_own_scene_copy() const {
  std::ifstream file(path_of(scene_copy_name), std::ios::binary);
  std::string heading(scene_heading.size(), ' ');
  return file.read(heading.data(), static_cast<std::streamsize>(heading.size())) && heading == scene_heading;
}

bool OutputFolder::is_claimed() const {
  return has_file(list_name);
}

OutputFolder::OwnNames OutputFolder::own_names() const {
  OwnNames names = listed_names();
  // What had this name until it was complete has got its own since, unless it is still there.
  std::vector<std::string> complete;
  for (const auto& [name, sum] : names) {
    if (name.ends_with(part_ending) && !has_file(name)) complete.push_back(name.substr(0, name.size() - part_ending.size()));
  }
  for (const std::string& name : complete) names[name] = std::nullopt;
  return names;
}

OutputFolder::OwnNames OutputFolder::listed_names() const {
  OwnNames names;
  if (!is_list(list_name)) return names;
  std::ifstream list(path_of(list_name));
  for (std::string line; std::getline(list, line);) {
    if (line.empty()) continue;
    const std::size_t space = line.find(' ');
    if (space == std::string::npos) {
      // Its file has been made anew since its sum was listed.
      names[line] = std::nullopt;
      continue;
    }
    std::uint64_t sum = 0;
    constexpr int hexadecimal = 16;
    const bool is_sum = std::from_chars(line.data() + space + 1, line.data() + line.size(), sum, hexadecimal).ec == std::errc();
    if (is_sum) names[line.substr(0, space)] = sum;
  }
  return names;
}

std::vector<std::string> OutputFolder::used_names_there() const {
  std::vector<std::string> names = names_that_are_used();
  std::erase_if(names, [&](const std::string& name) { return !has_file(name); });
  const std::vector<std::string> of_formats = format_files();
  names.insert(names.end(), of_formats.begin(), of_formats.end());
  return names;
}

bool OutputFolder::is_own(const OwnNames& own, const std::string& name) const {
  return own.contains(name) || own.contains(folder_of(name)) || is_own_picture(name);
}

std::vector<std::string> OutputFolder::own_names_there() const {
  const OwnNames own = own_names();
  std::vector<std::string> names = used_names_there();
  std::erase_if(names, [&](const std::string& name) { return name == list_name || !is_own(own, name); });
  return names;
}

void OutputFolder::claim(const std::vector<std::string>& read_files) const {
  require_ours(read_files);
  forget_removed();
}

void OutputFolder::require_own(const OwnNames& own, const std::string& name) const {
  const std::string accepted = "-o with another folder, or that file in another place";
  if (!is_own(own, name) && !is_list(name)) throw InputError({path_of(name), 0}, "", "is there and has not been written by openclose", accepted);
  const auto listed = own.find(name);
  // What draw and report have written later has a sum of its own.
  if (listed == own.end() || !listed->second || is_own_picture(name) || sum_of(path_of(name)) == *listed->second) return;
  throw InputError({path_of(name), 0}, "", "has been changed since openclose has written it, and a result would replace it", accepted);
}

void OutputFolder::require_ours(const std::vector<std::string>& read_files) const {
  for (const OutputFormat& format : output_formats()) require_folder_of_format(path_of(format.name));
  const OwnNames own = own_names();
  for (const std::string& name : used_names_there()) {
    for (const std::string& read : read_files) {
      std::error_code unknown;
      if (std::filesystem::equivalent(read, path_of(name), unknown))
        throw InputError({read, 0}, "", "is read, and a result of this name would replace it", "-o with another folder");
    }
    require_own(own, name);
  }
}

void OutputFolder::claim_name(const std::string& name) const {
  if (!is_claimed()) return;
  // Looked for once more: the folder may have gone in between.
  if (has_file(name) && !is_own(own_names(), name) && has_file(name)) fail_come_in(path_of(name));
  const OwnNames listed = listed_names();
  const auto place = listed.find(name);
  if (place == listed.end() || place->second) list(name);
}

std::string OutputFolder::claim_whole_file(const std::string& name) const {
  // Until the new file is complete, an old one has its name; where there is none, the name is ours with the complete file only.
  if (has_file(name)) claim_name(name);
  claim_name(part_of(name));
  return path_of(name);
}

void OutputFolder::forget_removed() const {
  const OwnNames own = own_names();
  OwnNames names;
  for (const std::string& name : own_names_there()) {
    const auto listed = own.find(name);
    names.emplace(name, listed == own.end() ? std::nullopt : listed->second);
  }
  write_list(names);
}

void OutputFolder::list_results() const {
  OwnNames names;
  for (const std::string& name : own_names_there()) names.emplace(name, sum_of(path_of(name)));
  write_list(names);
}

bool OutputFolder::has_file(const std::string& name) const {
  return is_at(path_of(name));
}

bool OutputFolder::is_own_picture(const std::string& name) const {
  return std::ranges::find(later_results, name) != std::end(later_results) && is_sealed(content_of(path_of(name)), Seal::xml);
}

bool OutputFolder::is_list(const std::string& name) const {
  if (!name.starts_with(list_name)) return false;
  const std::string content = content_of(path_of(name));
  // A run that is killed while it makes its list, or whose disk is full, leaves an empty one or the beginning of one.
  return first_line(content) == list_heading || list_heading.starts_with(content);
}

void OutputFolder::write_list(const OwnNames& names) const {
  std::ofstream list = open_new(path_of(list_name), part_of(path_of(list_name)));
  list << list_heading << '\n';
  for (const auto& [name, sum] : names) list << name << (sum ? fmt::format(" {:016x}", *sum) : "") << '\n';
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
  // First what needs the others: whoever is killed here leaves no checkpoint without its tables.
  remove(checkpoint_name);
  for (const char* name : growing_results) remove(name);
  remove_last_results();
}

std::vector<std::string> OutputFolder::format_files() const {
  std::vector<std::string> names;
  for (const OutputFormat& format : output_formats()) {
    const std::regex ours(format.files);
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(path_of(format.name), error)) {
      const std::string name = entry.path().filename().string();
      const std::string whole = name.ends_with(part_ending) ? name.substr(0, name.size() - part_ending.size()) : name;
      if (std::regex_match(whole, ours)) names.push_back(fmt::format("{}/{}", format.name, name));
    }
  }
  return names;
}

void OutputFolder::remove_last_results() const {
  for (const char* name : last_results) remove(name);
  if (has_own_scene_copy()) remove(scene_copy_name);
  for (const auto& [name, sum] : own_names()) {
    if (name.ends_with(part_ending)) remove(name);
  }
  remove_format_files();
}

void OutputFolder::remove_format_files() const {
  const OwnNames own = own_names();
  for (const std::string& name : format_files()) {
    if (!is_claimed() || is_own(own, name)) remove(name);
  }
  // Only an empty folder goes, and nothing else of this name.
  for (const OutputFormat& format : output_formats()) ::rmdir(path_of(format.name).c_str());
}

void OutputFolder::write_format_file(const std::string& format, const std::string& name, const std::string& text) const {
  std::error_code error;
  std::filesystem::create_directories(path_of(format), error);
  const std::string path = path_of(format + "/" + name);
  // Those of an earlier analysis have been removed, and this one writes each of them once: there may be thousands, and none needs to be looked up.
  if (is_claimed()) {
    if (is_at(path)) fail_come_in(path);
    if (is_at(part_of(path))) fail_come_in(part_of(path));
    list(part_of(format + "/" + name));
  }
  std::ofstream file = open_new(path, part_of(path));
  file << text;
  finish(file, path);
}

bool OutputFolder::has(const std::string& checkpoint_file) const {
  std::error_code unknown;
  return std::filesystem::equivalent(absolute_path(checkpoint_file).parent_path(), path_, unknown) ||
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
  const std::string full = claim_whole_file(name);
  std::error_code error;
  std::filesystem::remove(part_of(full), error);
  std::filesystem::copy_file(head, part_of(full), error);
  // Of a file that may only be read the copy is one, too.
  if (!error) std::filesystem::permissions(part_of(full), std::filesystem::perms::owner_write, std::filesystem::perm_options::add, error);
  if (!error) std::filesystem::resize_file(part_of(full), length, error);
  if (!error) std::filesystem::rename(part_of(full), full, error);
  std::ofstream file(full, std::ios::app);
  if (!error && file) return file;
  std::filesystem::remove(part_of(full), error);
  throw WriteError(full);
}

}  // namespace openclose
