#include "openclose/study/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "openclose/analysis/simulation.h"
#include "openclose/core/error.h"
#include "openclose/scene/reader.h"
#include "openclose/study/convergence.h"
#include "openclose/study/plot.h"
#include "openclose/study/quantity.h"

namespace openclose {
namespace {

using nlohmann::json;

/// [-] Ends that differ by more are not the same moment.
constexpr double accuracy_of_end = 1e-9;
/// [-] Than the step makes: a few that are divided, as at impacts, leave the step what it is.
constexpr double more_steps = 1.5;

constexpr const char* columns = "contact,dt_s,quantity,value,reference,error,observed_order,cpu_s,steps,end_time_s,integrator_loss,warnings,status\n";

std::string table_in(const std::string& folder) {
  return folder + "/study.csv";
}

std::string picture_in(const std::string& folder) {
  return folder + "/study.svg";
}

/// Of the rows that has_warnings() marks.
constexpr const char* meaning_of_mark = "runs that gave warnings, see \"warnings\" in their summary.json";

bool has_warnings(const StudyRow& row) {
  return row.warnings > 0;
}

std::string number_text(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}g}", *value, digits) : "";
}

std::vector<Case> cases_of(const StudyOrder& order) {
  std::vector<Case> cases;
  for (const std::string& contact : order.contacts) {
    for (const double dt : order.steps) {
      Case& one = cases.emplace_back();
      one.overrides = {"method.contact=" + contact, fmt::format("step.dt_s={:.12g}", dt)};
      // Their folder says what is different; what is the same in all is in scene_as_read.toml.
      one.name = fmt::format("{},dt={:.12g}", contact, dt);
      one.overrides.insert(one.overrides.end(), order.overrides.begin(), order.overrides.end());
    }
  }
  return cases;
}

StudyRow row_of(const StudyOrder& order, const std::string& contact, double dt, const std::string& folder, const CaseResult& result) {
  StudyRow row;
  row.contact = contact;
  row.dt = dt;
  row.status = result.status;
  row.message = result.message;
  if (result.summary.empty()) return row;
  const json summary = json::parse(result.summary);
  row.cpu = summary.at("cpu_s").at("start").get<double>() + summary.at("cpu_s").at("motion").get<double>();
  row.steps = summary.at("counters").at("steps").get<long>();
  row.end_time = summary.at("time_s").get<double>();
  row.warnings = static_cast<int>(summary.at("warnings").size());
  // A case that was run by an earlier build, and is not run again, may lack it.
  if (const auto loss = summary.find("integrator_loss"); loss != summary.end()) row.integrator_loss = loss->get<double>();
  if (result.status == exit_success) row.value = quantity_in(folder, order.quantity);
  return row;
}

/// Errors and orders of the rows of one method.
StudyLimit judge(std::span<StudyRow> rows, const std::optional<double>& reference) {
  StudyLimit limit{rows.front().contact, reference, "the given value"};
  std::vector<Refinement> found;
  std::vector<StudyRow*> judged;
  for (StudyRow& row : rows) {
    if (!row.value) continue;
    found.push_back({row.dt, *row.value});
    judged.push_back(&row);
  }
  bool is_finest = false;
  if (!reference && !found.empty()) {
    const std::optional<Limit> richardson = richardson_limit(found);
    is_finest = !richardson;
    limit.value = richardson ? richardson->value : found.back().value;
    limit.how = richardson ? fmt::format("Richardson's extrapolation from the three smallest steps, order {:.3g}", richardson->order)
                           : std::string("the smallest step");
  }
  if (found.empty()) return {limit.contact, std::nullopt, "no run came to its end"};
  std::vector<double> steps, errors;
  for (StudyRow* row : judged) {
    if (is_finest && row == judged.back()) continue;
    row->error = std::abs(*row->value - *limit.value);
    steps.push_back(row->dt);
    errors.push_back(*row->error);
  }
  const auto orders = observed_orders(steps, errors, std::abs(*limit.value));
  for (std::size_t i = 0; i < orders.size(); ++i) judged[i]->order = orders[i];
  return limit;
}

std::string name_of(const StudyRow& row) {
  return fmt::format("{} at dt = {:g} s", row.contact, row.dt);
}

/// [-] Of the largest value: changes below are rounding and tolerances.
constexpr double noticeable_change = 1e-6;

/// Values that change as the logarithm of the step or faster with the last refinement, beside the one before, come nowhere yet: an error in a
/// positive power of the step changes less.
void warn_of_divergence(std::span<const StudyRow> rows, CaseWarnings& warnings) {
  std::vector<const StudyRow*> found;
  double largest = 0.0;
  for (const StudyRow& row : rows) {
    if (row.value) found.push_back(&row), largest = std::max(largest, std::abs(*row.value));
  }
  if (found.size() < 3) return;
  const auto change = [&](std::size_t i) { return std::abs(*found[i]->value - *found[i - 1]->value); };
  const double last = change(found.size() - 1), before = change(found.size() - 2);
  const auto refinement = [&](std::size_t i) { return std::log(found[i - 1]->dt / found[i]->dt); };
  const bool converges = last * refinement(found.size() - 2) <= before * refinement(found.size() - 1);
  if (converges || last <= noticeable_change * largest) return;
  warnings.note(
      name_of(*found.back()),
      fmt::format("the value changes by {:.3g} with the last refinement and by {:.3g} with the one before: these steps do not converge yet, and "
                  "errors against the smallest one mean nothing; smaller steps, or method.start = \"settled\" where contacts ring",
                  last, before));
}

/// Alike ones once, as those of the runs themselves.
std::vector<std::string> warnings_of(const Study& study) {
  CaseWarnings warnings;
  std::optional<double> end;
  for (const StudyRow& row : study.rows) {
    if (row.status != exit_success) {
      warnings.note(name_of(row), fmt::format("{}: {}", status_word(row.status), row.message));
      continue;
    }
    if (!row.value) warnings.note(name_of(row), "has no " + study.quantity);
    if (!end) end = row.end_time;
    if (std::abs(row.end_time - *end) > accuracy_of_end * std::abs(*end))
      warnings.note(name_of(row), fmt::format("ends at {:.9g} s, others at {:.9g} s: choose steps that divide end.time_s", row.end_time, *end));
  }
  for (const StudyRow& row : study.rows) {
    const double asked = row.end_time / row.dt;
    if (row.value && static_cast<double>(row.steps) > more_steps * asked)
      warnings.note(name_of(row),
                    fmt::format("it took {} steps, where its dt makes {:.0f}: the scene or the method asks for shorter ones, and orders "
                                "by dt mean little",
                                row.steps, asked));
  }
  for (std::size_t i = 1; i < study.rows.size(); ++i) {
    const StudyRow &a = study.rows[i - 1], &b = study.rows[i];
    if (a.contact == b.contact && a.value && b.value && a.steps == b.steps)
      warnings.note(name_of(b), fmt::format("it took as many steps as at {:g} s: the scene or the method allows no longer ones", a.dt));
  }
  for (std::size_t begin = 0; begin < study.rows.size();) {
    std::size_t past = begin;
    while (past < study.rows.size() && study.rows[past].contact == study.rows[begin].contact) ++past;
    warn_of_divergence(std::span(study.rows).subspan(begin, past - begin), warnings);
    begin = past;
  }
  return warnings.texts();
}

bool has_errors(const Study& study) {
  return std::ranges::any_of(study.rows, [](const StudyRow& row) { return row.error.has_value(); });
}

}  // namespace

Study make_study(StudyOrder order, const std::function<void(double)>& progress) {
  std::ranges::sort(order.steps, std::greater());
  if (std::ranges::adjacent_find(order.steps) != order.steps.end())
    throw InputError({"study", 0}, "--dt", "a step is named twice", "different steps in seconds");
  require_not_set(order.overrides, "step.dt_s", "--dt");
  if (!order.contacts.empty()) require_not_set(order.overrides, "method.contact", "--contact");
  // As the first case, so that steps and ends may come from the command line alone.
  std::vector<std::string> overrides = {fmt::format("step.dt_s={:.12g}", order.steps.front())};
  overrides.insert(overrides.end(), order.overrides.begin(), order.overrides.end());
  const Scene scene = read_scene(order.cases.scene_file, overrides);
  if (scene.end_time <= 0.0) throw InputError(scene.where, "end.time_s", "missing, or 0", "an end time > 0 in seconds, here or with --end");
  if (order.contacts.empty()) order.contacts = {scene.method.contact};
  if (order.quantity.empty()) order.quantity = usual_quantity(scene);
  require_quantity(order.quantity, scene);

  require_replaceable({{table_in(order.cases.folder), columns}, {picture_in(order.cases.folder), {}, false, Seal::xml}});
  const std::vector<Case> cases = cases_of(order);
  // An integrator that a method does not have is refused before the first run, too.
  for (std::size_t i = 0; i < cases.size(); i += order.steps.size()) Simulation(read_scene(order.cases.scene_file, cases[i].overrides));
  std::size_t done = 0;
  const auto results = run_cases(order.cases, cases,
                                 [&](std::size_t, const CaseResult&) { progress(static_cast<double>(++done) / static_cast<double>(cases.size())); });
  Study study;
  study.scene = scene.title.empty() ? order.cases.scene_file : scene.title;
  study.quantity = order.quantity;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    study.rows.push_back(row_of(order, order.contacts[i / order.steps.size()], order.steps[i % order.steps.size()],
                                order.cases.folder + "/" + cases[i].name, results[i]));
  }
  for (std::size_t m = 0; m < order.contacts.size(); ++m)
    study.limits.push_back(judge(std::span(study.rows).subspan(m * order.steps.size(), order.steps.size()), order.reference));
  study.warnings = warnings_of(study);
  CaseWarnings of_runs;
  for (std::size_t i = 0; i < cases.size(); ++i) of_runs.add(cases[i].name, results[i].summary);
  for (std::string& text : of_runs.texts()) study.warnings.push_back(std::move(text));
  return study;
}

std::vector<TextFile> study_files(const Study& study, const std::string& folder) {
  std::string rows = columns;
  Plot errors{"Error", "time step [s]", "error of " + study.quantity, true, true, {}},
      cost{"Cost", "error of " + study.quantity, "CPU time [s]", true, true, {}};
  for (const StudyLimit& limit : study.limits) {
    PlotSeries error{limit.contact, {}}, price{limit.contact, {}};
    for (const StudyRow& row : study.rows) {
      if (row.contact != limit.contact) continue;
      rows += fmt::format("{},{:.17g},{},{},{},{},{},{:.6g},{},{:.17g},{},{},{}\n", row.contact, row.dt, study.quantity, number_text(row.value, 17),
                          number_text(limit.value, 17), number_text(row.error, 17), number_text(row.order, 6), row.cpu, row.steps, row.end_time,
                          number_text(row.integrator_loss, 6), row.warnings, status_word(row.status));
      if (!row.error) continue;
      error.points.push_back({row.dt, *row.error, {}, false, has_warnings(row)});
      price.points.push_back({*row.error, row.cpu, {}, false, has_warnings(row)});
    }
    if (error.points.empty()) continue;  // a name in the key without a curve says nothing; the notes say why
    errors.series.push_back(error);
    cost.series.push_back(price);
  }
  std::vector<std::string> notes;
  for (const StudyLimit& limit : study.limits) notes.push_back(fmt::format("{}: {} ({})", limit.contact, number_text(limit.value, 9), limit.how));
  if (std::ranges::any_of(study.rows, has_warnings)) notes.emplace_back(std::string("Hollow points: ") + meaning_of_mark);
  std::vector<TextFile> files = {{table_in(folder), rows}};
  // Axes without a point would have numbers that nothing has given them.
  if (has_errors(study))
    files.push_back(
        {picture_in(folder), svg_plots(fmt::format("{}: convergence of {}", study.scene, study.quantity), notes, {errors, cost}), false, Seal::xml});
  return files;
}

std::string study_table(const Study& study) {
  const std::size_t width = std::max<std::size_t>(16, study.quantity.size());
  // The column behind the value is that of the mark.
  std::string text =
      fmt::format("{:<8} {:>11} {:>{}}  {:>11} {:>7} {:>10}\n", "contact", "dt [s]", study.quantity, width, "error", "order", "CPU [s]");
  for (const StudyRow& row : study.rows) {
    text += fmt::format("{:<8} {:>11.6g} {:>{}}{} {:>11} {:>7} {:>10.3g}\n", row.contact, row.dt,
                        row.value ? number_text(row.value, 9) : status_word(row.status), width, has_warnings(row) ? '*' : ' ',
                        number_text(row.error, 3), row.order ? fmt::format("{:.2f}", *row.order) : "", row.cpu);
  }
  if (std::ranges::any_of(study.rows, has_warnings)) text += fmt::format("* {}\n", meaning_of_mark);
  for (const StudyLimit& limit : study.limits)
    text += fmt::format("{}: errors against {}, {}\n", limit.contact, limit.value ? number_text(limit.value, 9) : "nothing", limit.how);
  return text;
}

}  // namespace openclose
