#include "openclose/scene/keys.h"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "openclose/scene/angle.h"
#include "openclose/scene/nearest.h"
#include "openclose/scene/toml_text.h"

namespace openclose {
namespace {

/// What a member holds, as text; nothing for a number outside its own range, which stands for "not given".
std::optional<std::string> text_of(bool value, const Flag&) {
  return toml(value);
}
std::optional<std::string> text_of(const std::string& value, const NameIn&) {
  return toml(std::string_view(value));
}
std::optional<std::string> text_of(const std::string& value, const OwnName&) {
  return value.empty() ? std::nullopt : std::optional(toml(std::string_view(value)));
}
std::optional<std::string> text_of(const std::string& value, const LoadName&) {
  return toml(std::string_view(value));
}
template <typename Number>
requires std::is_arithmetic_v<Number> std::optional<std::string> text_of(Number value, const Range& range) {
  return range.contains(value) ? std::optional(toml(value)) : std::nullopt;
}
std::optional<std::string> text_of(const std::vector<std::string>& value, const NameIn&) {
  return toml(value);
}
std::optional<std::string> text_of(double value, const Degrees& angle) {
  return text_of(degrees(value), angle.range);
}
template <typename Accepted>
std::optional<std::string> text_of(const std::vector<double>& value, const Accepted&) {
  return toml(value);
}
template <typename Enum, std::size_t n>
std::optional<std::string> text_of(const Enum& value, const std::array<Word<Enum>, n>& words) {
  return toml(word_for(words, value));
}
std::optional<std::string> text_of(const Vec2& value, const Range&) {
  return toml(value);
}
template <typename T, typename Accepted>
std::optional<std::string> text_of(const std::optional<T>& value, const Accepted& accepted) {
  return value ? text_of(*value, accepted) : std::nullopt;
}

ValueType number_type(const int&) {
  return ValueType::whole_number;
}
ValueType number_type(const Vec2&) {
  return ValueType::vector;
}
template <typename T>
ValueType number_type(const T&) {
  return ValueType::number;
}

class Collector {
 public:
  /// \param blocks  for the names of blocks; without them, those have no value
  explicit Collector(const std::vector<BlockInput>* blocks = nullptr) : blocks_(blocks) {}
  void table(const KeyTable& table) { table_ = table; }

  template <typename T, typename Accepted>
  void operator()(const Key& key, const T& member, const Accepted& accepted, const SourceLocation* = nullptr) {
    KeyEntry entry;
    entry.table = table_;
    entry.key = key;
    describe(entry, member, accepted);
    entry.value = text_of(member, accepted);
    entries.push_back(std::move(entry));
  }

  void operator()(const Key& key, const int& block, const BlockName&) {
    KeyEntry entry;
    entry.table = table_;
    entry.key = key;
    entry.type = ValueType::text;
    if (blocks_ != nullptr) entry.value = toml(std::string_view((*blocks_)[block].name));
    entries.push_back(std::move(entry));
  }

  std::vector<KeyEntry> entries;

 private:
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const Flag&) {
    entry.type = ValueType::boolean;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T& member, const Range& range) {
    entry.type = number_type(member);
    entry.range = range;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const Increasing& list) {
    entry.type = ValueType::list;
    entry.range = list.each;
    entry.increasing = true;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const ListOf& list) {
    entry.type = ValueType::list;
    entry.range = list.each;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const Degrees& angle) {
    entry.type = ValueType::number;
    entry.range = angle.range;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const OwnName&) {
    entry.type = ValueType::text;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const LoadName&) {
    entry.type = ValueType::text;
  }
  template <typename T>
  static void describe(KeyEntry& entry, const T&, const NameIn& names) {
    entry.type = std::is_same_v<T, std::vector<std::string>> ? ValueType::names : ValueType::text;
    entry.names = names;
  }
  template <typename T, typename Enum, std::size_t n>
  static void describe(KeyEntry& entry, const T&, const std::array<Word<Enum>, n>& words) {
    entry.type = ValueType::word;
    for (const auto& word : words) entry.words.push_back({word.text, word.says});
  }

  const std::vector<BlockInput>* blocks_;
  KeyTable table_;
};

constexpr std::array<std::pair<std::string_view, std::string_view>, 4> spelt_units{{{"pa", "Pa"}, {"n", "N"}, {"hz", "Hz"}, {"j", "J"}}};

}  // namespace

std::vector<KeyEntry> key_entries(const Scene& scene) {
  Collector collector;
  visit_keys(scene, collector);
  return std::move(collector.entries);
}

std::vector<KeyEntry> joint_entries(const JointProperties& joint) {
  Collector collector;
  collector.table({"joint", Audience::user, "One for every pair of materials that can touch", true});
  visit_joint_keys(joint, collector);
  return std::move(collector.entries);
}

std::vector<std::vector<KeyEntry>> force_entries(const Scene& scene) {
  std::vector<std::vector<KeyEntry>> list;
  for_each_force(scene, [&](const auto& force) {
    Collector collector(&scene.blocks);
    collector.table(force.table());
    force.visit_keys(force, collector);
    list.push_back(std::move(collector.entries));
  });
  return list;
}

std::vector<KeyEntry> force_keys() {
  Collector collector;
  ForceInputs::visit(static_cast<const ForceInputs&>(ForceInputs()), [&](const auto& list) {
    const typename std::decay_t<decltype(list)>::value_type untouched;
    collector.table(untouched.table());
    untouched.visit_keys(untouched, collector);
  });
  // What a file must give has no default.
  for (KeyEntry& entry : collector.entries) {
    if (entry.key.required) entry.value.reset();
  }
  return std::move(collector.entries);
}

const std::vector<KeyEntry>& option_keys() {
  static const Scene untouched;
  static const std::vector<KeyEntry> entries = key_entries(untouched);
  return entries;
}

std::string unit_of(std::string_view key) {
  const std::size_t quantity = without_unit(std::string(key)).size();
  if (quantity == key.size()) return {};
  std::string unit;
  bool over = false;
  for (std::string_view rest = key.substr(quantity + 1); !rest.empty();) {
    std::string_view word = rest.substr(0, rest.find('_'));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    if (word == "per") {
      over = true;
      continue;
    }
    for (const auto& [written, spelt] : spelt_units) {
      if (word == written) word = spelt;
    }
    if (!unit.empty()) unit += over ? "/" : " ";
    unit += word;
    over = false;
  }
  return unit;
}

std::vector<std::string> tables_with(const std::string& name) {
  std::vector<std::string> found;
  for (const auto& rows : {option_keys(), element_keys()}) {
    for (const KeyEntry& entry : rows) {
      if (entry.key.name == name) found.push_back(entry.dotted());
    }
  }
  return found;
}

std::optional<std::string> similar_key(const std::string& dotted) {
  std::vector<std::string> keys;
  for (const KeyEntry& entry : option_keys()) keys.push_back(entry.dotted());
  return similar(dotted, keys);
}

}  // namespace openclose
