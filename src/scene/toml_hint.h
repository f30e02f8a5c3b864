// What is likely meant by a line that is no TOML.
#pragma once

#include <string>
#include <string_view>

namespace openclose {

/// What is accepted in place of the line: for text without quotes, a decimal comma, a unit behind a number and a table that stands there twice with
/// an example, else the format alone.
std::string accepted_instead_of(std::string_view line);

}  // namespace openclose
