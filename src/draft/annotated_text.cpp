#include "openclose/draft/annotated_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "openclose/scene/keys.h"

namespace openclose {
namespace {

/// Columns: where comments behind a value begin, and where lines with comments end.
constexpr std::size_t comment_column = 44, last_column = 110;

const KeyEntry& entry_of(const std::string& table, const std::string& name) {
  for (const auto* entries : {&option_keys(), &element_keys()}) {
    const auto entry =
        std::ranges::find_if(*entries, [&](const KeyEntry& e) { return e.table.name == table && (name.empty() || e.key.name == name); });
    if (entry != entries->end()) return *entry;
  }
  throw std::logic_error("a draft writes a key that there is not: " + table + "." + name);
}

/// Links of the reference page as paths: "[scenes](scene.md)" is docs/scene.md here.
std::string without_links(std::string_view says) {
  static const std::regex link(R"(\[[^\]]*\]\(([^)]*)\))");
  return std::regex_replace(std::string(says), link, "docs/$1");
}

std::string wrapped(const std::string& words) {
  std::istringstream stream(words);
  std::string text, line = "#";
  for (std::string word; stream >> word;) {
    if (line.size() + 1 + word.size() > last_column) {
      text += line + '\n';
      line.assign(1, '#');
    }
    line += ' ' + word;
  }
  return text + line + '\n';
}

}  // namespace

void AnnotatedText::comment(const std::string& words) {
  text_ += wrapped(words);
}

void AnnotatedText::table(const std::string& name, const std::string& words) {
  table_ = name;
  const KeyTable& table = entry_of(name, "").table;
  blank_line();
  const bool is_new = explained_.insert(name).second;
  std::string says = is_new ? without_links(table.says) : "";
  if (!words.empty()) says += (says.empty() ? "" : ". ") + words;
  if (!says.empty()) comment(says);
  text_ += table.many ? fmt::format("[[{}]]\n", name) : fmt::format("[{}]\n", name);
}

void AnnotatedText::left_out_table(const std::string& name) {
  table_ = name;
  text_ += entry_of(name, "").table.many ? fmt::format("# [[{}]]\n", name) : fmt::format("# [{}]\n", name);
}

void AnnotatedText::line(const std::string& name, const std::string& value, bool is_left_out) {
  const KeyEntry& entry = entry_of(table_, name);
  std::string line = fmt::format("{}{} = {}", is_left_out ? "# " : "", name, value);
  if (!explained_.insert(table_ + '.' + name).second) {
    text_ += line + '\n';
    return;
  }
  const std::string unit = unit_of(name);
  const std::string says = (unit.empty() ? "" : '[' + unit + "] ") + without_links(entry.key.says);
  if (std::max(line.size() + 1, comment_column) + 2 + says.size() <= last_column) {
    line.resize(std::max(line.size() + 1, comment_column), ' ');
    text_ += line + "# " + says + '\n';
  } else {
    text_ += wrapped(name + ": " + says) + line + '\n';
  }
}

std::string AnnotatedText::written(double number) {
  const std::string all_digits = toml(number);
  const std::string few = std::regex_replace(fmt::format("{:g}", number), std::regex(R"(e\+0*)"), "e");
  return few.size() < all_digits.size() && std::stod(few) == number ? few : all_digits;
}

Polygon AnnotatedText::rounded(Polygon points) {
  constexpr double nanometres = 1e9;
  // Adding zero takes the sign of a negative one away.
  for (Vec2& point : points) point = (point * nanometres).array().round().matrix() / nanometres + Vec2(0.0, 0.0);
  return points;
}

}  // namespace openclose
