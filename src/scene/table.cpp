#include "openclose/scene/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "openclose/core/one_line.h"
#include "openclose/scene/keys.h"

namespace openclose {
namespace {

/// [bytes] Of a key or a text in a message; longer ones, which only a machine writes, are cut in their middle.
constexpr std::size_t longest_quoted = 240;

bool continues_letter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;  // of UTF-8
}

/// "block[2].fixed" -> "block.fixed"
std::string without_indices(const std::string& key) {
  std::string name;
  bool inside = false;
  for (const char character : key) {
    if (character == '[') inside = true;
    if (!inside) name += character;
    if (character == ']') inside = false;
  }
  return name;
}

/// What a value of the wrong type is, in the user's terms.
std::string description(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return in_quotes(node.as_string()->get()) + " is a string";
    case toml::node_type::integer:
      return fmt::format("{} is a number", node.as_integer()->get());
    case toml::node_type::floating_point:
      return fmt::format("{} is a number", node.as_floating_point()->get());
    case toml::node_type::boolean:
      return fmt::format("{} is a boolean", node.as_boolean()->get());
    case toml::node_type::array:
      return fmt::format("is an array of {} values", node.as_array()->size());
    case toml::node_type::table:
      return "is a table";
    default:
      return "is a date or a time";
  }
}

}  // namespace

std::string shortened(std::string_view text) {
  if (text.size() <= longest_quoted) return std::string(text);
  std::size_t first = longest_quoted / 2, last = text.size() - longest_quoted / 2;
  while (first > 0 && continues_letter(text[first])) --first;
  while (last < text.size() && continues_letter(text[last])) ++last;
  return fmt::format("{} [...] {}", text.substr(0, first), text.substr(last));
}

std::string in_quotes(std::string_view text) {
  return '"' + on_one_line(shortened(text)) + '"';
}

void throw_input_error(const SourceLocation& where, const std::string& key, const std::string& read, const std::string& accepted) {
  throw InputError(where, shortened(key), read, accepted);
}

SourceLocation location(const toml::node& node, const std::string& file) {
  const toml::source_region& source = node.source();
  if (!source.path) return {file, 0};
  return {*source.path, *source.path == file ? static_cast<int>(source.begin.line) : 0};
}

std::string place_name(const SourceLocation& where) {
  return where.line > 0 ? fmt::format("line {}", where.line) : where.file;
}

Value Value::element(std::size_t i) const {
  return {*node_->as_array()->get(i), fmt::format("{}[{}]", key_, i), *file_};
}

void Value::fail_type(const std::string& accepted) const {
  fail(description(*node_), accepted);
}

void Value::fail_type_of_list() const {
  const toml::value<std::string>* text = node_->as_string();
  fail_type(text == nullptr ? "an array" : fmt::format("a list, e.g. [{}]", in_quotes(text->get())));
}

bool can_be_written(const std::string& name) {
  return std::none_of(name.begin(), name.end(), [](char character) { return is_control(character) || character == ',' || character == '"'; });
}

void NameList::add(const Value& value, const std::string& name) {
  const std::string accepted = "a name of its own for every " + noun_ + ", not empty, without commas, quotes and control characters";
  if (name.empty()) value.fail("the name is empty", accepted);
  if (!can_be_written(name)) value.fail(in_quotes(name) + " cannot be written to a table of results", accepted);
  const auto [place, is_new] = places_.try_emplace(name, static_cast<int>(names_.size()), value.where());
  if (!is_new) value.fail(fmt::format("{} is already the name of the {} of {}", in_quotes(name), noun_, place_name(place->second.second)), accepted);
  names_.push_back(name);
}

int NameList::index(const Value& value, const std::string& name) const {
  const auto place = places_.find(name);
  if (place != places_.end()) return place->second.first;
  std::vector<std::string> accepted;
  for (const std::string& known : names_) {
    if (!known.empty()) accepted.push_back(in_quotes(known));
  }
  if (accepted.empty()) accepted.push_back(fmt::format("none, since no {} has a name", noun_));
  value.fail(fmt::format("there is no {} {}{}", noun_, in_quotes(name), did_you_mean(in_quotes(name), accepted)),
             suggestions(in_quotes(name), accepted));
}

void read(const Value& value, double& number, const Range& range) {
  const std::optional<double> read_number = value.node().is_number() ? value.node().value<double>() : std::nullopt;
  const std::string accepted = range.describe("number");
  if (!read_number) value.fail_type(accepted);
  if (!std::isfinite(*read_number)) value.fail(fmt::format("{} is not a finite number", *read_number), accepted);
  if (!range.contains(*read_number)) value.fail(fmt::format("{} is out of range", *read_number), accepted);
  number = *read_number;
}

void read(const Value& value, int& number, const Range& range) {
  double real = 0.0;
  if (!value.node().is_number()) value.fail_type(range.describe("whole number"));
  read(value, real);
  if (real != std::floor(real)) value.fail(fmt::format("{} is not a whole number", real), range.describe("whole number"));
  if (!range.contains(real)) value.fail(fmt::format("{} is out of range", real), range.describe("whole number"));
  number = static_cast<int>(real);
}

void read(const Value& value, bool& flag) {
  if (!value.node().is_boolean()) value.fail_type("true or false");
  flag = value.node().as_boolean()->get();
}

void read(const Value& value, std::string& text) {
  if (!value.node().is_string()) value.fail_type("a text in quotes");
  text = value.node().as_string()->get();
}

void read(const Value& value, Vec2& vector, const Range& range) {
  const toml::array* array = value.node().as_array();
  if (array == nullptr || array->size() != 2) value.fail_type("[x, y], each " + range.describe("number"));
  read(value.element(0), vector.x(), range);
  read(value.element(1), vector.y(), range);
}

void read(const Value& value, int& index, const NameList& names) {
  std::string name;
  read(value, name);
  index = names.index(value, name);
}

SourceLocation Table::where() const {
  return node_ == nullptr || key_.empty() ? SourceLocation{*file_, 0} : location(*node_, *file_);
}

std::optional<Value> Table::find(const std::string& key) const {
  const toml::node* node = node_ == nullptr ? nullptr : node_->get(key);
  if (node == nullptr) return std::nullopt;
  return Value(*node, dotted(key), *file_);
}

Table Table::table(const std::string& key) {
  accepted_.push_back(key);
  const std::optional<Value> value = find(key);
  if (!value) return {nullptr, dotted(key), *file_};
  if (!value->node().is_table()) value->fail_type(fmt::format("a table, written [{}]", dotted(key)));
  return {value->node().as_table(), value->key(), *file_};
}

std::vector<Table> Table::tables(const std::string& key) {
  accepted_.push_back(key);
  std::vector<Table> list;
  const std::optional<Value> value = find(key);
  if (!value) return list;
  const std::string accepted = fmt::format("an array of tables, each written [[{}]]", dotted(key));
  if (!value->node().is_array()) value->fail_type(accepted);
  for (std::size_t i = 0; i < value->node().as_array()->size(); ++i) {
    const Value element = value->element(i);
    if (!element.node().is_table()) element.fail_type(accepted);
    list.emplace_back(element.node().as_table(), element.key(), *file_);
  }
  return list;
}

void Table::refuse(const toml::node& node, const std::string& key) const {
  std::vector<std::string> elsewhere = tables_with(key);
  std::erase(elsewhere, without_indices(dotted(key)));
  if (!elsewhere.empty()) {
    std::string accepted = fmt::format("{}", fmt::join(elsewhere, ", "));
    const std::string joint = "joint";
    const bool names_joint =
        std::ranges::find(accepted_, joint) != accepted_.end() && std::ranges::find(elsewhere, joint + "." + key) != elsewhere.end();
    if (names_joint) accepted += fmt::format(", of a [[joint]] with a name, and {} with that name", without_indices(dotted(joint)));
    throw_input_error(location(node, *file_), dotted(key), "this key belongs in another table", accepted);
  }
  const std::vector<std::string> other_units = same_quantity(key, accepted_);
  if (!other_units.empty()) {
    throw_input_error(location(node, *file_), dotted(key), "this key has another unit", fmt::format("{}", fmt::join(other_units, ", ")));
  }
  std::optional<std::string> meant = similar(key, accepted_);
  if (!meant) meant = similar_key(dotted(key));
  throw_input_error(location(node, *file_), dotted(key),
                    meant ? fmt::format("this key is not known, did you mean {}?", *meant) : "this key is not known", suggestions(key, accepted_));
}

void Table::finish() const {
  if (node_ != nullptr) {
    for (const auto& [key, node] : *node_) {
      if (std::find(accepted_.begin(), accepted_.end(), key.str()) == accepted_.end()) refuse(node, std::string(key.str()));
    }
  }
  if (!missing_.empty())
    throw_input_error(where(), dotted(missing_.front()), "this key is missing", fmt::format("a table with {}", fmt::join(missing_, ", ")));
}

}  // namespace openclose
