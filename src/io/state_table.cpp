#include "openclose/io/state_table.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "openclose/core/error.h"

namespace openclose {

std::optional<double> finite_number(std::string_view field) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

double Row::number(std::size_t column) const {
  const std::optional<double> value = finite_number(fields_[column]);
  if (!value) refuse(column, fmt::format("\"{}\" is no finite number", fields_[column]), "a number, as openclose has written it");
  return *value;
}

void Row::refuse(std::size_t column, const std::string& read, const std::string& accepted) const {
  throw InputError({table_->path_, table_->number_of(line_)}, std::string(table_->names_[table_->columns_[column]]), read, accepted);
}

StateTable::StateTable(const std::string& path, const std::vector<std::string>& columns) : path_(path) {
  std::error_code unknown;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || !std::filesystem::is_regular_file(path, unknown)) return;
  text_.resize(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(text_.data(), static_cast<std::streamsize>(text_.size()));
  std::erase(text_, '\r');  // of an editor that ends lines so
  const std::string_view text = text_;
  const std::size_t heading = std::min(text.find('\n'), text.size());
  split(text.substr(0, heading), names_);
  for (const std::string& column : columns) {
    const auto place = std::ranges::find(names_, column);
    if (place == names_.end())
      throw InputError({path, 1}, "", fmt::format("there is no column {}", column),
                       "the table as this version of openclose writes it: run the scene again");
    columns_.push_back(static_cast<std::size_t>(place - names_.begin()));
  }
  std::size_t begin = std::min(heading + 1, text.size()), line = begin;
  std::string_view state;
  const auto close = [&](std::size_t end) {
    if (end > begin) states_.emplace_back(state), ranges_.push_back(text.substr(begin, end - begin));
    begin = end;
  };
  while (line < text.size()) {
    const std::size_t end = std::min(text.find('\n', line), text.size());
    const std::string_view row = text.substr(line, end - line), name = row.substr(0, row.find(','));
    if (name != state) {
      close(line);
      state = name;
    }
    line = std::min(end + 1, text.size());
  }
  close(line);
}

bool StateTable::has(const std::string& state) const {
  return std::ranges::find(states_, state) != states_.end();
}

void StateTable::split(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(',', begin);
    fields.push_back(line.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return;
    begin = end + 1;
  }
}

void StateTable::refuse_width(std::string_view line, std::size_t fields) const {
  throw InputError({path_, number_of(line)}, "", fmt::format("a row of {} fields", fields),
                   fmt::format("{} fields, as in the heading; a row that was cut off is no result", names_.size()));
}

int StateTable::number_of(std::string_view line) const {
  return 1 + static_cast<int>(std::count(text_.data(), line.data(), '\n'));
}

}  // namespace openclose
