#include "command_tree.h"

#include <algorithm>
#include <map>

#include "openclose/io/key_reference.h"
#include "openclose/scene/keys.h"

namespace openclose {
namespace {

/// Short for a key, whose words they accept.
const std::map<std::string, std::string> key_of_option = {
    {"--contact", "method.contact"}, {"--start", "method.start"}, {"--integrator", "method.integrator"}};
const std::map<std::string, CommandOption::Value> kind_of_option = {
    {"scene", CommandOption::Value::file},       {"results", CommandOption::Value::folder},    {"--output", CommandOption::Value::file},
    {"--svg", CommandOption::Value::file},       {"--spectrum", CommandOption::Value::file},   {"--restart", CommandOption::Value::file},
    {"--set", CommandOption::Value::assignment}, {"--vary", CommandOption::Value::assignment}, {"key", CommandOption::Value::key}};

std::vector<std::string> words_of_key(const std::string& dotted) {
  std::vector<std::string> words;
  for (const KeyEntry& entry : option_keys()) {
    if (entry.dotted() == dotted) words = accepted_words(entry);
  }
  return words;
}

/// What CLI11 says of an option with a set of words: "TEXT:{fos,run}".
std::vector<std::string> words_in(const std::string& type_name) {
  const std::size_t begin = type_name.find('{'), end = type_name.rfind('}');
  std::vector<std::string> words;
  if (begin == std::string::npos || end == std::string::npos) return words;
  words.emplace_back();
  for (const char c : type_name.substr(begin + 1, end - begin - 1)) {
    if (c == ',') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

CommandOption option_of(const CLI::Option& option) {
  CommandOption found;
  found.help = option.get_description();
  found.is_argument = option.get_positional();
  if (found.is_argument) {
    found.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) found.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) found.names.push_back("--" + name);
  }
  found.has_value = option.get_items_expected_max() > 0;
  found.words = words_in(option.get_type_name());
  for (const std::string& name : found.names) {
    if (const auto key = key_of_option.find(name); key != key_of_option.end()) found.words = words_of_key(key->second);
    if (const auto kind = kind_of_option.find(name); kind != kind_of_option.end()) found.value = kind->second;
  }
  return found;
}

std::vector<CommandOption> options_of(const CLI::App& app) {
  std::vector<CommandOption> options;
  for (const CLI::Option* option : app.get_options()) options.push_back(option_of(*option));
  // Arguments in their order, then options.
  std::stable_partition(options.begin(), options.end(), [](const CommandOption& option) { return option.is_argument; });
  return options;
}

}  // namespace

CommandTree command_tree(const CLI::App& app) {
  CommandTree tree{app.get_description(), options_of(app), {}};
  for (const CLI::App* command : app.get_subcommands(nullptr))
    tree.commands.push_back({command->get_name(), command->get_description(), options_of(*command)});
  return tree;
}

std::vector<std::string> assignable_keys() {
  std::vector<std::string> keys;
  for (const KeyEntry& entry : option_keys()) keys.push_back(entry.dotted());
  for (const KeyEntry& entry : element_keys()) {
    const std::string table(entry.table.name);
    const bool is_single = table.empty() || table == "domain" || table == "base_motion";
    keys.push_back(is_single ? entry.dotted() : table + "[0]." + std::string(entry.key.name));
  }
  return keys;
}

}  // namespace openclose
