// Manual pages of the commands, made of what --help says.
#pragma once

#include <string>

#include "command_tree.h"

namespace openclose {

/// In roff (man-pages(7)). \param command  empty: the page of the program itself
std::string manual_page(const CommandTree& tree, const std::string& command);

}  // namespace openclose
