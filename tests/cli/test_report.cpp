// `report`: a page of results, and nothing written over what is no page.
#include <filesystem>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::CommandResult;
using openclose::test::text_of;
using openclose::test::Workplace;

TEST_CASE("report writes a page into the folder, or where it is told to", "[cli][report]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  const CommandResult result = place.run("report out");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, ContainsSubstring("page of 3 states") && ContainsSubstring("written to out/report.html"));
  CHECK_THAT(text_of(place.folder() / "out/report.html"), StartsWith("<!DOCTYPE html>"));
  const CommandResult elsewhere = place.run("report out --quiet --most-mb 1 -o pages/a.html");
  CHECK(elsewhere.status == 0);
  CHECK(elsewhere.out.empty());
  CHECK_THAT(text_of(place.folder() / "pages/a.html"), StartsWith("<!DOCTYPE html>"));
  // The next run here takes the page of this one away.
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out/report.html"));
}

TEST_CASE("report has the factor of safety as fos prints it", "[cli][report]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("fos scene.toml -o out -q").status == 0);
  CHECK_THAT(place.run("report out").out, ContainsSubstring("factor of safety 1.21"));
  CHECK_THAT(text_of(place.folder() / "out/report.html"), ContainsSubstring("\"answer\":\"factor of safety 1.21"));
}

TEST_CASE("report refuses in one line, and writes nothing", "[cli][report]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  const std::string scene = text_of(place.folder() / "scene.toml"), blocks = text_of(place.folder() / "out/blocks.csv");
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    INFO(arguments);
    const CommandResult result = place.run("report " + arguments);
    CHECK(result.status == 2);
    CHECK(result.out.empty());
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], StartsWith("openclose: ") && ContainsSubstring(message));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "out/report.html"));
  };
  refused("nowhere", "nowhere: there is no such folder");
  refused("out -o scene.toml", "a name that ends in .html");
  refused("out -o out/blocks.csv", "a name that ends in .html");
  refused("out --most-mb 0", "--most-mb");
  refused("out --most-mb nan", "nan is no finite number");
  refused("", "results");
  CHECK(text_of(place.folder() / "scene.toml") == scene);
  CHECK(text_of(place.folder() / "out/blocks.csv") == blocks);
  // What a message quotes does not cut it off.
  const std::string row = "initial,base,0,";
  const std::size_t number = blocks.find(row) + row.size();
  place.folder().write("out/blocks.csv", blocks.substr(0, number) + std::string("\0\x1b", 2) + blocks.substr(number));
  refused("out", "out/blocks.csv:2: x_m: \"\\x00\\x1b-");
  refused("out", "is no finite number; accepted: a number");
}
