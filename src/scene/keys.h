// The tables of keys with the values of a scene, as data: for what writes values and for what describes keys.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "openclose/scene/key.h"
#include "openclose/scene/scene.h"

namespace openclose {

enum class ValueType { boolean, number, whole_number, text, word, list };

/// A row with the value of its member.
struct KeyEntry {
  KeyTable table;
  Key key;
  ValueType type = ValueType::boolean;
  Range range{};                        ///< of numbers, and of each number of a list
  bool increasing = false;              ///< of a list
  std::vector<std::string_view> words;  ///< of ValueType::word
  std::optional<NameIn> names;          ///< of ValueType::text: where they are looked up
  std::optional<std::string> value;     ///< as TOML and JSON; absent where the key was not given and has no default of its own

  std::string dotted() const { return std::string(table.name) + '.' + std::string(key.name); }
};

/// All rows with the values of the scene, in the order of the tables.
std::vector<KeyEntry> key_entries(const Scene& scene);

/// The unit at the end of a key's name as one writes it: "dt_s" -> "s", "penalty_pa_per_m" -> "Pa/m"; empty for a number without one.
std::string unit_of(std::string_view key);

/// The dotted keys of other tables that have this name.
std::vector<std::string> tables_with(const std::string& name);

/// The dotted key most like this one, if it is hardly more than misspelt.
std::optional<std::string> similar_key(const std::string& dotted);

}  // namespace openclose
