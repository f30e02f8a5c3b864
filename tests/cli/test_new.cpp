// The new command: scenes that can be checked and analysed at once, and files that it leaves alone.
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using openclose::test::CommandResult;
using openclose::test::text_of;
using openclose::test::Workplace;

namespace {

using Names = std::set<std::string>;

}  // namespace

TEST_CASE("new writes scenes that check takes without a warning", "[cli][new]") {
  const Workplace place("");
  for (const std::string kind : {"arch", "slope", "wall"}) {
    INFO(kind);
    const CommandResult written = place.run("new " + kind);
    CHECK(written.status == 0);
    CHECK(written.errors.empty());
    CHECK_THAT(written.out, StartsWith(kind + ".toml: ") && ContainsSubstring("openclose fos " + kind + ".toml"));
    const CommandResult checked = place.run("check " + kind + ".toml");
    CHECK(checked.status == 0);
    CHECK(checked.errors.empty());
  }
  CHECK(place.folder().entries() == Names{"arch.toml", "slope.toml", "wall.toml"});
  CHECK(place.run("run wall.toml --end 0.01 -q").status == 0);
}

TEST_CASE("new takes dimensions", "[cli][new]") {
  const Workplace place("");
  CHECK(place.run("new wall --courses 3 --bricks 4 -q -o low.toml").out.empty());
  CHECK_THAT(place.run("check low.toml").out, StartsWith("low.toml: 14 blocks, 13 of them free"));
  const CommandResult json = place.run("new arch --voussoirs 21 --json");
  CHECK(json.status == 0);
  CHECK_THAT(json.out, ContainsSubstring("\"kind\": \"arch\"") && ContainsSubstring("\"blocks\": 23") && ContainsSubstring("\"arch.toml\""));
}

TEST_CASE("new replaces a scene as long as nobody has edited it", "[cli][new]") {
  const Workplace place("");
  REQUIRE(place.run("new arch -o a.toml").status == 0);
  const std::string first = text_of(place.folder() / "a.toml");
  REQUIRE(place.run("new arch --voussoirs 9 -o a.toml").status == 0);
  const std::string second = text_of(place.folder() / "a.toml");
  CHECK(first != second);
  std::ofstream(place.folder() / "a.toml", std::ios::app) << "# mine\n";
  std::ofstream(place.folder() / "mine.toml") << "# of openclose\n";
  for (const std::string file : {"a.toml", "mine.toml", "."}) {
    INFO(file);
    const CommandResult refused = place.run("new arch -o " + file);
    CHECK(refused.status == 2);
    CHECK(refused.out.empty());
    REQUIRE(refused.errors.size() == 1);
    CHECK_THAT(refused.errors[0], StartsWith("openclose: " + file + ": is there, and is not as openclose new has written it; accepted: "));
  }
  CHECK(text_of(place.folder() / "a.toml") == second + "# mine\n");
  CHECK(text_of(place.folder() / "mine.toml") == "# of openclose\n");
}

TEST_CASE("new refuses what makes no scene, and writes nothing", "[cli][new]") {
  const Workplace place("");
  for (const auto& [arguments, message] :
       {std::pair("new", "kind"), std::pair("new bridge", "kind"), std::pair("new arch --height-m 3", "new arch: height_m: it has no such dimension"),
        std::pair("new arch --radius-m -1", "new arch: radius_m: -1 is out of range; accepted: a number > 0"),
        std::pair("new arch --radius-m two", "--radius-m")}) {
    INFO(arguments);
    const CommandResult refused = place.run(arguments);
    CHECK(refused.status == 2);
    CHECK(refused.out.empty());
    REQUIRE(refused.errors.size() == 1);
    CHECK_THAT(refused.errors[0], StartsWith("openclose: ") && ContainsSubstring(message));
    CHECK(place.folder().entries().empty());
  }
}
