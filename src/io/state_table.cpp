#include "openclose/io/state_table.h"

#include <algorithm>
#include <charconv>
#include <fstream>

namespace openclose {

double number_in(std::string_view field) {
  double value = 0.0;
  std::from_chars(field.data(), field.data() + field.size(), value);
  return value;
}

StateTable::StateTable(const std::string& path, const std::vector<std::string>& columns) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return;
  text_.resize(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(text_.data(), static_cast<std::streamsize>(text_.size()));
  const std::string_view text = text_;
  const std::size_t heading = text.find('\n');
  if (!file || heading == std::string_view::npos) return;
  Row names;
  split(text.substr(0, heading), names);
  width_ = names.size();
  for (const std::string& column : columns) {
    const auto place = std::ranges::find(names, column);
    if (place == names.end()) return;
    columns_.push_back(static_cast<std::size_t>(place - names.begin()));
  }
  std::size_t begin = heading + 1, line = begin;
  std::string_view state;
  const auto close = [&](std::size_t end) {
    if (end > begin) states_.emplace_back(state), ranges_.push_back(text.substr(begin, end - begin));
    begin = end;
  };
  while (line < text.size()) {
    const std::size_t end = text.find('\n', line);
    if (end == std::string_view::npos) break;
    const std::string_view row = text.substr(line, end - line), name = row.substr(0, row.find(','));
    if (name != state) {
      close(line);
      state = name;
    }
    line = end + 1;
  }
  close(line);
}

bool StateTable::has(const std::string& state) const {
  return std::ranges::find(states_, state) != states_.end();
}

void StateTable::split(std::string_view line, Row& fields) {
  fields.clear();
  for (std::size_t begin = 0;;) {
    const std::size_t end = line.find(',', begin);
    fields.push_back(line.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return;
    begin = end + 1;
  }
}

}  // namespace openclose
