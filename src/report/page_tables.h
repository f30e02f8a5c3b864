// The tables of results that the page draws as curves, and the scene as it was read.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace openclose {

/// Base64 of the bytes of the numbers.
template <typename Number>
std::string packed(std::span<const Number> numbers);

/// {"columns", "every", "curves": [{"name", "rows", "<column>_f4" ...}]} of the rows of a table, by the names in the column `key` (none: all rows are
/// one curve without a name); null where there is no such table or no row. Only every so many'th row of a long table is there, and `every` says so.
/// \param names  the curves that are wanted; empty: as many as a picture can tell apart, those that reach farthest in the columns `by_size`
nlohmann::json curves_in(const std::string& path, const std::string& key, const std::vector<std::string>& names,
                         const std::vector<std::string>& by_size = {});

/// The rows of a small table, as a list of objects: numbers where a field is one, null where it is empty.
nlohmann::ordered_json rows_in(std::istream& table);
/// \param words  the columns that may hold something else than numbers; throws InputError where another one does
nlohmann::ordered_json rows_in(const std::string& path, const std::vector<std::string>& words);

/// The scene as it was read, without its blocks where they are many: {"text", "blocks_left_out"}.
nlohmann::json scene_text(const std::string& path);

}  // namespace openclose
