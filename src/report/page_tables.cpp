#include "openclose/report/page_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "openclose/core/error.h"
#include "openclose/io/state_table.h"
#include "openclose/io/vtk.h"

namespace openclose {
namespace {

using nlohmann::json;

/// Of a curve, more rows than a screen has pixels in a line.
constexpr std::size_t most_rows = 2000;
/// Curves in one picture that can still be told apart by their colours.
constexpr std::size_t most_curves = 12;
constexpr const char* as_written = "the table as openclose wrote it";
/// [bytes] Of the scene as it was read; a longer one is shown without its blocks.
constexpr std::size_t longest_scene = 200'000;

/// The fields of a line of a table, of which some may be quoted.
std::vector<std::string> csv_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
        fields.back() += line[++i];
      } else {
        quoted = !quoted;
      }
    } else if (line[i] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

/// The rows of a table by their curves. A last row that was not written to its end is left out. Throws InputError for a damaged one.
struct Curves {
  std::vector<std::string> columns;
  std::vector<std::string> names;                               ///< in the order of the file
  std::map<std::string, std::vector<std::vector<float>>> rows;  ///< by name; NaN for a field that is no number

  Curves(const std::string& path, const std::string& key) {
    std::ifstream file(path);
    std::string line;
    if (!std::getline(file, line)) return;
    if (line.ends_with('\r')) line.pop_back();
    columns = csv_fields(line);
    const auto key_place = static_cast<std::size_t>(std::ranges::find(columns, key) - columns.begin());
    for (int number = 2; std::getline(file, line); ++number) {
      if (line.ends_with('\r')) line.pop_back();
      const std::vector<std::string> fields = csv_fields(line);
      if (file.eof()) break;  // cut off before the end of its line
      if (fields.size() != columns.size())
        throw InputError({path, number}, "", fmt::format("a row of {} fields", fields.size()), fmt::format("the {} of the heading", columns.size()));
      const std::string name = key_place < fields.size() ? fields[key_place] : std::string();
      auto [place, is_new] = rows.try_emplace(name);
      if (is_new) names.push_back(name);
      std::vector<float>& row = place->second.emplace_back();
      for (std::size_t k = 0; k < fields.size(); ++k) {
        if (k != key_place) row.push_back(value_of(fields[k], columns[k], {path, number}));
      }
    }
    if (key_place < columns.size()) columns.erase(columns.begin() + static_cast<std::ptrdiff_t>(key_place));
  }

  /// Nothing and what a run that has gone wrong writes are gaps in a curve, words are none of its values; anything else is no table of openclose.
  static float value_of(const std::string& field, const std::string& column, const SourceLocation& where) {
    static const std::vector<std::string> gaps = {"", "nan", "-nan", "inf", "-inf"};
    const std::optional<double> number = finite_number(field);
    if (number || column == "status" || std::ranges::find(gaps, field) != gaps.end()) return static_cast<float>(number.value_or(NAN));
    throw InputError(where, column, fmt::format("\"{}\" is no number", field), as_written);
  }

  /// Square of the largest length of the vector that these columns are.
  double reach(const std::string& name, const std::vector<std::string>& by_size) const {
    double largest = 0.0;
    std::vector<std::size_t> places;
    for (const std::string& column : by_size) places.push_back(static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin()));
    for (const std::vector<float>& row : rows.at(name)) {
      double square = 0.0;
      for (const std::size_t k : places) square += k < row.size() ? static_cast<double>(row[k]) * static_cast<double>(row[k]) : 0.0;
      largest = std::max(largest, square);
    }
    return largest;
  }
};

/// The scene without its blocks: every other table stays.
std::string without_blocks(const std::string& text, std::size_t& blocks) {
  std::string rest;
  bool in_block = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1);
    const std::string_view line(text.data() + begin, end + 1 - begin);
    if (line.starts_with('[')) {
      in_block = line.starts_with("[[block]]");
      if (in_block) ++blocks;
    }
    if (!in_block) rest += line;
    begin = end + 1;
  }
  return rest;
}

}  // namespace

template <typename Number>
std::string packed(std::span<const Number> numbers) {
  return base64(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
}
template std::string packed(std::span<const double>);
template std::string packed(std::span<const float>);
template std::string packed(std::span<const std::int32_t>);
template std::string packed(std::span<const std::uint8_t>);

json curves_in(const std::string& path, const std::string& key, const std::vector<std::string>& names, const std::vector<std::string>& by_size) {
  Curves curves(path, key);
  std::vector<std::string> chosen;
  for (const std::string& name : names) {
    if (curves.rows.contains(name)) chosen.push_back(name);
  }
  if (chosen.empty()) {
    chosen = curves.names;
    if (chosen.size() > most_curves)
      std::ranges::stable_sort(chosen, std::ranges::greater(), [&](const std::string& name) { return curves.reach(name, by_size); });
    chosen.resize(std::min(chosen.size(), most_curves));
  }
  if (chosen.empty()) return nullptr;
  json list = json::array();
  std::size_t every = 1;
  for (const std::string& name : chosen) every = std::max(every, (curves.rows[name].size() + most_rows - 1) / most_rows);
  for (const std::string& name : chosen) {
    const auto& rows = curves.rows[name];
    json& curve = list.emplace_back();
    curve["name"] = name;
    for (std::size_t k = 0; k < curves.columns.size(); ++k) {
      std::vector<float> values;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i % every == 0 || i + 1 == rows.size()) values.push_back(rows[i][k]);
      }
      curve[curves.columns[k] + "_f4"] = packed<float>(values);
    }
  }
  return {{"columns", curves.columns}, {"every", every}, {"curves", list}, {"curves_in_table", curves.names.size()}};
}

nlohmann::ordered_json rows_in(std::istream& lines) {
  using nlohmann::ordered_json;
  ordered_json list = ordered_json::array();
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> columns = csv_fields(line);
  while (std::getline(lines, line)) {
    const std::vector<std::string> fields = csv_fields(line);
    if (fields.size() != columns.size()) continue;  // a row that was not written to its end
    ordered_json& row = list.emplace_back();
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const std::optional<double> number = finite_number(fields[k]);
      ordered_json& value = row[columns[k]];
      if (number) {
        value = *number;
      } else if (!fields[k].empty()) {
        value = fields[k];
      }
    }
  }
  return list;
}

nlohmann::ordered_json rows_in(const std::string& path, const std::vector<std::string>& words) {
  std::ifstream file(path);
  nlohmann::ordered_json list = rows_in(file);
  for (std::size_t i = 0; i < list.size(); ++i) {
    for (const auto& [column, value] : list[i].items()) {
      if (!value.is_string() || std::ranges::find(words, column) != words.end()) continue;
      throw InputError({path, static_cast<int>(i) + 2}, column, fmt::format("\"{}\" is no number", value.get<std::string>()), as_written);
    }
  }
  return list;
}

json scene_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return nullptr;
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::size_t blocks = 0;
  if (text.size() > longest_scene) text = without_blocks(text, blocks);
  return {{"text", text}, {"blocks_left_out", blocks}};
}

}  // namespace openclose
