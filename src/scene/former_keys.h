// Keys under the names that earlier versions had for them.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <vector>

namespace openclose {

/// Moves the values of former keys to where they stand today, and takes out keys that are not there any more, each with a warning. Throws InputError
/// where a file has both.
void move_former_keys(toml::table& document, const std::string& file, std::vector<std::string>& warnings);

/// "KEY=VALUE" with the name that the key has today, with a warning if it was a former one; none for a key that is not there any more.
std::optional<std::string> with_current_key(const std::string& key_and_value, const std::string& file, std::vector<std::string>& warnings);

}  // namespace openclose
