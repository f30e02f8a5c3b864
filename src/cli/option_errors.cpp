#include "option_errors.h"

#include <fmt/format.h>

#include "openclose/scene/nearest.h"
#include "openclose/study/variation.h"

namespace openclose {
namespace {

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    // An option without a group is not told in the help, either.
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// What is wrong with a line without a command, and which ones there are.
std::string no_command(const CLI::App& app, const std::vector<std::string>& arguments, const std::string& parsed) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  if (arguments.empty() || arguments[0].starts_with('-')) return fmt::format("{}; accepted: {}", parsed, fmt::join(names, ", "));
  const std::string& word = arguments[0];
  return fmt::format("{}: there is no such command{}; accepted: {}", word, did_you_mean(word, names), fmt::join(names, ", "));
}

/// What the command did not expect, an option before a value that may belong to it.
std::string unexpected(const CLI::App& command) {
  const std::vector<std::string> rest = command.remaining();
  for (const std::string& argument : rest) {
    if (!argument.starts_with("--")) continue;
    const std::string name = argument.substr(0, argument.find('='));
    const std::vector<std::string> names = option_names(command);
    return fmt::format("{}: {} has no such option{}; accepted: {}", name, command.get_name(), did_you_mean(name, names), suggestions(name, names));
  }
  return rest.empty() ? "" : fmt::format("{}: {} expects no such word here", rest.front(), command.get_name());
}

}  // namespace

CLI::Validator one_of(const std::vector<std::string>& words) {
  return {[words](const std::string& word) {
            if (std::ranges::find(words, word) != words.end()) return std::string();
            return fmt::format("\"{}\" is not known{}; accepted: {}", word, did_you_mean(word, words), suggestions(word, words));
          },
          fmt::format("{{{}}}", fmt::join(words, ","))};
}

CLI::Validator finite_number() {
  return {[](const std::string& text) { return number_from(text) ? std::string() : fmt::format("{} is no finite number", text); }, ""};
}

std::string words_of(const CLI::ParseError& error, const CLI::App& app, const std::vector<std::string>& arguments) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  if (commands.empty()) return no_command(app, arguments, error.what()) + "; see openclose --help";
  const CLI::App& command = *commands.front();
  std::string what = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ? unexpected(command) : "";
  if (what.empty()) what = error.what();
  return fmt::format("{}; see openclose {} --help", what, command.get_name());
}

}  // namespace openclose
