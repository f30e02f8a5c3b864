#include "openclose/study/variation.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "openclose/core/error.h"

namespace openclose {
namespace {

constexpr const char* accepted_form = "KEY=FROM:TO:STEP or KEY=A,B,C, e.g. joint[0].friction_angle_deg=25:40:1";
/// More cases than this are a mistake in a step.
constexpr std::size_t most_cases = 100'000;
/// [-] Of a step: rounding of the ends does not lose the last value.
constexpr double rounding_of_steps = 1e-6;

/// The numbers of a text that has nothing else but hyphens, dashes or two dots between them, as in 25-40, 25-40-5 and 25..40; none where it is no
/// such text.
std::vector<std::string> joined_numbers(const std::string& text) {
  for (const std::string separator : {"-", "\u2013", ".."}) {
    // From the second character on: a hyphen before a number is its sign.
    for (std::size_t place = text.find(separator, 1); place != std::string::npos; place = text.find(separator, place + 1)) {
      const std::string first = text.substr(0, place), rest = text.substr(place + separator.size());
      if (!number_from(first)) continue;
      std::vector<std::string> numbers = number_from(rest) ? std::vector{rest} : joined_numbers(rest);
      if (numbers.empty()) continue;
      numbers.insert(numbers.begin(), first);
      return numbers;
    }
  }
  return {};
}

/// A range as people write it elsewhere would be taken for a word, and be refused only as the value of the key. A name like "1-2" has quotes here.
void require_no_hyphens(const std::string& text, const std::string& key, std::string value) {
  std::erase(value, ' ');
  const std::vector<std::string> numbers = joined_numbers(value);
  if (numbers.empty()) return;
  const std::string step = numbers.size() == 3 ? numbers[2] : "STEP";
  throw InputError({"--vary " + text, 0}, "", "a range has colons", fmt::format("{}={}:{}:{}", key, numbers[0], numbers[1], step));
}

/// Split where no bracket and no quote is open.
std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  int depth = 0;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (c == separator && depth == 0 && !quoted) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::vector<std::string> stepped(const std::string& text, const std::vector<std::string>& parts) {
  const auto from = number_from(parts[0]), to = number_from(parts[1]), step = number_from(parts[2]);
  if (!from || !to || !step) throw InputError({"--vary " + text, 0}, "", "FROM, TO and STEP are not all numbers", accepted_form);
  const double steps = *step == 0.0 ? -1.0 : (*to - *from) / *step;
  if (steps < 0.0) throw InputError({"--vary " + text, 0}, "", "the step does not lead from FROM to TO", accepted_form);
  if (steps > static_cast<double>(most_cases))
    throw InputError({"--vary " + text, 0}, "", fmt::format("{:.3g} values", steps), fmt::format("at most {}", most_cases));
  std::vector<std::string> values;
  for (int i = 0; i <= steps + rounding_of_steps; ++i) values.push_back(fmt::format("{:.12g}", *from + i * *step));
  return values;
}

}  // namespace

std::optional<double> number_from(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

Variation variation_from(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw InputError({"--vary " + text, 0}, "", "this does not say which values a key gets", accepted_form);
  Variation variation{text.substr(0, equals), {}};
  const std::string list = text.substr(equals + 1);
  const std::vector<std::string> parts = split(list, ':');
  if (parts.size() == 3) {
    variation.values = stepped(text, parts);
  } else if (parts.size() == 1) {
    variation.values = split(list, ',');
    for (const std::string& value : variation.values) {
      if (value.empty()) throw InputError({"--vary " + text, 0}, "", "a value is empty", accepted_form);
      require_no_hyphens(text, variation.key, value);
    }
  } else {
    throw InputError({"--vary " + text, 0}, "", "this is no range", accepted_form);
  }
  return variation;
}

std::vector<std::vector<std::string>> combinations(const std::vector<Variation>& variations) {
  std::vector<std::vector<std::string>> list(1);
  for (const Variation& variation : variations) {
    if (list.size() * variation.values.size() > most_cases)
      throw InputError({"--vary", 0}, "", "too many combinations of values", fmt::format("at most {} cases", most_cases));
    std::vector<std::vector<std::string>> longer;
    for (const auto& assignments : list) {
      for (const std::string& value : variation.values) {
        longer.push_back(assignments);
        longer.back().push_back(variation.key + "=" + value);
      }
    }
    list = std::move(longer);
  }
  return list;
}

}  // namespace openclose
