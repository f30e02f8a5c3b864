#include "openclose/io/key_reference.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "openclose/core/error.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/nearest.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

using nlohmann::ordered_json;

/// The names that a text may be; they stand in the registries.
std::vector<std::string> known_names(NameIn list) {
  std::vector<std::string> names;
  if (list == NameIn::enforcements) {
    for (const auto& entry : enforcements<3>()) names.emplace_back(entry.name);
  } else {
    for (const auto& entry : integrators<3>()) names.emplace_back(entry.name);
  }
  return names;
}

std::vector<std::string> accepted_words(const KeyEntry& entry) {
  if (entry.names) return known_names(*entry.names);
  return {entry.words.begin(), entry.words.end()};
}

std::string accepted(const KeyEntry& entry) {
  switch (entry.type) {
    case ValueType::boolean:
      return "true or false";
    case ValueType::number:
      return entry.range.describe("number");
    case ValueType::whole_number:
      return entry.range.describe("whole number");
    case ValueType::list:
      return fmt::format("a list, each {}{}", entry.range.describe("number"), entry.increasing ? " and above the one before" : "");
    case ValueType::text:
    case ValueType::word: {
      std::vector<std::string> quoted;
      for (const std::string& word : accepted_words(entry)) quoted.push_back(in_quotes(word));
      return fmt::format("{}", fmt::join(quoted, ", "));
    }
  }
  return {};
}

std::string default_of(const KeyEntry& entry) {
  return entry.value ? *entry.value : std::string(entry.key.absent);
}

void add_tables(std::string& page, Audience audience) {
  std::string_view table;
  for (const KeyEntry& entry : key_entries(Scene{})) {
    if (entry.table.audience != audience) continue;
    if (entry.table.name != table)
      page += fmt::format("\n## [{}]\n\n{}.\n\n| key | unit | default | accepted | what it does |\n|---|---|---|---|---|\n", entry.table.name,
                          entry.table.says);
    table = entry.table.name;
    page +=
        fmt::format("| `{}` | {} | {} | {} | {} |\n", entry.key.name, unit_of(entry.key.name), default_of(entry), accepted(entry), entry.key.says);
  }
}

ordered_json number_schema(const KeyEntry& entry, const char* type) {
  ordered_json schema = {{"type", type}};
  if (std::isfinite(entry.range.low)) schema[entry.range.low_included ? "minimum" : "exclusiveMinimum"] = entry.range.low;
  if (std::isfinite(entry.range.high)) schema[entry.range.high_included ? "maximum" : "exclusiveMaximum"] = entry.range.high;
  return schema;
}

ordered_json value_schema(const KeyEntry& entry) {
  switch (entry.type) {
    case ValueType::boolean:
      return {{"type", "boolean"}};
    case ValueType::number:
      return number_schema(entry, "number");
    case ValueType::whole_number:
      return number_schema(entry, "integer");
    case ValueType::list:
      return {{"type", "array"}, {"items", number_schema(entry, "number")}};
    case ValueType::text:
    case ValueType::word:
      return {{"type", "string"}, {"enum", accepted_words(entry)}};
  }
  return {};
}

ordered_json key_schema(const KeyEntry& entry) {
  ordered_json schema = value_schema(entry);
  const std::string unit = unit_of(entry.key.name);
  schema["description"] = fmt::format("{}{}", unit.empty() ? "" : "[" + unit + "] ", entry.key.says);
  if (entry.value) schema["default"] = ordered_json::parse(*entry.value);
  return schema;
}

std::string explained(const KeyEntry& entry) {
  std::string text = fmt::format("{}: {}\n", entry.dotted(), entry.key.says);
  const std::string unit = unit_of(entry.key.name), value = default_of(entry);
  if (!unit.empty()) text += fmt::format("  unit      {}\n", unit);
  text += fmt::format("  accepted  {}\n", accepted(entry));
  if (!value.empty()) text += fmt::format("  default   {}\n", value);
  if (!entry.key.formerly.empty()) text += fmt::format("  formerly  {}\n", entry.key.formerly);
  return text;
}

}  // namespace

std::string keys_page() {
  std::string page =
      "<!-- Made by `openclose explain --page` from the tables of keys in src/scene; a test fails if it is not up to date. -->\n"
      "# Keys of a scene file\n\n"
      "The options of an analysis, table by table; the blocks, joints and forces themselves are in [scenes](scene.md). Every key can be left out, be "
      "set on the command line (`--set method.theta=0.5`) and be asked for (`openclose explain theta`). `summary.json` has all of them as they were "
      "used.\n";
  add_tables(page, Audience::user);
  page +=
      "\n# For developers\n\n"
      "Nobody needs these tables to get an answer: they are for measurements, comparisons and the rare step that does not converge.\n";
  add_tables(page, Audience::developer);
  return page;
}

std::string scene_schema() {
  ordered_json tables = ordered_json::object();
  for (const KeyEntry& entry : key_entries(Scene{})) {
    ordered_json& table = tables[std::string(entry.table.name)];
    if (table.is_null())
      table = {{"type", "object"}, {"description", entry.table.says}, {"additionalProperties", false}, {"properties", ordered_json::object()}};
    table["properties"][std::string(entry.key.name)] = key_schema(entry);
  }
  const ordered_json schema = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Scene of Openclose"}, {"type", "object"}, {"properties", tables}};
  return schema.dump(1) + "\n";
}

std::string explanation_of(const std::string& key) {
  std::string text;
  std::vector<std::string> known;
  for (const KeyEntry& entry : key_entries(Scene{})) {
    known.push_back(entry.dotted());
    if (key == entry.dotted() || key == entry.key.name || key == entry.table.name || key == entry.key.formerly) text += explained(entry);
  }
  if (!text.empty()) return text;
  throw InputError({"explain", 0}, key, "this key is not known", suggestions(key, known));
}

}  // namespace openclose
