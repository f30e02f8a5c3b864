// `--json`: one object on standard output whatever happens, with the numbers of the tables.
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using nlohmann::json;
using openclose::test::CommandResult;
using openclose::test::text_of;
using openclose::test::Workplace;

namespace {

/// All of standard output is one object, which says how the command ended.
json object_of(const CommandResult& result) {
  const json object = json::parse(result.out, nullptr, false);
  REQUIRE(object.is_object());
  CHECK(object.at("exit_status") == result.status);
  return object;
}

}  // namespace

TEST_CASE("run and fos print their summary as JSON", "[cli][json]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  for (const std::string command : {"run scene.toml --dt 0.001 --end 0.01", "fos scene.toml"}) {
    INFO(command);
    const CommandResult result = place.run(command + " -o out --json");
    CHECK(result.status == 0);
    json object = object_of(result);
    CHECK(object.at("folder") == "out");
    object.erase("folder");
    object.erase("exit_status");
    CHECK(object == json::parse(text_of(place.folder() / "out/summary.json")));
  }
  CHECK(object_of(place.run("fos scene.toml -o out --json")).at("factor_of_safety").get<double>() == Approx(1.2127).epsilon(1e-3));
}

TEST_CASE("what does not converge, and bad input, are JSON, too", "[cli][json]") {
  const Workplace place(openclose::test::block_on_incline(60.0));
  const CommandResult stopped = place.run("run scene.toml --dt 0.001 --end 0.01 -o out --json");
  CHECK(stopped.status == 1);
  CHECK(object_of(stopped).at("converged") == false);
  for (const std::string command : {"run nothing.toml --json", "run scene.toml --json", "fos scene.toml --set joint[0].friction=3 --json",
                                    "rum --json", "--json", "draw out2 --json", "run scene.toml --json --dt", "sweep scene.toml --json",
                                    "report out2 --json", "check scene.toml --json --spectrum scene.toml"}) {
    INFO(command);
    const CommandResult result = place.run(command);
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK("openclose: " + object_of(result).at("error").get<std::string>() == result.errors[0]);
  }
}

TEST_CASE("the other commands tell as JSON what they tell as text", "[cli][json]") {
  const Workplace place(openclose::test::block_on_incline(40.0));
  CHECK(object_of(place.run("check scene.toml --json")).at("free_blocks") == 1);
  CHECK(object_of(place.run("check scene.toml --json --contact dem")).at("critical_step_s").get<double>() > 0.0);
  REQUIRE(place.run("fos scene.toml -o out -q").status == 0);
  CHECK(object_of(place.run("draw out --json")).at("written").at(0) == "out/drawing.svg");
  CHECK(object_of(place.run("report out --json")).at("written").at(0) == "out/report.html");
  const json swept = object_of(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=30:35:5 -o sweep --json"));
  REQUIRE(swept.at("rows").size() == 2);
  CHECK(swept.at("rows").at(1).at("factor_of_safety").is_number());
  CHECK(swept.at("rows").at(1).at("message").is_null());
  const json studied = object_of(place.run("study scene.toml --dt 0.01,0.005 --end 0.1 --set method.start=unloaded -o study --json"));
  CHECK(studied.at("rows").size() == 2);
  CHECK(studied.at("limits").at(0).at("how") == "the smallest step");
}
