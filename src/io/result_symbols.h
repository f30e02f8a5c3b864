// What holds, pushes and is measured, from the summary of results, where the blocks of a state have taken it.
#pragma once

#include <vector>

#include "openclose/io/drawing.h"
#include "openclose/io/result_folder.h"

namespace openclose {

/// Adds supports, loads, the push that grows and measured points. \param now  outlines of the state, in the order of the blocks of the drawing
void add_symbols(const ResultFolder& folder, const BlockIndex& blocks, const std::vector<Polygon>& now, Picture& picture);

}  // namespace openclose
