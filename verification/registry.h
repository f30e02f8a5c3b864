// How cases and studies make themselves known: each registers itself from its own source, and no list names them.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace openclose::verification {

/// Whether identifier `a` stands before `b`: runs of digits count as numbers, so that "D2" < "D10"; everything else goes by its characters.
bool in_natural_order(const std::string& a, const std::string& b);

/// Throws std::logic_error that two entries have one identifier.
[[noreturn]] void refuse_duplicate(const std::string& name, const std::string& title, const std::string& other_title);

/// The entries by identifier in natural order, in whatever order they came; throws std::logic_error if two of them share an identifier.
template <class Entry>
std::vector<Entry> sorted_by_name(std::vector<Entry> entries) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return in_natural_order(a.name, b.name); });
  for (std::size_t i = 1; i < entries.size(); ++i) {
    const Entry &a = entries[i - 1], &b = entries[i];
    if (std::string(a.name) == b.name) refuse_duplicate(a.name, a.title, b.title);
  }
  return entries;
}

/// An object of this class, defined once at namespace scope, registers a case or a study before main() begins:
///
///     const Registered<Case> registered{{"A1", "projectile", &projectile}};
///
/// Only sources that belong to the program itself register: a linker leaves out objects of a static library that nothing refers to.
template <class Entry>
class Registered {
 public:
  explicit Registered(const Entry& entry) { entries().push_back(entry); }
  /// All of them, sorted.
  static std::vector<Entry> all() { return sorted_by_name(entries()); }

 private:
  /// Within a function, so that it exists before the first object that registers.
  static std::vector<Entry>& entries() {
    static std::vector<Entry> list;
    return list;
  }
};

}  // namespace openclose::verification
