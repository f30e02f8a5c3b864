// The tables of results that the page draws as curves, and the scene as it was read.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace openclose {

/// Base64 of the bytes of the numbers.
template <typename Number>
std::string packed(std::span<const Number> numbers);

/// The fields of a line of a table, of which some may be quoted.
std::vector<std::string> csv_fields(const std::string& line);

/// A small table as text; a row that was not written to its end is left out.
struct TextTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;

  explicit TextTable(std::istream& table);
  /// Empty where the file is not there.
  explicit TextTable(const std::string& path);
  /// Place of a column, or the number of columns.
  std::size_t column(const std::string& name) const;
  /// Field of a row; empty where there is no such column.
  const std::string& field(const std::vector<std::string>& row, const std::string& name) const;
};

/// {"columns", "every", "curves": [{"name", "rows", "<column>_f4" ...}]} of the rows of a table, by the names in the column `key` (none: all rows are
/// one curve without a name); null where there is no such table or no row. Only every so many'th row of a long table is there, and `every` says so.
/// \param names  the curves that are wanted; empty: as many as a picture can tell apart, those that reach farthest in the columns `by_size`
nlohmann::json curves_in(const std::string& path, const std::string& key, const std::vector<std::string>& names,
                         const std::vector<std::string>& by_size = {});

/// The rows of a small table, as a list of objects: numbers where a field is one, null where it is empty.
nlohmann::ordered_json rows_in(std::istream& table);
nlohmann::ordered_json rows_in(const std::string& path);

/// The scene as it was read, without its blocks where they are many: {"text", "blocks_left_out"}.
nlohmann::json scene_text(const std::string& path);

}  // namespace openclose
