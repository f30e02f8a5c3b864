// How deep the keys of a TOML text go, found out before it is parsed.
#pragma once

#include <optional>
#include <string_view>

namespace openclose {

/// A key of more parts, such as a.b.c, has no place in a scene, whose own keys have three at most. The parser makes a table of each part and takes
/// them apart again one inside the other, so that some ten thousand parts would overflow the stack.
inline constexpr int most_key_parts = 16;

/// The first line on which a key has more parts; none: there is no such line. Comments and texts of several lines are no keys.
std::optional<int> line_of_deep_key(std::string_view text);

}  // namespace openclose
