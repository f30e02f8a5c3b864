// Typed reading of a TOML table that knows where it stands, so that every error names file, line and key.
//
//   Table table = root.table("step");
//   table.optional("dt_s", step.dt, positive);
//   table.finish();
//
// A key is accepted because somebody asks for it, so a new key is one more line at the place that reads it. What the values mean is looked at
// after finish(), which complains first of keys that nobody asked for (a misspelt key is the reason why the right one is missing) and then of the
// required ones that are missing.
#pragma once

#include <toml++/toml.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/core/vector.h"
#include "openclose/scene/limits.h"
#include "openclose/scene/nearest.h"

namespace openclose {

/// The text, or both of its ends if it is longer than anything that people write.
std::string shortened(std::string_view text);

/// A text of the user in quotes, shortened and its control characters escaped, so that a message stays one line.
std::string in_quotes(std::string_view text);

/// An InputError whose key comes from the file: it may be long.
[[noreturn]] void throw_input_error(const SourceLocation& where, const std::string& key, const std::string& read, const std::string& accepted);

/// Where a node stands. Nodes that came with an override carry its text in place of the file and no line.
SourceLocation location(const toml::node& node, const std::string& file);

/// "line 12", or, for a place without a line, the name of the file or override.
std::string place_name(const SourceLocation& where);

/// One value of the document and its dotted key, e.g. "joint[2].friction_angle_deg".
class Value {
 public:
  Value(const toml::node& node, std::string key, const std::string& file) : node_(&node), key_(std::move(key)), file_(&file) {}

  const toml::node& node() const { return *node_; }
  const std::string& key() const { return key_; }
  SourceLocation where() const { return location(*node_, *file_); }
  Value element(std::size_t i) const;

  [[noreturn]] void fail(const std::string& read, const std::string& accepted) const { throw_input_error(where(), key_, read, accepted); }
  /// For a value of another type: says what it is.
  [[noreturn]] void fail_type(const std::string& accepted) const;
  [[noreturn]] void fail_type_of_list() const;

 private:
  const toml::node* node_;
  std::string key_;
  const std::string* file_;
};

/// Whether a name can stand in the columns of the result files.
bool can_be_written(const std::string& name);

/// Unique, non-empty names of one kind of thing, in the order of the file.
class NameList {
 public:
  /// \param noun  what is named, e.g. "block"
  explicit NameList(std::string noun) : noun_(std::move(noun)) {}

  void add(const Value& value, const std::string& name);
  /// Something that has no name takes its place in the numbering.
  void add_nameless() { names_.emplace_back(); }
  int index(const Value& value, const std::string& name) const;

 private:
  std::string noun_;
  std::vector<std::string> names_;
  std::map<std::string, std::pair<int, SourceLocation>> places_;
};

/// Conversions of a value; each throws an InputError for another type and for a value outside the limits.
void read(const Value& value, double& number, const Range& range = any_number);
void read(const Value& value, int& number, const Range& range);
void read(const Value& value, bool& flag);
void read(const Value& value, std::string& text);
void read(const Value& value, Vec2& vector, const Range& range = any_number);  ///< the range is that of each component
void read(const Value& value, int& index, const NameList& names);

template <typename T, typename... Limits>
void read(const Value& value, std::optional<T>& target, const Limits&... limits) {
  read(value, target.emplace(), limits...);
}

template <typename T, typename... Limits>
void read(const Value& value, std::vector<T>& list, const Limits&... limits) {
  if (!value.node().is_array()) value.fail_type_of_list();
  list.resize(value.node().as_array()->size());
  for (std::size_t i = 0; i < list.size(); ++i) read(value.element(i), list[i], limits...);
}

/// One of the words of names.h.
template <typename Enum, std::size_t n>
void read(const Value& value, Enum& target, const std::array<Word<Enum>, n>& words) {
  std::string text;
  read(value, text);
  std::vector<std::string> accepted;
  for (const auto& word : words) {
    if (word.text == text) {
      target = word.value;
      return;
    }
    accepted.push_back(in_quotes(word.text));
  }
  value.fail(in_quotes(text) + " is not known", suggestions(in_quotes(text), accepted));
}

class Table {
 public:
  /// \param node  null for a table that the file does not have
  /// \param key   dotted key of the table; empty for the whole file
  Table(const toml::table* node, std::string key, const std::string& file) : node_(node), key_(std::move(key)), file_(&file) {}

  SourceLocation where() const;
  [[noreturn]] void fail(const std::string& read, const std::string& accepted) const { throw_input_error(where(), key_, read, accepted); }

  /// Reads the key into the target; its absence is reported by finish().
  template <typename T, typename... Limits>
  void required(const std::string& key, T& target, const Limits&... limits) {
    if (!optional(key, target, limits...)) miss(key);
  }

  /// Reads the key into the target if it is there, and says whether it was.
  template <typename T, typename... Limits>
  bool optional(const std::string& key, T& target, const Limits&... limits) {
    accepted_.push_back(key);
    const std::optional<Value> value = find(key);
    if (value) read(*value, target, limits...);
    return value.has_value();
  }

  /// A key that is required and was not there; finish() reports it.
  void miss(const std::string& key) { missing_.push_back(key); }

  /// A table within this one, written [key]; one without keys if it is absent.
  Table table(const std::string& key);
  /// An array of tables, written [[key]]; empty if it is absent.
  std::vector<Table> tables(const std::string& key);

  /// To be called when everything has been asked for.
  void finish() const;

  /// Whether the file has this table, with or without keys.
  bool is_there() const { return node_ != nullptr; }
  bool has(const std::string& key) const { return find(key).has_value(); }

  /// A value that is known to be there, for errors about its meaning.
  Value at(const std::string& key) const { return find(key).value(); }

 private:
  std::optional<Value> find(const std::string& key) const;
  std::string dotted(const std::string& key) const { return key_.empty() ? key : key_ + "." + key; }
  [[noreturn]] void refuse(const toml::node& node, const std::string& key) const;

  const toml::table* node_;
  std::string key_;
  const std::string* file_;
  std::vector<std::string> accepted_;
  std::vector<std::string> missing_;
};

}  // namespace openclose
