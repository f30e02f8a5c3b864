// The tables of keys with the values of a scene, as data: for what writes values and for what describes keys.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "openclose/scene/key.h"
#include "openclose/scene/scene.h"

namespace openclose {

enum class ValueType { boolean, number, whole_number, text, word, list, names, vector, polygon, polygons };

/// A word that a key accepts, and what it chooses.
struct KnownWord {
  std::string_view text, says;
};

/// A row with the value of its member.
struct KeyEntry {
  KeyTable table;
  Key key;
  ValueType type = ValueType::boolean;
  Range range{};                     ///< of numbers, and of each number of a list or vector
  bool increasing = false;           ///< of a list
  std::vector<KnownWord> words;      ///< of ValueType::word
  std::optional<NameIn> names;       ///< of ValueType::text and names: where they are looked up
  std::optional<std::string> value;  ///< as TOML and JSON; absent where the key was not given and has no default of its own

  std::string dotted() const { return (table.name.empty() ? "" : std::string(table.name) + '.') + std::string(key.name); }
};

/// The rows of the options of an analysis, those of the tables that a file has once, with their defaults.
const std::vector<KeyEntry>& option_keys();

/// The rows of what a scene is made of, without values: materials, joints, blocks, forces, base motion, domain. The table of keys that stand at the
/// top of the file has no name.
const std::vector<KeyEntry>& element_keys();

/// The rows of the options with the values of the scene, in the order of the tables.
std::vector<KeyEntry> key_entries(const Scene& scene);

/// The rows of [[joint]], but for its materials, with the values of the joint.
std::vector<KeyEntry> joint_entries(const JointProperties& joint);

/// The rows of every force of the scene, in the order of ForceInputs, with its values.
std::vector<std::vector<KeyEntry>> force_entries(const Scene& scene);

/// The rows of the tables of forces, with their defaults.
std::vector<KeyEntry> force_keys();

/// The unit at the end of a key's name as one writes it: "dt_s" -> "s", "penalty_pa_per_m" -> "Pa/m"; empty for a number without one.
std::string unit_of(std::string_view key);

/// The dotted keys of all tables that have this name.
std::vector<std::string> tables_with(const std::string& name);

/// The dotted key most like this one, if it is hardly more than misspelt.
std::optional<std::string> similar_key(const std::string& dotted);

}  // namespace openclose
