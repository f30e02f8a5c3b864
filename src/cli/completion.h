// Scripts with which a shell completes the command: subcommands, options, words, keys of --set.
#pragma once

#include <string>
#include <vector>

#include "command_tree.h"

namespace openclose {

/// Names of the shells, as the command line takes them.
const std::vector<std::string>& completion_shells();

/// \param shell  one of completion_shells()
std::string completion_script(const CommandTree& tree, const std::string& shell);

}  // namespace openclose
