// What a value of the scene file may be, in a form that can be both checked and told to the user.
#pragma once

#include <limits>
#include <string>
#include <string_view>

namespace openclose {

/// An interval of finite numbers.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_included = false;
  bool high_included = false;

  bool contains(double value) const;
  /// E.g. "a number > 0", "a whole number in [1, 1000]"; `noun` is "number" or "whole number".
  std::string describe(const std::string& noun) const;
};

inline constexpr Range any_number{};
inline constexpr Range positive{.low = 0.0};
inline constexpr Range not_negative{.low = 0.0, .low_included = true};
inline constexpr Range between_0_and_1{.low = 0.0, .high = 1.0};
inline constexpr Range from_0_to_1{.low = 0.0, .high = 1.0, .low_included = true, .high_included = true};
/// Of steps, iterations: 10^9 of anything is out of reach.
inline constexpr Range at_least_one{.low = 1.0, .high = 1e9, .low_included = true, .high_included = true};

/// A word that stands for the value of an enumeration.
template <typename Enum>
struct Word {
  std::string_view text;
  Enum value;
  std::string_view says;  ///< what it chooses, in a phrase
};
template <typename Enum>
Word(const char*, Enum, const char*) -> Word<Enum>;

/// The word for a value; every value has one.
template <typename Words, typename Enum>
constexpr std::string_view word_for(const Words& words, Enum value) {
  for (const auto& word : words) {
    if (word.value == value) return word.text;
  }
  return {};
}

}  // namespace openclose
