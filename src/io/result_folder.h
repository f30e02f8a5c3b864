// A folder that run or fos has written: its summary, and whether its tables belong to it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "openclose/geometry/polygon.h"
#include "openclose/io/state_table.h"

namespace openclose {

/// The numbers of blocks by their names.
class BlockIndex {
 public:
  /// \param file  where the blocks stand, for messages
  BlockIndex(std::string file, const std::vector<std::string>& names);

  std::size_t size() const { return of_.size(); }
  /// Throws InputError if the field of the row names no block.
  int of(const Row& row, std::size_t column) const;
  /// Throws InputError if summary.json beside the blocks names one that is not there.
  int of(const nlohmann::json& entry, const std::string& summary_file) const;

 private:
  std::string file_;
  std::unordered_map<std::string, int> of_;
};

/// The blocks of a state, in the order of blocks.csv.
struct Outlines {
  std::vector<std::string> names;
  std::vector<Polygon> polygons;
};

class ResultFolder {
 public:
  /// Reads summary.json and blocks.csv; throws InputError, which names what is accepted, if it is no folder of a run or fos that has ended, or if the
  /// states of blocks.csv are not those of the summary.
  explicit ResultFolder(const std::string& folder);

  std::string path_of(const std::string& name) const { return folder_ + "/" + name; }
  std::string name() const;  ///< without the folders that it is in
  const nlohmann::json& summary() const { return summary_; }
  /// A list of names in the summary: "materials" or "joints", whose order gives them their colours.
  std::vector<std::string> names_in(const char* list) const { return summary_.at(list).get<std::vector<std::string>>(); }
  bool is_factor() const { return is_factor_; }
  const std::vector<std::string>& states() const { return outlines_.states(); }
  bool has(const std::string& state) const { return outlines_.has(state); }
  const Outlines& drawing() const { return drawing_; }  ///< before anything has moved
  /// Throws InputError if a table is not as long as the summary has it, for other line ends: it is missing, cut off, changed or of another analysis.
  void require_whole_tables() const;
  /// Throws InputError unless these are the blocks of the drawing.
  std::vector<Polygon> outlines(const std::string& state) const;

 private:
  void require_summary() const;
  void require_states() const;
  Outlines read(const std::string& state) const;

  std::string folder_;
  nlohmann::json summary_;
  bool is_factor_ = false;
  StateTable outlines_;
  Outlines drawing_;
};

}  // namespace openclose
