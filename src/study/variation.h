// Keys of a scene and the values they are to have, one after the other.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace openclose {

struct Variation {
  std::string key;
  std::vector<std::string> values;
};

/// \param text  "KEY=FROM:TO:STEP" (with both ends, where a step ends there) or "KEY=A,B,C"; values are those of --set
/// Throws InputError for anything else.
Variation variation_from(const std::string& text);

/// "KEY=VALUE" of each variation, for every combination; the last key runs fastest. Throws InputError where there are more than anyone runs.
std::vector<std::vector<std::string>> combinations(const std::vector<Variation>& variations);

/// The finite number that a text is, and nothing else.
std::optional<double> number_from(const std::string& text);

}  // namespace openclose
