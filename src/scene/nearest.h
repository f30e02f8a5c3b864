// Suggestions for a word that the program does not know.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace openclose {

/// The accepted words for an error message, those most like `word` first; of many, only the first few and how many there are.
std::string suggestions(const std::string& word, std::vector<std::string> accepted);

/// The accepted word that the user may have meant: few letters differ.
std::optional<std::string> similar(const std::string& word, const std::vector<std::string>& accepted);

/// ", did you mean hard?", or nothing.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& accepted);

/// A key without the unit at its end: "density_kg_per_m3" -> "density". Units are SI and those a user may be tempted to write instead.
std::string without_unit(const std::string& key);

/// The accepted keys that mean the same quantity in another unit (or with the unit left out, or added).
std::vector<std::string> same_quantity(const std::string& key, const std::vector<std::string>& accepted);

}  // namespace openclose
