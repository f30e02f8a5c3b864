// Completions and manual pages: they know every command and option that --help knows.
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "cli/command.h"
#include "support/catch.h"

using Catch::Matchers::ContainsSubstring;
using openclose::test::text_of;
using openclose::test::Workplace;

namespace {

std::set<std::string> found(const std::string& text, const std::string& pattern) {
  std::set<std::string> names;
  const std::regex expression(pattern, std::regex::multiline);
  for (std::sregex_iterator i(text.begin(), text.end(), expression), end; i != end; ++i) names.insert((*i)[1]);
  return names;
}

}  // namespace

TEST_CASE("every command has a manual page with all of its options, and completions of all shells have them", "[cli][shell]") {
  const Workplace place("");
  const std::string help = place.run("--help").out;
  const std::set<std::string> commands = found(help.substr(help.find("Subcommands")), "^  ([a-z]+)");
  REQUIRE(commands.count("run") + commands.count("sweep") == 2);
  REQUIRE(place.run("manual --write pages").status == 0);
  const std::string bash = text_of(place.folder() / "pages/completion.bash"), zsh = text_of(place.folder() / "pages/completion.zsh"),
                    fish = text_of(place.folder() / "pages/completion.fish");
  for (const std::string& command : commands) {
    INFO(command);
    const std::string page = text_of(place.folder() / ("pages/openclose-" + command + ".1"));
    CHECK(page == place.run("manual " + command).out);
    CHECK_THAT(text_of(place.folder() / "pages/openclose.1"), ContainsSubstring("openclose " + command + "\\fR"));
    for (const std::string& option : found(place.run(command + " --help").out, "(--[a-z-]+)[ ,]")) {
      INFO(option);
      CHECK_THAT(page, ContainsSubstring(std::regex_replace(option, std::regex("-"), "\\-")));
      CHECK_THAT(bash, ContainsSubstring(option));
      CHECK_THAT(zsh, ContainsSubstring("*" + option + "["));
      CHECK_THAT(fish, ContainsSubstring("'__fish_seen_subcommand_from " + command + "'"));
    }
  }
  CHECK_THAT(bash, ContainsSubstring("joint[0].friction_angle_deg=") && ContainsSubstring("soft hard shi dem"));
  for (const std::string* shell : {&bash, &zsh, &fish}) CHECK_THAT(*shell, ContainsSubstring("tr_bdf2"));  // the words of an option's key
  CHECK(place.run("completion bash").out == bash);
}

TEST_CASE("shells and pages that there are not are refused", "[cli][shell]") {
  const Workplace place("");
  for (const std::string arguments : {"completion", "completion csh", "manual nothing"}) {
    INFO(arguments);
    const auto result = place.run(arguments);
    CHECK(result.status == 2);
    CHECK(result.errors.size() == 1);
  }
}
