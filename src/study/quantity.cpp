#include "openclose/study/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/io/results.h"
#include "openclose/io/state_table.h"
#include "openclose/scene/nearest.h"

namespace openclose {
namespace {

constexpr const char* deepest_penetration = "max_penetration_m";
constexpr const char* largest_displacement = "largest_displacement_m";
const std::vector<std::string> history_columns = {"displacement_m",   "displacement_x_m",   "displacement_y_m",   "rotation_rad",
                                                  "velocity_m_per_s", "velocity_x_m_per_s", "velocity_y_m_per_s", "angular_velocity_rad_per_s"};

/// "POINT" and "COLUMN" of "POINT.COLUMN"; names of points may have dots themselves.
std::pair<std::string, std::string> parts_of(const std::string& quantity) {
  const std::size_t dot = quantity.rfind('.');
  if (dot == std::string::npos) return {"", quantity};
  return {quantity.substr(0, dot), quantity.substr(dot + 1)};
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

/// The last row of a table, or the last one that has this name in its second column; by the names of the columns.
class LastRow {
 public:
  LastRow(const std::string& path, const std::string& name) {
    std::ifstream file(path);
    std::string line, last;
    if (!std::getline(file, line)) return;
    columns_ = fields_of(line);
    const std::string middle = "," + name + ",";
    while (std::getline(file, line)) {
      if (name.empty() || line.find(middle) == line.find(',')) last = line;
    }
    fields_ = fields_of(last);
  }
  std::optional<double> at(const std::string& column) const {
    const auto place = static_cast<std::size_t>(std::ranges::find(columns_, column) - columns_.begin());
    if (place >= columns_.size() || place >= fields_.size()) return std::nullopt;
    return finite_number(fields_[place]);
  }

 private:
  std::vector<std::string> columns_, fields_;
};

std::optional<double> of_history(const LastRow& row, const std::string& column) {
  for (const std::string vector : {"displacement", "velocity"}) {
    const std::string unit = vector == "displacement" ? "m" : "m_per_s";
    if (column != vector + "_" + unit) continue;
    const auto x = row.at(vector + "_x_" + unit), y = row.at(vector + "_y_" + unit);
    if (!x || !y) return std::nullopt;
    return std::hypot(*x, *y);
  }
  return row.at(column);
}

std::optional<double> largest_displacement_in(const std::string& folder) {
  const StateTable table(folder + "/block_states.csv", {"displacement_x_m", "displacement_y_m"});
  if (table.states().empty()) return std::nullopt;
  double largest = 0.0;
  table.rows(table.states().back(), [&](const Row& row) { largest = std::max(largest, std::hypot(row.number(0), row.number(1))); });
  return largest;
}

}  // namespace

std::string usual_quantity(const Scene& scene) {
  return scene.measured_points.empty() ? largest_displacement : scene.measured_points.front().name + ".displacement_m";
}

void require_quantity(const std::string& quantity, const Scene& scene) {
  const auto [point, column] = parts_of(quantity);
  std::vector<std::string> known;
  for (const MeasuredPoint& measured : scene.measured_points) {
    for (const std::string& name : history_columns) known.push_back(measured.name + "." + name);
  }
  if (scene.measured_points.empty()) {
    // All free blocks are measured then.
    for (const BlockInput& block : scene.blocks) {
      if (block.name == point && std::ranges::count(history_columns, column) > 0) return;
    }
  }
  known.insert(known.end(), {largest_displacement, deepest_penetration});
  for (const auto& entry : ledger_entries({})) known.push_back(std::string("energy.") + entry.first);
  if (std::ranges::count(known, quantity) == 0)
    throw InputError(scene.where, "--quantity", fmt::format("\"{}\" is no quantity of these results{}", quantity, did_you_mean(quantity, known)),
                     suggestions(quantity, known));
}

std::optional<double> quantity_in(const std::string& folder, const std::string& quantity) {
  if (quantity == largest_displacement) return largest_displacement_in(folder);
  if (quantity == deepest_penetration) {
    std::ifstream file(folder + "/summary.json");
    const nlohmann::json summary = nlohmann::json::parse(file, nullptr, false);
    if (!summary.is_object() || !summary.contains(quantity) || !summary.at(quantity).is_number()) return std::nullopt;
    return summary.at(quantity).get<double>();
  }
  const auto [point, column] = parts_of(quantity);
  if (point == "energy") return LastRow(folder + "/energy.csv", "").at(column);
  return of_history(LastRow(folder + "/history.csv", point), column);
}

}  // namespace openclose
