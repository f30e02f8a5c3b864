// openclose study: a quantity of a scene against the time step, and what it costs.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace openclose {

/// \param chosen  gets what the command does, if it is the one that was asked for
void add_study(CLI::App& app, std::function<int()>& chosen);

}  // namespace openclose
