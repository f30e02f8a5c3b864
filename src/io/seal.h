// The last line of a file that is written as a whole: a sum of all that stands above it, from which one can see whether anybody has edited the file
// since. Only a file whose seal holds may be replaced without a word.
#pragma once

#include <string>
#include <string_view>

namespace openclose {

/// How the kind of a file writes a comment.
enum class Seal {
  none,
  hash,  ///< "# ...": TOML
  xml,   ///< "<!-- ... -->": SVG and HTML
};

/// The line to be added to the text; empty for Seal::none.
std::string seal_of(std::string_view text, Seal seal);

/// Whether a file ends in such a line, and its sum is that of what stands above.
bool is_sealed(std::string_view file, Seal seal);

}  // namespace openclose
