#include "openclose/io/result_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include "openclose/core/error.h"
#include "openclose/core/files.h"

namespace openclose {
namespace {

using nlohmann::json;

/// The state that every analysis begins with, and the one that every run has at its end, but no factor of safety.
constexpr const char* drawn_state = "initial";
constexpr const char* end_of_run = "final";
constexpr const char* accepted_folder = "the folder of a run or fos, results/<name of the scene> by default";

std::string require_folder(const std::string& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder, error)) throw InputError({folder, 0}, "", "there is no such folder", accepted_folder);
  if (!std::filesystem::is_directory(folder, error)) throw InputError({folder, 0}, "", "this is no folder", accepted_folder);
  return folder;
}

/// Of the cases of a study or sweep the first one by its name.
std::string first_case(const std::string& folder) {
  std::string first;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().string();
    if (std::filesystem::exists(entry.path() / "summary.json", error) && (first.empty() || name < first)) first = name;
  }
  return first;
}

void require_no_cases(const std::string& folder) {
  for (const char* command : {"study", "sweep"}) {
    std::error_code error;
    if (!std::filesystem::exists(folder + "/" + command + ".csv", error)) continue;
    const std::string one = first_case(folder);
    throw InputError({folder, 0}, "", fmt::format("this is a folder of {}", command),
                     "the folder of one of its cases" + (one.empty() ? "" : ", e.g. " + one));
  }
}

json read_summary(const std::string& folder) {
  const std::string path = folder + "/summary.json";
  std::ifstream file(path);
  if (!file) require_no_cases(folder);
  if (!file)
    throw InputError({path, 0}, "", "there is no such file", "the folder of a run or fos that has ended; it writes its summary when it ends");
  json summary = json::parse(file, nullptr, false);
  if (!summary.is_object()) throw InputError({path, 0}, "", "this is not JSON", "the file as openclose has written it");
  return summary;
}

}  // namespace

BlockIndex::BlockIndex(std::string file, const std::vector<std::string>& names) : file_(std::move(file)) {
  for (const std::string& name : names) of_.emplace(name, static_cast<int>(of_.size()));
}

int BlockIndex::of(const Row& row, std::size_t column) const {
  const auto place = of_.find(std::string(row[column]));
  if (place == of_.end()) row.refuse(column, fmt::format("there is no block \"{}\"", row[column]), "the name of a block in " + file_);
  return place->second;
}

int BlockIndex::of(const json& entry, const std::string& summary_file) const {
  const std::string name = entry.at("block").get<std::string>();
  const auto place = of_.find(name);
  if (place == of_.end())
    throw InputError({summary_file, 0}, "block", fmt::format("there is no block \"{}\"", name), "the name of a block in " + file_);
  return place->second;
}

ResultFolder::ResultFolder(const std::string& folder)
    : folder_(require_folder(folder)), summary_(read_summary(folder_)), outlines_(path_of("blocks.csv"), {"block", "x_m", "y_m"}) {
  require_summary();
  is_factor_ = summary_.at("command") == "fos";
  require_states();
  drawing_ = read(drawn_state);
  const std::size_t blocks = summary_.at("blocks").get<std::size_t>();
  if (drawing_.names.size() != blocks)
    throw InputError({outlines_.path(), 0}, "", fmt::format("it has {} blocks", drawing_.names.size()),
                     fmt::format("the {} blocks that summary.json beside it tells of", blocks));
}

/// What everything else takes for granted.
void ResultFolder::require_summary() const {
  const bool has_command = summary_.contains("command") && (summary_["command"] == "run" || summary_["command"] == "fos");
  if (!has_command || !summary_.contains("blocks") || !summary_["blocks"].is_number_unsigned())
    throw InputError({path_of("summary.json"), 0}, "", "this is not what openclose writes of a run or fos",
                     "the results of this version of openclose");
}

void ResultFolder::require_states() const {
  const SourceLocation where = {outlines_.path(), 0};
  if (states().empty()) throw InputError(where, "", is_there(where.file) ? "no state is written there" : "there is no such file", accepted_folder);
  if (!has(drawn_state)) throw InputError(where, "", "the drawing is not written there", accepted_folder);
  if (is_factor_ == has(end_of_run))
    throw InputError(where, "", fmt::format("these are not the states of {}, which summary.json beside it tells of", is_factor_ ? "fos" : "a run"),
                     "the tables of one analysis");
}

void ResultFolder::require_whole_tables() const {
  for (const auto& [name, told] : summary_.at("table_bytes").items()) {
    const std::string path = path_of(name);
    std::error_code missing;
    const std::uintmax_t there = std::filesystem::file_size(path, missing), bytes = told.get<std::uintmax_t>();
    const std::string accepted = fmt::format("the table of {} bytes that summary.json beside it tells of: run the scene again", bytes);
    if (missing) throw InputError({path, 0}, "", "there is no such file", accepted);
    if (there == bytes) continue;
    std::ifstream file(path, std::ios::binary);
    const auto carriage_returns =
        static_cast<std::uintmax_t>(std::count(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>(), '\r'));
    if (there - carriage_returns != bytes)
      throw InputError({path, 0}, "", fmt::format("it has {} bytes: cut off, changed or of another analysis", there), accepted);
  }
}

std::string ResultFolder::name() const {
  return std::filesystem::path(folder_ + "/").lexically_normal().parent_path().filename().string();
}

std::vector<Polygon> ResultFolder::outlines(const std::string& state) const {
  Outlines now = read(state);
  const std::size_t common = std::min(now.names.size(), drawing_.names.size());
  std::size_t same = 0;
  while (same < common && now.names[same] == drawing_.names[same] && now.polygons[same].size() == drawing_.polygons[same].size()) ++same;
  if (same < std::max(now.names.size(), drawing_.names.size())) {
    const std::string& name = same < drawing_.names.size() ? drawing_.names[same] : now.names[same];
    throw InputError({outlines_.path(), 0}, "", fmt::format("block \"{}\" is not the same in the states \"{}\" and \"{}\"", name, drawn_state, state),
                     "the same blocks and vertices in every state, as openclose has written them");
  }
  return std::move(now.polygons);
}

Outlines ResultFolder::read(const std::string& state) const {
  Outlines list;
  outlines_.rows(state, [&](const Row& row) {
    if (list.names.empty() || row[0] != list.names.back()) {
      list.names.emplace_back(row[0]);
      list.polygons.emplace_back();
    }
    list.polygons.back().emplace_back(row.number(1), row.number(2));
  });
  return list;
}

}  // namespace openclose
