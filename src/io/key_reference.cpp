#include "openclose/io/key_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "openclose/core/error.h"
#include "openclose/integrator/integrators.h"
#include "openclose/integrator/registry.h"
#include "openclose/io/formats.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/nearest.h"
#include "openclose/scene/table.h"

namespace openclose {
namespace {

using nlohmann::ordered_json;

template <typename Entries>
std::vector<KnownWord> words_in(const Entries& registry) {
  std::vector<KnownWord> words;
  for (const auto& entry : registry) words.push_back({entry.name, entry.summary});
  return words;
}

/// The words of the key, or those that stand in the registry where it is looked up.
std::vector<KnownWord> known_words(const KeyEntry& key) {
  if (!key.names) return key.words;
  switch (*key.names) {
    case NameIn::enforcements:
      return words_in(enforcements());
    case NameIn::integrators:
      return words_in(integrators());
    case NameIn::formats:
      return words_in(output_formats());
  }
  return {};
}

std::string accepted_names(const KeyEntry& entry) {
  std::vector<std::string> quoted;
  for (const std::string& word : accepted_words(entry)) quoted.push_back(in_quotes(word));
  return fmt::format("{}", fmt::join(quoted, ", "));
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
      return entry.names ? accepted_names(entry) : "a text";
    case ValueType::word:
      return accepted_names(entry);
    case ValueType::names:
      return entry.names ? "a list of " + accepted_names(entry) : "a list of names";
    case ValueType::vector:
      return "[x, y], each " + entry.range.describe("number");
    case ValueType::polygon:
      return "[[x, y], ...], 3 points or more";
    case ValueType::polygons:
      return "a list of polygons";
  }
  return {};
}

/// A line for each word: "a": what it chooses. Empty for keys without words.
std::string lines_of_words(const KeyEntry& entry, const std::string& begin) {
  std::string lines;
  for (const KnownWord& word : known_words(entry)) lines += fmt::format("{}{}: {}", begin, in_quotes(word.text), word.says);
  return lines;
}

std::string default_of(const KeyEntry& entry) {
  if (entry.key.required) return "required";
  return entry.value ? *entry.value : std::string(entry.key.absent);
}

std::string sentence(std::string_view text) {
  std::string with_capital(text);
  with_capital.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(with_capital.front())));
  return with_capital + ".";
}

std::string heading(const KeyTable& table) {
  if (table.name.empty()) return "## The scene as a whole";
  return table.many ? fmt::format("## [[{}]]", table.name) : fmt::format("## [{}]", table.name);
}

/// What the words of a table's keys choose; below the table, whose columns they would widen. Keys with the same words share a list.
void add_words(std::string& page, std::span<const KeyEntry> table) {
  std::vector<std::pair<std::string, std::string>> lines;  // the words and the keys that accept them
  for (const KeyEntry& entry : table) {
    const std::string words = lines_of_words(entry, "\n  - "), key = fmt::format("`{}`", entry.key.name);
    if (words.empty()) continue;
    const auto place = std::ranges::find(lines, words, &std::pair<std::string, std::string>::first);
    if (place == lines.end()) {
      lines.emplace_back(words, key);
    } else {
      place->second += ", " + key;
    }
  }
  if (!lines.empty()) page += '\n';
  for (const auto& [words, keys] : lines) page += fmt::format("- {}{}\n", keys, words);
}

void add_tables(std::string& page, const std::vector<KeyEntry>& entries, Audience audience) {
  for (auto first = entries.begin(); first != entries.end();) {
    const auto end = std::find_if(first, entries.end(), [&](const KeyEntry& entry) { return entry.table.name != first->table.name; });
    const std::span table(&*first, static_cast<std::size_t>(end - first));
    first = end;
    if (table.front().table.audience != audience) continue;
    page += fmt::format("\n{}\n\n{}\n\n| key | unit | default | accepted | what it does |\n|---|---|---|---|---|\n", heading(table.front().table),
                        sentence(table.front().table.says));
    for (const KeyEntry& entry : table) {
      page +=
          fmt::format("| `{}` | {} | {} | {} | {} |\n", entry.key.name, unit_of(entry.key.name), default_of(entry), accepted(entry), entry.key.says);
    }
    add_words(page, table);
  }
}

ordered_json number_schema(const KeyEntry& entry, const char* type) {
  ordered_json schema = {{"type", type}};
  if (std::isfinite(entry.range.low)) schema[entry.range.low_included ? "minimum" : "exclusiveMinimum"] = entry.range.low;
  if (std::isfinite(entry.range.high)) schema[entry.range.high_included ? "maximum" : "exclusiveMaximum"] = entry.range.high;
  return schema;
}

ordered_json list_of(const ordered_json& item, int at_least = 0) {
  ordered_json schema = {{"type", "array"}, {"items", item}};
  if (at_least > 0) schema["minItems"] = at_least;
  return schema;
}

ordered_json vector_schema(const KeyEntry& entry) {
  ordered_json schema = list_of(number_schema(entry, "number"), 2);
  schema["maxItems"] = 2;
  return schema;
}

ordered_json word_schema(const KeyEntry& entry) {
  ordered_json schema = {{"type", "string"}};
  if (const std::vector<std::string> words = accepted_words(entry); !words.empty()) schema["enum"] = words;
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
      return list_of(number_schema(entry, "number"));
    case ValueType::text:
    case ValueType::word:
      return word_schema(entry);
    case ValueType::names:
      return list_of(word_schema(entry));
    case ValueType::vector:
      return vector_schema(entry);
    case ValueType::polygon:
      return list_of(vector_schema(entry), 3);
    case ValueType::polygons:
      return list_of(list_of(vector_schema(entry), 3));
  }
  return {};
}

ordered_json key_schema(const KeyEntry& entry) {
  ordered_json schema = value_schema(entry);
  const std::string unit = unit_of(entry.key.name);
  schema["description"] = fmt::format("{}{}{}", unit.empty() ? "" : "[" + unit + "] ", entry.key.says, lines_of_words(entry, "\n"));
  if (entry.value) schema["default"] = ordered_json::parse(*entry.value);
  return schema;
}

/// For a terminal: "[methods](methods.md)" -> "docs/methods.md".
std::string without_links(std::string_view page) {
  std::string text;
  while (!page.empty()) {
    const std::size_t middle = page.find("]("), begin = page.substr(0, middle).rfind('['), end = page.find(')', std::min(middle, page.size()));
    if (middle == std::string_view::npos || begin == std::string_view::npos || end == std::string_view::npos) break;
    text += fmt::format("{}docs/{}", page.substr(0, begin), page.substr(middle + 2, end - middle - 2));
    page.remove_prefix(end + 1);
  }
  return text + std::string(page);
}

std::string explained(const KeyEntry& entry) {
  std::string text = fmt::format("{}: {}\n", entry.dotted(), without_links(entry.key.says));
  const std::string unit = unit_of(entry.key.name), value = default_of(entry);
  if (!unit.empty()) text += fmt::format("  unit      {}\n", unit);
  text += fmt::format("  accepted  {}\n", accepted(entry));
  const std::vector<KnownWord> words = known_words(entry);
  std::size_t longest = 0;
  for (const KnownWord& word : words) longest = std::max(longest, word.text.size());
  for (const KnownWord& word : words) text += fmt::format("            {:<{}}  {}\n", word.text, longest, without_links(word.says));
  if (!value.empty()) text += fmt::format("  default   {}\n", value);
  if (!entry.key.formerly.empty()) text += fmt::format("  formerly  {}\n", entry.key.formerly);
  return text;
}

}  // namespace

std::vector<std::string> accepted_words(const KeyEntry& entry) {
  std::vector<std::string> texts;
  for (const KnownWord& word : known_words(entry)) texts.emplace_back(word.text);
  return texts;
}

std::string keys_page() {
  std::string page =
      "<!-- Made by `openclose explain --page` from the tables of keys in src/scene; a test fails if it is not up to date. -->\n"
      "# Options of an analysis\n\n"
      "Every key here can be left out, be set on the command line (`--set method.theta=0.5`) and be asked for (`openclose explain theta`).\n"
      "`summary.json` has all of them as they were used.\n";
  add_tables(page, option_keys(), Audience::user);
  page +=
      "\n# What a scene is made of\n\nTables in double brackets stand there once for each thing. How they go together is in [scenes](scene.md).\n";
  add_tables(page, element_keys(), Audience::user);
  page +=
      "\n# For developers\n\n"
      "Nobody needs these tables to get an answer: they are for measurements, comparisons and the rare step that does not converge.\n";
  add_tables(page, option_keys(), Audience::developer);
  return page;
}

namespace {

/// The table of a dotted name in the schema, made where it is missing.
ordered_json& table_in(ordered_json& root, const KeyTable& table) {
  ordered_json* parent = &root;
  std::string_view name = table.name;
  if (name.empty()) return root;
  if (const std::size_t dot = name.find('.'); dot != std::string_view::npos) {
    parent = &root["properties"][std::string(name.substr(0, dot))];
    name.remove_prefix(dot + 1);
  }
  ordered_json& schema = (*parent)["properties"][std::string(name)];
  if (schema.is_null()) {
    const ordered_json object = {{"type", "object"}, {"additionalProperties", false}, {"properties", ordered_json::object()}};
    schema = table.many ? list_of(object) : object;
    schema["description"] = sentence(table.says);
  }
  return table.many ? schema["items"] : schema;
}

}  // namespace

std::string scene_schema() {
  ordered_json root = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                       {"title", "Scene of Openclose"},
                       {"type", "object"},
                       {"required", {"material"}},
                       {"additionalProperties", false},
                       {"properties", ordered_json::object()}};
  for (const auto* entries : {&element_keys(), &option_keys()}) {
    for (const KeyEntry& entry : *entries) {
      ordered_json& table = table_in(root, entry.table);
      table["properties"][std::string(entry.key.name)] = key_schema(entry);
      if (entry.key.required) table["required"].push_back(entry.key.name);
    }
  }
  return root.dump(1) + "\n";
}

std::string tables_in_words() {
  std::string text = "Tables of a scene; openclose explain TABLE tells their keys:\n";
  std::vector<std::string> told;
  for (const auto* entries : {&element_keys(), &option_keys()}) {
    for (const KeyEntry& entry : *entries) {
      const KeyTable& table = entry.table;
      const std::string name(table.name);
      if (name.empty() || std::ranges::find(told, name) != told.end()) continue;
      told.push_back(name);
      text += fmt::format("  {:<24}{}\n", table.many ? "[[" + name + "]]" : "[" + name + "]", without_links(table.says));
    }
  }
  return text;
}

std::string explanation_of(const std::string& key) {
  std::string text;
  std::vector<std::string> names;
  for (const auto* entries : {&option_keys(), &element_keys()}) {
    for (const KeyEntry& entry : *entries) {
      names.emplace_back(key.find('.') == std::string::npos ? std::string(entry.key.name) : entry.dotted());
      if (!entry.table.name.empty()) names.emplace_back(entry.table.name);
      if (key == entry.dotted() || key == entry.key.name || key == entry.table.name || key == entry.key.formerly) text += explained(entry);
    }
  }
  if (!text.empty()) return text;
  // Names such as `name` stand in several tables.
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const std::optional<std::string> meant = similar(key, names);
  throw InputError({"explain", 0}, key, meant ? fmt::format("this key is not known, did you mean {}?", *meant) : "this key is not known",
                   suggestions(key, names));
}

}  // namespace openclose
