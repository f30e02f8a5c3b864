#include "openclose/scene/former_keys.h"

#include <fmt/format.h>

#include <utility>

#include "openclose/scene/keys.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

std::pair<std::string_view, std::string_view> split(std::string_view dotted) {
  const std::size_t dot = dotted.find('.');
  return {dotted.substr(0, dot), dotted.substr(dot + 1)};
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
  node->visit([&](auto& value) { to->insert_or_assign(entry.key.name, std::move(value)); });
  from->erase(old_key);
}

}  // namespace

void move_former_keys(toml::table& document, const std::string& file, std::vector<std::string>& warnings) {
  for (const KeyEntry& entry : key_entries(Scene{})) {
    if (!entry.key.formerly.empty()) move(document, file, entry, warnings);
  }
}

std::string with_current_key(const std::string& key_and_value, const std::string& file, std::vector<std::string>& warnings) {
  const std::size_t equals = key_and_value.find('=');
  const std::string key = key_and_value.substr(0, key_and_value.find_last_not_of(' ', equals == 0 ? 0 : equals - 1) + 1);
  for (const KeyEntry& entry : key_entries(Scene{})) {
    if (equals == std::string::npos || entry.key.formerly.empty() || entry.key.formerly != key) continue;
    warnings.push_back(warning(fmt::format("{}: --set {}", file, key), entry));
    return entry.dotted() + key_and_value.substr(equals);
  }
  return key_and_value;
}

}  // namespace openclose
