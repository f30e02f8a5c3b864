#include "openclose/scene/nearest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>
#include <utility>

namespace openclose {
namespace {

constexpr std::size_t longest_list = 15;          // the keys of [method], the largest table for users, all fit
constexpr std::size_t most_misspelt_letters = 3;  // two letters exchanged, and one forgotten; with more of them another word may be meant

constexpr std::size_t shortest_misspelt = 3;  // [letters] of two every other word is one letter away

constexpr std::array<std::string_view, 45> unit_words{
    "per", "m",   "mm",  "cm",   "km",  "ft",  "m2",  "mm2", "cm2",     "m3",      "mm3", "cm3", "s",       "s2",     "ms",
    "us",  "min", "h",   "hour", "day", "hz",  "kg",  "g",   "t",       "mg",      "lb",  "n",   "kn",      "mn",     "gn",
    "pa",  "kpa", "mpa", "gpa",  "bar", "psi", "deg", "rad", "degrees", "radians", "nm",  "knm", "seconds", "metres", "meters",
};

bool is_unit_word(std::string_view word) {
  return std::find(unit_words.begin(), unit_words.end(), word) != unit_words.end();
}

/// Optimal string alignment (F. J. Damerau, 1964): single characters inserted, deleted or replaced, or two neighbours exchanged.
/// Of what is longer than any name the beginning tells as much.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  constexpr std::size_t longest_compared = 100;
  a = a.substr(0, longest_compared);
  b = b.substr(0, longest_compared);
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::swap(before, above);
    std::swap(above, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({above[j] + (a[i] == b[j] ? 0 : 1), above[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j]) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row[b.size()];
}

/// Of a word of three letters one may be wrong: "fso", "cud".
bool may_be_meant(std::size_t distance, const std::string& name) {
  const std::size_t too_many = name.size() < shortest_misspelt ? 1 : std::max<std::size_t>(2, name.size() / 2);
  return distance <= most_misspelt_letters && distance < too_many;
}

/// Of the whole name, or of a part that may be meant, as people remember "friction" of joint.friction_angle_deg.
std::size_t distance_of_parts(const std::string& word, const std::string& name) {
  std::size_t least = edit_distance(word, name);
  for (std::size_t begin = 0; begin < name.size();) {
    const std::size_t end = std::min(name.find_first_of("_.", begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    const std::size_t distance = edit_distance(word, part);
    if (may_be_meant(distance, part)) least = std::min(least, distance + 1);
    begin = end + 1;
  }
  return least;
}

}  // namespace

std::string suggestions(const std::string& word, std::vector<std::string> accepted) {
  std::ranges::stable_sort(accepted, {}, [&](const std::string& name) { return distance_of_parts(word, name); });
  const std::size_t shown = std::min(accepted.size(), longest_list);
  std::string text = fmt::format("{}", fmt::join(accepted.begin(), accepted.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  if (shown < accepted.size()) text += fmt::format(" ... ({} in all)", accepted.size());
  return text;
}

std::optional<std::string> similar(const std::string& word, const std::vector<std::string>& accepted) {
  const auto distance = [&](const std::string& candidate) { return edit_distance(word, candidate); };
  const auto nearest = std::ranges::min_element(accepted, {}, distance);
  if (nearest == accepted.end() || !may_be_meant(distance(*nearest), *nearest)) return std::nullopt;
  return *nearest;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& accepted) {
  const std::optional<std::string> meant = similar(word, accepted);
  return meant ? fmt::format(", did you mean {}?", *meant) : "";
}

std::string without_unit(const std::string& key) {
  std::string rest = key;
  for (std::size_t cut = rest.rfind('_'); cut != std::string::npos && is_unit_word(std::string_view(rest).substr(cut + 1)); cut = rest.rfind('_')) {
    rest.resize(cut);
  }
  return rest;
}

std::vector<std::string> same_quantity(const std::string& key, const std::vector<std::string>& accepted) {
  std::vector<std::string> same;
  for (const std::string& candidate : accepted) {
    if (without_unit(candidate) == without_unit(key)) same.push_back(candidate);
  }
  return same;
}

}  // namespace openclose
