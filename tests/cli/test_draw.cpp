// `draw`: pictures of results, and nothing written over what is no picture.
#include <filesystem>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::CommandResult;
using openclose::test::text_of;
using openclose::test::Workplace;

TEST_CASE("draw writes a picture into the folder, or where it is told to", "[cli][draw]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  const CommandResult result = place.run("draw out");
  CHECK(result.status == 0);
  CHECK(result.errors.empty());
  CHECK_THAT(result.out, ContainsSubstring("2 blocks drawn") && ContainsSubstring("written to out/drawing.svg"));
  CHECK_THAT(text_of(place.folder() / "out/drawing.svg"), StartsWith("<svg "));
  for (const std::string colour : {"material", "displacement", "velocity", "state"}) {
    const CommandResult coloured =
        place.run("draw out --quiet --forces --cracks --state start --colour " + colour + " -o pictures/" + colour + ".svg");
    CHECK(coloured.status == 0);
    CHECK(coloured.out.empty());
    CHECK_THAT(text_of(place.folder() / ("pictures/" + colour + ".svg")), StartsWith("<svg "));
  }
  // The next run takes the picture of this one away.
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  CHECK_FALSE(std::filesystem::exists(place.folder() / "out/drawing.svg"));
}

TEST_CASE("draw shows a scene beside its file, before anything is computed", "[cli][draw]") {
  const Workplace place("gravity_m_per_s2 = [1, -1]\n" + openclose::test::block_on_incline(30.0));
  const CommandResult result = place.run("draw scene.toml");
  CHECK(result.status == 0);
  CHECK(result.out == "scene.toml: 2 blocks drawn; written to scene.svg\n");
  CHECK_THAT(text_of(place.folder() / "scene.svg"), StartsWith("<svg ") && ContainsSubstring("gravity is turned by 45 degrees to the right"));
  CHECK_FALSE(std::filesystem::exists(place.folder() / "results"));
  for (const std::string option : {"--state final", "--forces", "--cracks", "--colour velocity"}) {
    const CommandResult refused = place.run("draw scene.toml " + option + " -o other.svg");
    CHECK(refused.status == 2);
    REQUIRE(refused.errors.size() == 1);
    CHECK_THAT(refused.errors[0], ContainsSubstring("a scene has no states"));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "other.svg"));
  }
}

TEST_CASE("draw and report refuse tables that are not those of the summary", "[cli][draw]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  const std::string table = text_of(place.folder() / "out/contacts.csv");
  const auto refused = [&](const std::string& message) {
    for (const std::string command : {"draw", "report"}) {
      const CommandResult result = place.run(command + " out");
      CHECK(result.status == 2);
      REQUIRE(result.errors.size() == 1);
      CHECK_THAT(result.errors[0], ContainsSubstring("out/contacts.csv: ") && ContainsSubstring(message));
    }
  };
  place.folder().write("out/contacts.csv", table.substr(0, table.rfind('\n', table.size() - 2) + 1));
  refused("cut off, changed or of another analysis");
  std::filesystem::remove(place.folder() / "out/contacts.csv");
  refused("there is no such file");
  place.folder().write("out/contacts.csv", table);
  CHECK(place.run("draw out").status == 0);
}

TEST_CASE("draw shows the mechanism of a factor of safety with the factor", "[cli][draw]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("fos scene.toml -o out -q").status == 0);
  const CommandResult result = place.run("draw out");
  CHECK(result.status == 0);
  CHECK_THAT(result.out, ContainsSubstring("factor of safety 1.21"));
  CHECK_THAT(text_of(place.folder() / "out/drawing.svg"), ContainsSubstring("factor of safety 1.21") && ContainsSubstring("class=\"velocities\""));
}

TEST_CASE("draw refuses in one line, and writes nothing", "[cli][draw]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("run scene.toml -o out --dt 0.001 --end 0.01 -q").status == 0);
  const std::string scene = text_of(place.folder() / "scene.toml"), blocks = text_of(place.folder() / "out/blocks.csv");
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    INFO(arguments);
    const CommandResult result = place.run("draw " + arguments);
    CHECK(result.status == 2);
    CHECK(result.out.empty());
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], StartsWith("openclose: ") && ContainsSubstring(message));
    CHECK_FALSE(std::filesystem::exists(place.folder() / "out/drawing.svg"));
  };
  refused("nowhere", "nowhere: there is no such folder or file; accepted: the folder of a run or fos, results/<name of the scene> by default, or a scene");
  refused("out --state finl", "there is no state \"finl\", did you mean \"final\"?; accepted: \"final\"");
  refused("out --colour red", "red");
  refused("out -o scene.toml", "a name that ends in .svg");
  refused("out -o out/blocks.csv", "a name that ends in .svg");
  refused("", "results");
  CHECK(text_of(place.folder() / "scene.toml") == scene);
  CHECK(text_of(place.folder() / "out/blocks.csv") == blocks);
}

TEST_CASE("draw and report name a case where they are given a folder of cases", "[cli][draw]") {
  const Workplace place(openclose::test::block_on_incline(30.0));
  REQUIRE(place.run("sweep scene.toml --vary joint[0].friction_angle_deg=35,36 -o out -q").status == 0);
  for (const std::string command : {"draw", "report"}) {
    const CommandResult result = place.run(command + " out");
    CHECK(result.status == 2);
    REQUIRE(result.errors.size() == 1);
    CHECK_THAT(result.errors[0], ContainsSubstring("out: this is a folder of sweep; accepted: the folder of one of its cases, e.g. "
                                                   "out/joint[0].friction_angle_deg=35"));
  }
}
