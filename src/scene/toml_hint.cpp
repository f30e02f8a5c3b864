#include "openclose/scene/toml_hint.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "openclose/scene/keys.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

constexpr const char* format_name = "TOML 1.0";
constexpr std::array<std::string_view, 6> words_of_toml = {"true", "false", "inf", "nan", "+inf", "-inf"};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t begin = text.find_first_not_of(blank);
  return begin == std::string_view::npos ? std::string_view() : text.substr(begin, text.find_last_not_of(blank) + 1 - begin);
}

bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// Whether there may be several tables of this name, each written [[name]].
bool may_be_many(std::string_view name) {
  return std::ranges::any_of(element_keys(), [&](const KeyEntry& entry) { return entry.table.many && entry.table.name == name; });
}

std::string hint_for_value(std::string_view key, std::string_view value) {
  if (is_letter(value.front()) && std::ranges::find(words_of_toml, value) == words_of_toml.end())
    return fmt::format(", where a text has quotes: {} = {}", key, in_quotes(value));
  const std::size_t digits = std::min(value.find_first_not_of("+-0123456789._"), value.size());
  if (digits == 0 || !is_digit(value[digits - 1]) || digits == value.size()) return "";
  const std::string_view rest = value.substr(digits);
  if (rest.size() > 1 && rest[0] == ',' && is_digit(rest[1]))
    return fmt::format(", where decimals follow a point: {} = {}.{}", key, value.substr(0, digits), rest.substr(1));
  if (is_letter(trimmed(rest).front()) || trimmed(rest).front() == '%')
    return fmt::format(", where a number stands alone, its unit being part of the key: {} = {}", key, value.substr(0, digits));
  return "";
}

}  // namespace

std::string accepted_instead_of(std::string_view line) {
  line = trimmed(line.substr(0, line.find('#')));
  if (line.size() > 2 && line.front() == '[' && line[1] != '[' && line.back() == ']') {
    const std::string_view name = trimmed(line.substr(1, line.size() - 2));
    return may_be_many(name) ? fmt::format("{0}, where a table that stands there several times has double brackets: [[{1}]]", format_name, name)
                             : std::string(format_name);
  }
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) return format_name;
  const std::string_view key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
  return key.empty() || value.empty() ? std::string(format_name) : format_name + hint_for_value(key, value);
}

}  // namespace openclose
