#include "shell_commands.h"

#include <fmt/format.h>

#include <memory>

#include "completion.h"
#include "manual.h"
#include "openclose/core/error.h"
#include "openclose/io/text_files.h"
#include "option_errors.h"

namespace openclose {
namespace {

std::vector<TextFile> shell_files(const CommandTree& tree, const std::string& folder) {
  std::vector<TextFile> files = {{folder + "/openclose.1", manual_page(tree, "")}};
  for (const CommandEntry& command : tree.commands) files.push_back({folder + "/openclose-" + command.name + ".1", manual_page(tree, command.name)});
  for (const std::string& shell : completion_shells()) files.push_back({folder + "/completion." + shell, completion_script(tree, shell)});
  return files;
}

}  // namespace

void add_shell_commands(CLI::App& app, std::function<int()>& chosen) {
  const auto word = std::make_shared<std::string>(), folder = std::make_shared<std::string>();
  std::vector<std::string> pages;
  for (const CLI::App* command : app.get_subcommands(nullptr)) pages.push_back(command->get_name());

  CLI::App* completion = app.add_subcommand("completion", "print a script with which a shell completes commands, options and keys");
  completion->add_option("shell", *word, "bash: source <(openclose completion bash); zsh: the same; fish: openclose completion fish | source")
      ->required()
      ->check(one_of(completion_shells()));
  completion->callback([&app, &chosen, word] {
    chosen = [&app, word] {
      fmt::print("{}", completion_script(command_tree(app), *word));
      return exit_success;
    };
  });

  pages.insert(pages.end(), {"completion", "manual"});
  CLI::App* manual = app.add_subcommand("manual", "print the manual page of the program or of a command, as man -l - reads it");
  manual->add_option("command", *word, "a command; none: the program")->check(one_of(pages));
  manual->add_option("--write", *folder, "write all pages and completions into this folder instead");
  manual->callback([&app, &chosen, word, folder] {
    chosen = [&app, word, folder] {
      const CommandTree tree = command_tree(app);
      if (folder->empty()) {
        fmt::print("{}", manual_page(tree, *word));
      } else {
        write_files(shell_files(tree, *folder));
      }
      return exit_success;
    };
  });
}

}  // namespace openclose
