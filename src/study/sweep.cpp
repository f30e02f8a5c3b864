#include "openclose/study/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "openclose/analysis/strength_reduction.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/reader.h"
#include "openclose/study/plot.h"
#include "openclose/study/quantity.h"

namespace openclose {
namespace {

using nlohmann::json;

std::string value_of(const std::string& assignment) {
  return assignment.substr(assignment.find('=') + 1);
}

std::string number_at(const json& summary, const char* key) {
  const auto place = summary.find(key);
  return place == summary.end() || !place->is_number() ? "" : fmt::format("{:.17g}", place->get<double>());
}

/// With which every table of a sweep ends its heading, whatever its keys are.
constexpr const char* last_columns = "warnings,cpu_s,status,message,folder";

/// Throws InputError if a file stands where the table is to be written that no sweep has written.
void require_own_table(const std::string& path) {
  std::ifstream file(path);
  std::string heading;
  if (!file || !std::getline(file, heading) || heading.ends_with(last_columns)) return;
  throw InputError({path, 0}, "", "is there and is no table of a sweep", "-o with another folder");
}

/// Columns of the answer, and what a case has in them.
class Answers {
 public:
  /// \param increase  the load whose multiplier is searched instead of a factor of safety
  Answers(const SweepOrder& order, const std::optional<std::string>& increase)
      : order_(order), is_factor_(order.cases.command == "fos"), factor_(increase ? "load_multiplier" : "factor_of_safety") {}

  std::string columns() const {
    std::string text;
    for (const Variation& variation : order_.variations) text += csv_field(variation.key) + ",";
    text += is_factor_ ? std::string(factor_) + ",failed_at,verdict,limit_analysis,failing_blocks,failing_area_m2,"
                       : csv_field(order_.quantity) + ",time_s,ended_by,";
    return text + last_columns + "\n";
  }

  std::string row(const Case& one, const CaseResult& result) const {
    std::string text;
    for (std::size_t k = 0; k < order_.variations.size(); ++k) text += csv_field(value_of(one.overrides[k])) + ",";
    const json summary = result.summary.empty() ? json::object() : json::parse(result.summary);
    text += is_factor_ ? factor(summary) : motion(summary, one, result);
    double cpu = 0.0;
    if (summary.contains("cpu_s")) {
      for (const json& part : summary.at("cpu_s")) cpu += part.get<double>();
    }
    text += fmt::format("{},{:.6g},{},{},{}\n", summary.contains("warnings") ? std::to_string(summary.at("warnings").size()) : "", cpu,
                        status_word(result.status), csv_field(result.message), csv_field(one.name));
    return text;
  }

  bool is_interval(const CaseResult& result) const {
    return is_factor_ && json::parse(result.summary).value("verdict", "") == factor_verdict_word(FactorVerdict::interval);
  }

  /// What is drawn: the factor, from its stable to its failed end, or the quantity.
  std::optional<PlotPoint> point(const Case& one, const CaseResult& result) const {
    if (result.summary.empty() || result.status != exit_success) return std::nullopt;
    PlotPoint point;
    if (is_factor_) {
      const json bracket = json::parse(result.summary).at("bracket");
      if (!bracket.at("stable").is_number()) return std::nullopt;
      point.y = bracket.at("stable").get<double>();
      if (bracket.at("failed").is_number()) point.high = bracket.at("failed").get<double>();
      return point;
    }
    const std::optional<double> value = quantity_in(order_.cases.folder + "/" + one.name, order_.quantity);
    if (!value) return std::nullopt;
    point.y = *value;
    return point;
  }

 private:
  std::string factor(const json& summary) const {
    if (!summary.contains("bracket")) return ",,,,,,";
    const json& limit = summary.at("limit_analysis");
    const json& failing = summary.at("failing_blocks");
    return fmt::format("{},{},{},{},{},{},", number_at(summary, factor_), number_at(summary.at("bracket"), "failed"),
                       summary.at("verdict").get<std::string>(), limit.is_object() ? number_at(limit, "factor") : "", failing.at("number").get<int>(),
                       number_at(failing, "area_m2"));
  }

  std::string motion(const json& summary, const Case& one, const CaseResult& result) const {
    std::optional<double> value;
    if (result.status == exit_success) value = quantity_in(order_.cases.folder + "/" + one.name, order_.quantity);
    return fmt::format("{},{},{},", value ? fmt::format("{:.17g}", *value) : "", number_at(summary, "time_s"), summary.value("ended_by", ""));
  }

  const SweepOrder& order_;
  bool is_factor_;
  const char* factor_;  ///< its key in summary.json
};

/// Over the first key whose values are numbers, a curve for each combination of the others; empty if no key has numbers.
std::string picture(const SweepOrder& order, const std::string& quantity, const Answers& answers, const std::vector<Case>& cases,
                    const std::vector<CaseResult>& results) {
  const auto is_numeric = [](const Variation& v) {
    return std::ranges::all_of(v.values, [](const std::string& s) { return number_from(s).has_value(); });
  };
  const auto place = std::ranges::find_if(order.variations, is_numeric);
  if (place == order.variations.end()) return "";
  const auto k = static_cast<std::size_t>(place - order.variations.begin());
  Plot plot{"", place->key, quantity, false, false, {}};
  std::map<std::string, std::size_t> series;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    std::string name;
    for (std::size_t other = 0; other < order.variations.size(); ++other) {
      if (other != k) name += (name.empty() ? "" : ", ") + cases[i].overrides[other];
    }
    const auto [entry, is_new] = series.try_emplace(name, plot.series.size());
    if (is_new) plot.series.push_back({name, {}});
    std::optional<PlotPoint> point = answers.point(cases[i], results[i]);
    if (!point) continue;
    point->x = *number_from(value_of(cases[i].overrides[k]));
    plot.series[entry->second].points.push_back(*point);
  }
  for (PlotSeries& one : plot.series) std::ranges::sort(one.points, {}, &PlotPoint::x);
  const std::string note = order.cases.command == "fos" ? "Points: the largest factor proved stable; bars: to the smallest one proved to fail." : "";
  return svg_plots(quantity + " of " + order.cases.scene_file, note.empty() ? std::vector<std::string>{} : std::vector{note}, {plot});
}

/// Cases of earlier sweeps over the same keys in the folder that this one has not: the table and the picture have been written anew without them.
std::size_t earlier_cases(const std::string& folder, const std::vector<Variation>& variations, const std::vector<Case>& cases) {
  std::size_t count = 0;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    const bool has_keys =
        std::ranges::all_of(variations, [&](const Variation& variation) { return name.find(variation.key + "=") != std::string::npos; });
    const bool is_case = has_keys && is_there((entry.path() / "summary.json").string());
    if (is_case && std::ranges::find(cases, name, &Case::name) == cases.end()) ++count;
  }
  return count;
}

}  // namespace

Sweep make_sweep(SweepOrder order, const std::function<void(double)>& progress) {
  for (const Variation& variation : order.variations) {
    require_not_set(order.overrides, variation.key, "--vary");
    if (std::ranges::count(order.variations, variation.key, &Variation::key) > 1)
      throw InputError({"--vary " + variation.key, 0}, "", "this key is varied twice", "each key once");
  }
  std::vector<Case> cases;
  for (std::vector<std::string>& assignments : combinations(order.variations)) {
    Case& one = cases.emplace_back();
    one.name = folder_name(assignments);
    one.overrides = std::move(assignments);
    one.overrides.insert(one.overrides.end(), order.overrides.begin(), order.overrides.end());
  }
  const Scene scene = read_scene(order.cases.scene_file, cases.front().overrides);
  if (order.cases.command == "run") {
    if (order.quantity.empty()) order.quantity = usual_quantity(scene);
    require_quantity(order.quantity, scene);
  }
  const std::optional<std::string>& increase = scene.strength_reduction.increase;
  const Answers answers(order, increase);
  const std::string table = order.cases.folder + "/sweep.csv";
  require_own_table(table);
  require_replaceable({{order.cases.folder + "/sweep.svg", {}, false, Seal::xml}});
  std::vector<std::string> rows(cases.size());
  const auto text = [&] {
    std::string all = answers.columns();
    for (const std::string& row : rows) all += row;
    return all;
  };
  Sweep sweep;
  sweep.cases = cases.size();
  std::size_t done = 0;
  const auto results = run_cases(order.cases, cases, [&](std::size_t i, const CaseResult& result) {
    rows[i] = answers.row(cases[i], result);
    sweep.were_there += result.was_there;
    sweep.found += result.status == exit_success;
    sweep.intervals += result.status == exit_success && answers.is_interval(result);
    if (result.status != exit_success) sweep.warnings.push_back(fmt::format("{}: {}: {}", cases[i].name, status_word(result.status), result.message));
    // One with other keys has another heading, by which it would not be known as ours; it has been looked at above.
    if (!result.was_there) {
      remove_left_part(table, answers.columns());
      write_files({{table, text(), true}});
    }
    progress(static_cast<double>(++done) / static_cast<double>(cases.size()));
  });
  CaseWarnings of_runs;
  for (std::size_t i = 0; i < cases.size(); ++i) of_runs.add(cases[i].name, results[i].summary);
  for (std::string& warning : of_runs.texts()) sweep.warnings.push_back(std::move(warning));
  if (const std::size_t earlier = earlier_cases(order.cases.folder, order.variations, cases); earlier > 0)
    sweep.warnings.push_back(
        fmt::format("{} of earlier sweeps in {} not in this table: name the values, too, to have them in it; what has not changed is not run again",
                    earlier == 1 ? std::string("1 case") : fmt::format("{} cases", earlier), order.cases.folder + (earlier == 1 ? " is" : " are")));
  sweep.files.push_back({table, text(), true});
  const std::string drawing = picture(order, order.cases.command == "fos" ? name_of_answer(increase) : order.quantity, answers, cases, results);
  if (!drawing.empty()) sweep.files.push_back({order.cases.folder + "/sweep.svg", drawing, false, Seal::xml});
  return sweep;
}

}  // namespace openclose
