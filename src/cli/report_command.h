// openclose report: the results of a run or of a factor of safety as one HTML page.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace openclose {

/// \param chosen  gets what the command does, if it is the one that was asked for
void add_report(CLI::App& app, std::function<int()>& chosen);

}  // namespace openclose
