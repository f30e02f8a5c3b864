// The commands with their options as data, for what is made of them: completions of shells and manual pages.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace openclose {

struct CommandOption {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument that has no dash its name alone
  std::string help;
  bool is_argument = false;        ///< by its place, not by a name
  bool has_value = false;          ///< false: a flag
  std::vector<std::string> words;  ///< that it accepts; empty: others
  enum class Value { other, file, folder, key, assignment } value = Value::other;
};

struct CommandEntry {
  std::string name, help;
  std::vector<CommandOption> options;
};

struct CommandTree {
  std::string help;
  std::vector<CommandOption> options;
  std::vector<CommandEntry> commands;
};

CommandTree command_tree(const CLI::App& app);

/// Dotted keys of a scene as --set takes them; elements of arrays have the index [0].
std::vector<std::string> assignable_keys();

}  // namespace openclose
