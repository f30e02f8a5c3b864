// openclose sweep: one answer for every combination of values of some keys.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace openclose {

/// \param chosen  gets what the command does, if it is the one that was asked for
void add_sweep(CLI::App& app, std::function<int()>& chosen);

}  // namespace openclose
