// A table of states as a run has written it: its first column names the state, and the rows of a state stand together.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace openclose {

std::optional<double> finite_number(std::string_view field);  ///< nothing where the field as a whole is none

class StateTable;

/// The fields of a row. Names in these tables hold neither commas nor quotes, since scenes with such names are refused.
class Row {
 public:
  std::string_view operator[](std::size_t column) const { return fields_[column]; }
  /// Throws InputError where the field is no finite number.
  double number(std::size_t column) const;
  /// The same, but 0 where the field is empty, as where an analysis has no such number.
  double number_or_zero(std::size_t column) const { return fields_[column].empty() ? 0.0 : number(column); }
  /// Throws InputError with the file, the line and the name of the column.
  [[noreturn]] void refuse(std::size_t column, const std::string& read, const std::string& accepted) const;

 private:
  friend class StateTable;
  explicit Row(const StateTable& table) : table_(&table) {}

  const StateTable* table_;
  std::string_view line_;
  std::vector<std::string_view> fields_;
};

class StateTable {
 public:
  /// Reads the file; one that is not there gives an empty table. Throws InputError if it lacks one of the columns.
  /// \param columns  in the order in which rows() has them
  StateTable(const std::string& path, const std::vector<std::string>& columns);

  const std::string& path() const { return path_; }
  const std::vector<std::string>& states() const { return states_; }  ///< in the order of the file
  bool has(const std::string& state) const;
  /// Calls `visit(row)` for every row of a state. Throws InputError for a row that has not as many fields as the heading.
  template <typename Visit>
  void rows(const std::string& state, const Visit& visit) const {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == state) visit_rows(ranges_[i], visit);
    }
  }
  /// The same for the first row alone, if there is one.
  template <typename Visit>
  void first_row(const std::string& state, const Visit& visit) const {
    const auto place = std::ranges::find(states_, state);
    if (place == states_.end()) return;
    const std::string_view range = ranges_[static_cast<std::size_t>(place - states_.begin())];
    visit_rows(range.substr(0, std::min(range.find('\n'), range.size() - 1) + 1), visit);
  }
  /// The same for all rows, of a table whose first column names something else than a state.
  template <typename Visit>
  void all_rows(const Visit& visit) const {
    for (const std::string_view range : ranges_) visit_rows(range, visit);
  }

 private:
  friend class Row;

  template <typename Visit>
  void visit_rows(std::string_view rest, const Visit& visit) const {
    Row row(*this);
    std::vector<std::string_view> fields;
    row.fields_.resize(columns_.size());
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      row.line_ = rest.substr(0, end);
      split(row.line_, fields);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (fields.size() != names_.size()) refuse_width(row.line_, fields.size());
      for (std::size_t k = 0; k < columns_.size(); ++k) row.fields_[k] = fields[columns_[k]];
      visit(row);
    }
  }
  static void split(std::string_view line, std::vector<std::string_view>& fields);
  [[noreturn]] void refuse_width(std::string_view line, std::size_t fields) const;
  int number_of(std::string_view line) const;  ///< in the file, from 1

  std::string path_;
  std::string text_;
  std::vector<std::string_view> names_;  ///< of all columns in the file
  std::vector<std::size_t> columns_;     ///< of the file
  std::vector<std::string> states_;
  std::vector<std::string_view> ranges_;  ///< the rows of each
};

}  // namespace openclose
