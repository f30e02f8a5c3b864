// Analyses that end without a result: exit code 1, one line on standard error, state and reason saved.
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using openclose::test::block_on_base;
using openclose::test::CommandResult;
using openclose::test::lines_of;
using openclose::test::Workplace;

namespace {

nlohmann::json summary_of(const Workplace& place) {
  return nlohmann::json::parse(openclose::test::text_of(place.folder() / "out/summary.json"));
}

void check_saved(const Workplace& place, const CommandResult& result, const std::string& reason, std::size_t warnings = 0) {
  CHECK(result.status == 1);
  CHECK(result.out.empty());
  REQUIRE(result.errors.size() == warnings + 1);
  CHECK_THAT(result.errors[warnings], ContainsSubstring(reason) && ContainsSubstring("state saved in out"));
  const nlohmann::json summary = summary_of(place);
  CHECK(summary.at("converged") == false);
  CHECK_THAT(summary.at("reason").get<std::string>(), ContainsSubstring(reason));
}

std::set<std::string> states_in(const std::string& path) {
  std::set<std::string> states;
  for (const std::string& line : lines_of(path)) states.insert(line.substr(0, line.find(',')));
  states.erase("state");
  return states;
}

}  // namespace

TEST_CASE("no failure below the upper limit is an answer", "[cli][not_converged]") {
  const Workplace place;
  const CommandResult result = place.run("fos scene.toml -o out --set strength_reduction.upper_limit=3");
  CHECK(result.status == 0);
  CHECK_THAT(result.out, ContainsSubstring("factor of safety above 3") && ContainsSubstring("still stable at strength_reduction.upper_limit"));
  const nlohmann::json summary = summary_of(place);
  CHECK(summary.at("factor_of_safety") == 3.0);
  CHECK(summary.at("verdict") == "no_failure");
  CHECK(summary.at("bracket").at("failed").is_null());
  CHECK(states_in(place.folder() / "out/blocks.csv") == std::set<std::string>{"initial", "stable"});
  CHECK(lines_of(place.folder() / "out/trials.csv").size() > 3);
}

TEST_CASE("no factor of safety at any strength", "[cli][not_converged]") {
  const Workplace place(openclose::test::block_on_incline(0.0));
  const CommandResult result = place.run("fos scene.toml -o out --set 'block[1].vertices_m=[[0, 5], [1, 5], [1, 6], [0, 6]]'");
  check_saved(place, result, "no strength of the joints could hold the blocks");
  CHECK(summary_of(place).at("verdict") == "no_equilibrium");
  CHECK(states_in(place.folder() / "out/blocks.csv") == std::set<std::string>{"failed", "initial"});
}

TEST_CASE("no static equilibrium to start from", "[cli][not_converged]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  const CommandResult result = place.run("run scene.toml -o out --dt 0.001 --end 0.1 --start settled --set settle.failure_displacement_m=0.05");
  check_saved(place, result, "no static equilibrium to start from (displacement, limited by settle.failure_displacement_m)");
  CHECK(states_in(place.folder() / "out/blocks.csv") == std::set<std::string>{"initial", "start", "final"});
  CHECK(summary_of(place).at("settling").at("settled") == false);
  CHECK(summary_of(place).at("time_s") == 0.0);
}

TEST_CASE("a run that gets stuck on its way", "[cli][not_converged]") {
  const Workplace place;
  const CommandResult result = place.run(
      "run scene.toml -o out --dt 0.001 --end 1 --contact shi --start unloaded --set solver.max_open_close_iterations=1 "
      "--set 'block[1].vertices_m=[[0, 0.001], [1, 0.001], [1, 1], [0, 1]]' --set solver.smallest_fraction=0.5");
  check_saved(place, result, "open-close iterations did not settle");
  const double time = summary_of(place).at("time_s");
  CHECK(time > 0.005);
  CHECK(time < 0.02);
  const auto history = lines_of(place.folder() / "out/history.csv");
  REQUIRE(history.size() > 5);
  CHECK(std::stod(history.back()) == time);
  // The last state is there once, although it is the one of a regular row, too.
  CHECK(std::stod(history[history.size() - 2]) < time);
  CHECK(lines_of(place.folder() / "out/energy.csv").size() == history.size());
  CHECK(states_in(place.folder() / "out/blocks.csv").count("final") == 1);
}

TEST_CASE("a run that the watch refuses", "[cli][not_converged]") {
  const Workplace place;
  const CommandResult result = place.run("run scene.toml -o out --dt 0.001 --end 1 --start unloaded --set joint[0].normal_stiffness_pa_per_m=2e4");
  check_saved(place, result, "the springs are too soft for these blocks", 1);
  CHECK_THAT(result.errors[0], ContainsSubstring("normal_stiffness_pa_per_m = 20000 is hardly meant"));
  CHECK_THAT(result.errors[1], ContainsSubstring("refused at t = ") && ContainsSubstring("joint[0].normal_stiffness_pa_per_m = "));
  const nlohmann::json watch = summary_of(place).at("watch");
  CHECK(watch.at("penetration") > 0.25);
  CHECK(watch.at("checks") >= 100);
  CHECK(watch.at("created_energy") < 0.01);
  CHECK(summary_of(place).at("ended_by") == "");
}
