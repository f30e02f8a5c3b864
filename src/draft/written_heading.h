// The first line of a scene that `openclose new` has written, from which one can see whether anybody has edited it since.
#pragma once

#include <string>

namespace openclose {

/// The text below a line that names the program and holds a sum of the text.
std::string with_heading(const std::string& text);

/// Whether a file has such a line and the sum of what stands below it is still the same.
bool is_as_written(const std::string& file);

}  // namespace openclose
