// A table of states as a run has written it: its first column names the state, and the rows of a state stand together.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace openclose {

/// The fields of a row. Names in these tables hold neither commas nor quotes, since scenes with such names are refused.
using Row = std::vector<std::string_view>;

double number_in(std::string_view field);  ///< 0 for an empty field

class StateTable {
 public:
  /// Reads the file; a file that is not there, or has none of these columns, gives an empty table.
  /// \param columns  in the order in which rows() has them, after the state
  StateTable(const std::string& path, const std::vector<std::string>& columns);

  const std::vector<std::string>& states() const { return states_; }  ///< in the order of the file
  bool has(const std::string& state) const;
  /// Calls `visit(fields)` for every row of a state; the fields are those of `columns`. A row that was not written to its end is left out.
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

 private:
  template <typename Visit>
  void visit_rows(std::string_view rest, const Visit& visit) const {
    Row fields, chosen(columns_.size());
    while (!rest.empty()) {
      const std::size_t end = rest.find('\n');
      if (end == std::string_view::npos) return;
      split(rest.substr(0, end), fields);
      rest.remove_prefix(end + 1);
      if (fields.size() != width_) continue;
      for (std::size_t k = 0; k < columns_.size(); ++k) chosen[k] = fields[columns_[k]];
      visit(chosen);
    }
  }
  static void split(std::string_view line, Row& fields);

  std::string text_;
  std::size_t width_ = 0;             ///< fields of a row
  std::vector<std::size_t> columns_;  ///< of the file
  std::vector<std::string> states_;
  std::vector<std::string_view> ranges_;  ///< the rows of each
};

}  // namespace openclose
