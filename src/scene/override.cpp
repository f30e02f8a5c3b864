#include "openclose/scene/override.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <vector>

#include "openclose/scene/key_depth.h"
#include "openclose/scene/nearest.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

constexpr std::size_t longest_list_of_names = 200;  ///< [characters] about
constexpr const char* accepted_form = "--set KEY=VALUE, e.g. --set joint[0].friction_angle_deg=20";

struct Override {
  std::string source;  ///< stands in for the name of the file
  std::string key;
  std::string value;

  [[noreturn]] void fail(const std::string& read, const std::string& accepted) const {
    throw_input_error({source, 0}, shortened(key), read, accepted);
  }
};

Override parse_override(const std::string& file, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw_input_error({file, 0}, "--set " + text, "this is no assignment", accepted_form);
  return {source_of_overrides(file), key_of_override(text), text.substr(equals + 1)};
}

bool is_word(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(),
                                      [](unsigned char letter) { return std::isalnum(letter) || letter == '_' || letter == '-' || letter == '.'; });
}

/// A table with the one key "value".
toml::table parse_value(const Override& override, const std::string& value) {
  try {
    toml::table table = toml::parse("value = " + value, override.source);
    if (table.size() == 1) return table;
  } catch (const toml::parse_error&) {
    if (is_word(value)) return parse_value(override, fmt::format("\"{}\"", value));
  }
  // A list of words whose quotes the shell has taken.
  const bool has_lost_quotes = value.starts_with('[') && value.find('"') == std::string::npos && value.find('\'') == std::string::npos;
  override.fail(in_quotes(value) + " is not a TOML value",
                std::string("a number, true, false, a text, or [x, y]") +
                    (has_lost_quotes ? "; texts in a list have quotes, which the shell leaves in '[\"a\", \"b\"]'" : ""));
}

/// The element of an array that an index names.
toml::node& element(const Override& override, toml::node& parent, std::size_t index) {
  toml::array* array = parent.as_array();
  if (array == nullptr) override.fail(fmt::format("[{}] follows something that is not an array", index), "a key that the scene has");
  if (index < array->size()) return *array->get(index);
  override.fail(fmt::format("there is no [{}]", index),
                array->empty() ? "no index, the array is empty" : fmt::format("[0] to [{}]", array->size() - 1));
}

/// "an index, [0] to [1], before it, or the name of an element: "bedding"". Where none has a name only the index is left.
std::string ways_to_elements(const toml::array& array) {
  std::string names;
  for (const toml::node& node : array) {
    const toml::table* table = node.as_table();
    const std::optional<std::string> name = table == nullptr ? std::nullopt : (*table)["name"].value<std::string>();
    if (name && names.size() < longest_list_of_names) names += fmt::format("{}{}", names.empty() ? ": " : ", ", in_quotes(*name));
  }
  return fmt::format("an index, [0] to [{}], before it, or the name of an element{}", array.size() - 1,
                     names.empty() ? "; none of them has one" : names);
}

std::vector<std::string> quoted_names(const toml::array& array) {
  std::vector<std::string> names;
  for (const toml::node& element : array) {
    const toml::table* table = element.as_table();
    const auto name = table == nullptr ? std::optional<std::string>() : (*table)["name"].value<std::string>();
    if (name) names.push_back(in_quotes(*name));
  }
  return names;
}

toml::table& as_table(const Override& override, toml::node& parent, const std::string& key) {
  if (toml::table* table = parent.as_table()) return *table;
  if (const toml::array* array = parent.as_array(); array != nullptr && !array->empty())
    override.fail(fmt::format("{} follows an array", in_quotes(key)), ways_to_elements(*array));
  override.fail(fmt::format("{} follows something that is not a table", in_quotes(key)), "a key that the scene has");
}

/// The element of an array that has this name: a block, a material, a load; null if none has.
toml::node* named_element(const Override& override, toml::node& parent, const std::string& name) {
  toml::array* array = parent.as_array();
  std::vector<std::size_t> found;
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    const toml::table* table = array->get(i)->as_table();
    if (table != nullptr && (*table)["name"].value<std::string>() == name) found.push_back(i);
  }
  if (found.size() > 1)
    override.fail(fmt::format("{} are called {}", found.size(), in_quotes(name)), fmt::format("an index, such as [{}]", found.front()));
  return found.empty() ? nullptr : array->get(found.front());
}

/// \param noun  what the parent is a list of, if it is one: "joint"
toml::node& member(const Override& override, toml::node& parent, const std::string& noun, const std::string& key) {
  if (toml::node* element = named_element(override, parent, key)) return *element;
  if (const toml::array* array = parent.as_array(); array != nullptr && !array->empty())
    override.fail(fmt::format("no {} is called {}{}", noun, in_quotes(key), did_you_mean(in_quotes(key), quoted_names(*array))),
                  ways_to_elements(*array));
  toml::table& table = as_table(override, parent, key);
  if (!table.contains(key)) table.insert_or_assign(key, std::move(*parse_value(override, "{}").get_as<toml::table>("value")));
  return *table.get(key);
}

}  // namespace

std::string key_of_override(const std::string& key_and_value) {
  const std::string key = key_and_value.substr(0, key_and_value.find('='));
  return key.substr(0, key.find_last_not_of(' ') + 1);
}

std::string source_of_overrides(const std::string& file) {
  return file + ": command line";
}

void apply_override(toml::table& scene, const std::string& file, const std::string& key_and_value) {
  const Override override = parse_override(file, key_and_value);
  if (line_of_deep_key(override.key) || line_of_deep_key(override.value))
    override.fail(fmt::format("a key has more than {} parts", most_key_parts), accepted_form);
  const toml::path path(override.key);
  // The parser of paths mends some that are wrong, e.g. "joint[0"; what it made of the key tells.
  if (path.empty() || path.str() != override.key) override.fail("this is not a dotted key", "one such as joint[0].friction_angle_deg");

  toml::table replacement = parse_value(override, override.value);
  toml::node* parent = &scene;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const toml::path_component& step = path[i];
    const bool is_key = step.type() == toml::path_component_type::key, is_below_key = i > 0 && path[i - 1].type() == toml::path_component_type::key;
    parent =
        is_key ? &member(override, *parent, is_below_key ? path[i - 1].key() : "element", step.key()) : &element(override, *parent, step.index());
  }

  const toml::path_component& last = path[path.size() - 1];
  replacement.get("value")->visit([&](auto& node) {
    if (last.type() == toml::path_component_type::key) {
      as_table(override, *parent, last.key()).insert_or_assign(last.key(), std::move(node));
    } else {
      element(override, *parent, last.index());
      toml::array& array = *parent->as_array();
      array.replace(array.cbegin() + static_cast<std::ptrdiff_t>(last.index()), std::move(node));
    }
  });
}

}  // namespace openclose
