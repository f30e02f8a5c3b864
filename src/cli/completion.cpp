#include "completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace openclose {
namespace {

using Value = CommandOption::Value;

std::string joined(const std::vector<std::string>& words, const char* between = " ") {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// In single quotes, as all three shells have them.
std::string in_single_quotes(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

/// The first sentence is what a list of choices has room for.
std::string first_sentence(const std::string& help) {
  return help.substr(0, std::min({help.find(": "), help.find("; "), help.find(" (")}));
}

std::vector<std::string> names_of(const std::vector<CommandOption>& options) {
  std::vector<std::string> names;
  for (const CommandOption& option : options) {
    if (!option.is_argument) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

std::vector<std::string> names_of(const std::vector<CommandEntry>& commands) {
  std::vector<std::string> names;
  for (const CommandEntry& command : commands) names.push_back(command.name);
  return names;
}

/// The arguments of a command that are keys; else they are files or folders.
bool takes_key(const CommandEntry& command) {
  return std::ranges::any_of(command.options, [](const CommandOption& o) { return o.is_argument && o.value == Value::key; });
}

const CommandOption* argument_words(const CommandEntry& command) {
  const auto place = std::ranges::find_if(command.options, [](const CommandOption& o) { return o.is_argument && !o.words.empty(); });
  return place == command.options.end() ? nullptr : &*place;
}

std::string keys_for_explain() {
  std::vector<std::string> keys = assignable_keys();
  for (std::string& key : keys) {
    const std::size_t index = key.find("[0]");
    if (index != std::string::npos) key.erase(index, 3);
  }
  return joined(keys);
}

constexpr const char* bash_template = R"(# bash completion of openclose, made by: openclose completion bash
_openclose() {{
  local current previous command options arguments choices files=1 i
  local keys={keys}
  local assignable={assignable}
  current=${{COMP_WORDS[COMP_CWORD]}}
  previous=${{COMP_WORDS[COMP_CWORD-1]}}
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${{COMP_WORDS[i]}} in -*) ;; *) command=${{COMP_WORDS[i]}}; break ;; esac
  done
  COMPREPLY=()
  if [ -z "$command" ]; then
    COMPREPLY=($(compgen -W {commands} -- "$current"))
    return
  fi
  case $command in
{options}  esac
  case $command:$previous in
{words}    *) choices=; files=2 ;;
  esac
  if [ -n "$choices" ]; then
    local IFS=$' \t\n'
    COMPREPLY=($(compgen -W "$choices" -- "$current"))
    return
  fi
  if [ "$files" = 2 ]; then
    case $current in
      -*) COMPREPLY=($(compgen -W "$options" -- "$current")); return ;;
    esac
    [ -z "$arguments" ] || {{ COMPREPLY=($(compgen -W "$arguments" -- "$current")); return; }}
  fi
  [ -z "$files" ] || compopt -o default
}}
complete -F _openclose openclose
)";

std::string bash_script(const CommandTree& tree) {
  std::string options, words;
  for (const CommandEntry& command : tree.commands) {
    const CommandOption* argument = argument_words(command);
    options += fmt::format("    {}) options={}; arguments={} ;;\n", command.name, in_single_quotes(joined(names_of(command.options))),
                           takes_key(command) ? "\"$keys\"" : in_single_quotes(argument ? joined(argument->words) : ""));
    for (const CommandOption& option : command.options) {
      if (option.is_argument || !option.has_value) continue;
      std::string action = "files=1";
      if (!option.words.empty()) {
        action = "choices=" + in_single_quotes(joined(option.words));
      } else if (option.value == Value::assignment) {
        action = "choices=$assignable; compopt -o nospace";
      } else if (option.value == Value::other) {
        action = "files=";
      }
      for (const std::string& name : option.names) words += fmt::format("    {}:{}) {} ;;\n", command.name, name, action);
    }
  }
  std::string assignable;
  for (const std::string& key : assignable_keys()) assignable += key + "= ";
  return fmt::format(fmt::runtime(bash_template), fmt::arg("keys", in_single_quotes(keys_for_explain())),
                     fmt::arg("assignable", in_single_quotes(assignable)),
                     fmt::arg("commands", in_single_quotes(joined(names_of(tree.commands)) + " --help --version")), fmt::arg("options", options),
                     fmt::arg("words", words));
}

/// Within "[...]" of zsh's _arguments these have a meaning of their own.
std::string zsh_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::string_view("[]:\\").find(c) != std::string_view::npos) result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_action(const CommandOption& option) {
  if (!option.words.empty()) return fmt::format(":value:({})", joined(option.words));
  switch (option.value) {
    case Value::assignment:
      return ":assignment:compadd -S= -a assignable";
    case Value::key:
      return ":key:compadd -a keys";
    case Value::folder:
      return ":folder:_files -/";
    case Value::file:
      return ":file:_files";
    case Value::other:
      break;
  }
  return ":value: ";
}

std::string zsh_script(const CommandTree& tree) {
  std::string commands, cases;
  for (const CommandEntry& command : tree.commands) {
    commands += fmt::format("    {}\n", in_single_quotes(command.name + ":" + zsh_text(first_sentence(command.help))));
    cases += fmt::format("    {})\n      _arguments -s \\\n", command.name);
    for (const CommandOption& option : command.options) {
      const std::string action = option.has_value || option.is_argument ? zsh_action(option) : "";
      if (option.is_argument) {
        cases += fmt::format("        {} \\\n", in_single_quotes(":" + action.substr(action.find(':') == 0 ? 1 : 0)));
        continue;
      }
      for (const std::string& name : option.names)
        cases += fmt::format("        {} \\\n", in_single_quotes("*" + name + "[" + zsh_text(first_sentence(option.help)) + "]" + action));
    }
    cases += "        && return ;;\n";
  }
  // Each in quotes: an index in brackets would be a pattern.
  std::vector<std::string> assignable = assignable_keys();
  for (std::string& key : assignable) key = in_single_quotes(key);
  return fmt::format(R"(#compdef openclose
# zsh completion of openclose, made by: openclose completion zsh
_openclose() {{
  local -a commands keys assignable
  keys=({keys})
  assignable=({assignable})
  commands=(
{commands}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{cases}  esac
}}
if [ "$funcstack[1]" = _openclose ]; then _openclose "$@"; else compdef _openclose openclose; fi
)",
                     fmt::arg("keys", keys_for_explain()), fmt::arg("assignable", joined(assignable)), fmt::arg("commands", commands),
                     fmt::arg("cases", cases));
}

std::string fish_script(const CommandTree& tree) {
  std::string text = "# fish completion of openclose, made by: openclose completion fish\n";
  const std::string all = joined(names_of(tree.commands));
  std::string assignable;
  for (const std::string& key : assignable_keys()) assignable += key + "= ";
  for (const CommandEntry& command : tree.commands) {
    text += fmt::format("complete -c openclose -f -n 'not __fish_seen_subcommand_from {}' -a {} -d {}\n", all, command.name,
                        in_single_quotes(first_sentence(command.help)));
    const std::string here = fmt::format("complete -c openclose -n '__fish_seen_subcommand_from {}'", command.name);
    for (const CommandOption& option : command.options) {
      if (option.is_argument) {
        if (option.value == Value::key) text += fmt::format("{} -f -a {}\n", here, in_single_quotes(keys_for_explain()));
        if (!option.words.empty()) text += fmt::format("{} -f -a {}\n", here, in_single_quotes(joined(option.words)));
        continue;
      }
      text += here;
      for (const std::string& name : option.names) text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.has_value) text += option.value == Value::file || option.value == Value::folder ? " -r" : " -x";
      if (!option.words.empty()) text += " -a " + in_single_quotes(joined(option.words));
      if (option.value == Value::assignment) text += " -a " + in_single_quotes(assignable);
      text += fmt::format(" -d {}\n", in_single_quotes(first_sentence(option.help)));
    }
  }
  return text;
}

}  // namespace

const std::vector<std::string>& completion_shells() {
  static const std::vector<std::string> shells = {"bash", "zsh", "fish"};
  return shells;
}

std::string completion_script(const CommandTree& tree, const std::string& shell) {
  if (shell == "bash") return bash_script(tree);
  return shell == "zsh" ? zsh_script(tree) : fish_script(tree);
}

}  // namespace openclose
