// openclose new: a scene to begin with.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace openclose {

/// \param chosen  gets what the command does, if it is the one that was asked for
void add_new(CLI::App& app, std::function<int()>& chosen);

}  // namespace openclose
