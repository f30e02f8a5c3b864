#include "openclose/io/result_answer.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "openclose/analysis/strength_reduction.h"

namespace openclose {
namespace {

using nlohmann::json;

std::string answer_of_factor(const json& summary) {
  const json& bracket = summary.at("bracket");
  const json& increase = summary.at("options").value("strength_reduction", json::object()).value("increase", json());
  const std::string name = name_of_answer(increase.is_string() ? std::optional(increase.get<std::string>()) : std::nullopt);
  const std::string verdict = summary.at("verdict"), method = summary.at("options").at("method").at("contact");
  const json& stable = bracket.at("stable");
  if (stable.is_null() || verdict == "no_equilibrium" || verdict == "undecided")
    return fmt::format("no {} ({}): {}", name, method, summary.value("reason", ""));
  if (verdict == "no_failure") return fmt::format("{} above {:.6g} ({}: no failure found up to there)", name, stable.get<double>(), method);
  const json& failed = bracket.at("failed");
  const std::string end = failed.is_null() ? "no failure proved" : fmt::format("failed at {:.6g}", failed.get<double>());
  return fmt::format("{} {:.6g} ({}, {}; {})", name, stable.get<double>(), end, verdict, method);
}

std::string answer_of_run(const json& summary) {
  const std::string method = summary.at("options").at("method").at("contact");
  std::string answer = fmt::format("{}: run to t = {:.5g} s", method, summary.value("time_s", 0.0));
  const double factor = summary.at("options").value("run", json::object()).value("strength_reduction_factor", 1.0);
  if (factor != 1.0) answer += fmt::format(" with the strength divided by {:.6g}", factor);
  if (!summary.value("converged", false)) answer += fmt::format("; stopped: {}", summary.value("reason", ""));
  return answer;
}

}  // namespace

std::string answer_of(const json& summary) {
  return summary.value("command", "") == "fos" ? answer_of_factor(summary) : answer_of_run(summary);
}

}  // namespace openclose
