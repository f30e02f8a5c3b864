#include "openclose/scene/former_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "openclose/scene/keys.h"
#include "openclose/scene/override.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

std::pair<std::string_view, std::string_view> split(std::string_view dotted) {
  const std::size_t dot = dotted.find('.');
  return {dotted.substr(0, dot), dotted.substr(dot + 1)};
}

/// Switches of earlier versions for what is always the same today: whatever a file says, it counts for nothing.
constexpr std::array retired_keys = {std::string_view("method.skip_unmoved"), std::string_view("solver.skip_unmoved")};

std::string warning_of_retired(const std::string& where, std::string_view key) {
  return fmt::format("{}: {} is not there any more and counts for nothing; leave it out", where, key);
}

void remove(toml::table& document, const std::string& file, std::string_view retired, std::vector<std::string>& warnings) {
  const auto [table, key] = split(retired);
  toml::table* of = document[table].as_table();
  const toml::node* node = of == nullptr ? nullptr : of->get(key);
  if (node == nullptr) return;
  const SourceLocation where = location(*node, file);
  warnings.push_back(warning_of_retired(fmt::format("{}:{}", where.file, where.line), retired));
  of->erase(key);
}

std::string warning(const std::string& where, const KeyEntry& entry) {
  return fmt::format("{}: {} is now {}; the old name is still read", where, entry.key.formerly, entry.dotted());
}

void move(toml::table& document, const std::string& file, const KeyEntry& entry, std::vector<std::string>& warnings) {
  const auto [old_table, old_key] = split(entry.key.formerly);
  toml::table* from = document[old_table].as_table();
  toml::node* node = from == nullptr ? nullptr : from->get(old_key);
  if (node == nullptr) return;
  if (!document.contains(entry.table.name)) document.insert(entry.table.name, toml::table{});
  toml::table* to = document[entry.table.name].as_table();
  if (to == nullptr) return;  // the reader refuses what stands in the place of the table
  const SourceLocation where = location(*node, file);
  if (const toml::node* there = to->get(entry.key.name); there != nullptr)
    throw_input_error(where, std::string(entry.key.formerly),
                      fmt::format("{} gives {}, the new name of this key, too", place_name(location(*there, file)), entry.dotted()),
                      "one of the two");
  warnings.push_back(warning(fmt::format("{}:{}", where.file, where.line), entry));
  if (node->is_boolean() && entry.type == ValueType::names) {
    // What was a switch of its own is now a name in a list.
    toml::array list;
    if (node->as_boolean()->get()) list.push_back(std::string(old_key));
    to->insert_or_assign(entry.key.name, std::move(list));
  } else {
    node->visit([&](auto& value) { to->insert_or_assign(entry.key.name, std::move(value)); });
  }
  from->erase(old_key);
}

}  // namespace

void move_former_keys(toml::table& document, const std::string& file, std::vector<std::string>& warnings) {
  for (const std::string_view retired : retired_keys) remove(document, file, retired, warnings);
  for (const KeyEntry& entry : option_keys()) {
    if (!entry.key.formerly.empty()) move(document, file, entry, warnings);
  }
}

std::optional<std::string> with_current_key(const std::string& key_and_value, const std::string& file, std::vector<std::string>& warnings) {
  const std::size_t equals = key_and_value.find('=');
  const std::string key = key_and_value.substr(0, key_and_value.find_last_not_of(' ', equals == 0 ? 0 : equals - 1) + 1);
  if (equals != std::string::npos && std::find(retired_keys.begin(), retired_keys.end(), key) != retired_keys.end()) {
    warnings.push_back(warning_of_retired(source_of_overrides(file), key));
    return std::nullopt;
  }
  for (const KeyEntry& entry : option_keys()) {
    if (equals == std::string::npos || entry.key.formerly.empty() || entry.key.formerly != key) continue;
    warnings.push_back(warning(source_of_overrides(file), entry));
    const std::string value = key_and_value.substr(equals + 1);
    if (entry.type != ValueType::names || (value != "true" && value != "false")) return entry.dotted() + "=" + value;
    return fmt::format("{}=[{}]", entry.dotted(), value == "true" ? in_quotes(split(key).second) : "");
  }
  return key_and_value;
}

}  // namespace openclose
