#include "manual.h"

#include <fmt/format.h>

#include <algorithm>

#include "openclose/version.h"

namespace openclose {
namespace {

/// A hyphen is one that can be copied, a backslash none of roff's, and no line begins with a control character.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result.starts_with('.') || result.starts_with('\'') ? "\\&" + result : result;
}

std::string heading(const std::string& name, const std::string& purpose) {
  std::string upper = name;
  std::ranges::transform(upper, upper.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return fmt::format(".TH \"{}\" 1 \"\" \"openclose {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n", roff(upper), version, roff(name), roff(purpose));
}

std::string values_of(const CommandOption& option) {
  if (!option.has_value) return "";
  if (!option.words.empty()) {
    std::string words;
    for (const std::string& word : option.words) words += (words.empty() ? "" : "|") + word;
    return " " + words;
  }
  return option.value == CommandOption::Value::assignment ? " KEY=VALUE" : " VALUE";
}

std::string options_section(const std::vector<CommandOption>& options) {
  std::string text;
  for (const bool argument : {true, false}) {
    if (std::ranges::none_of(options, [&](const CommandOption& o) { return o.is_argument == argument; })) continue;
    text += argument ? ".SH ARGUMENTS\n" : ".SH OPTIONS\n";
    for (const CommandOption& option : options) {
      if (option.is_argument != argument) continue;
      std::string names;
      for (const std::string& name : option.names) names += (names.empty() ? "\\fB" : ", \\fB") + roff(name) + "\\fR";
      text += fmt::format(".TP\n{}{}\n{}\n", names, argument ? "" : roff(values_of(option)), roff(option.help));
    }
  }
  return text;
}

constexpr const char* ends = R"(.SH EXIT STATUS
.TP
0
success
.TP
1
not converged, refused or no proved factor; state and reason are saved
.TP
2
bad input; nothing is written
.TP
3
broken off: a result cannot be written, or an internal error
)";

std::string program_page(const CommandTree& tree) {
  std::string text = heading("openclose", "2-D block systems of jointed rock and masonry");
  text +=
      ".SH SYNOPSIS\n\\fBopenclose\\fR COMMAND ...\n.SH DESCRIPTION\nOpenclose analyses systems of rigid blocks in two dimensions: whether they "
      "stand, at what strength they fail, "
      "and how they move after failure. A scene is a TOML file whose keys carry their units; \\fBopenclose explain\\fR KEY tells what a key "
      "does.\n.SH COMMANDS\n";
  for (const CommandEntry& command : tree.commands)
    text += fmt::format(".TP\n\\fBopenclose {}\\fR\n{}; see \\fBopenclose\\-{}\\fR(1)\n", roff(command.name), roff(command.help), roff(command.name));
  return text + options_section(tree.options) + ends;
}

}  // namespace

std::string manual_page(const CommandTree& tree, const std::string& command) {
  if (command.empty()) return program_page(tree);
  const CommandEntry& entry = *std::ranges::find(tree.commands, command, &CommandEntry::name);
  std::string text = heading("openclose-" + entry.name, entry.help);
  text += ".SH SYNOPSIS\n\\fBopenclose " + roff(entry.name) + "\\fR";
  for (const CommandOption& option : entry.options) {
    if (option.is_argument) text += " " + roff(option.names.front());
  }
  return text + " [OPTIONS]\n" + options_section(entry.options) + ends + ".SH SEE ALSO\n\\fBopenclose\\fR(1)\n";
}

}  // namespace openclose
