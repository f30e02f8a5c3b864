// openclose completion and openclose manual: for shells and man(1), from the commands themselves.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace openclose {

/// To be called when all other commands are there.
/// \param chosen  gets what the command does, if one of these was asked for
void add_shell_commands(CLI::App& app, std::function<int()>& chosen);

}  // namespace openclose
