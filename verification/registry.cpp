#include "registry.h"

#include <fmt/format.h>

#include <cctype>
#include <stdexcept>

namespace openclose::verification {
namespace {

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// The number that begins at `i`, which moves behind it.
unsigned long number_at(const std::string& text, std::size_t& i) {
  unsigned long number = 0;
  for (; i < text.size() && is_digit(text[i]); ++i) number = 10 * number + static_cast<unsigned long>(text[i] - '0');
  return number;
}

}  // namespace

bool in_natural_order(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const unsigned long of_a = number_at(a, i), of_b = number_at(b, j);
      if (of_a != of_b) return of_a < of_b;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;  // the same but for leading zeros
}

void refuse_duplicate(const std::string& name, const std::string& title, const std::string& other_title) {
  throw std::logic_error(fmt::format("\"{}\" and \"{}\" both have the identifier {}", title, other_title, name));
}

}  // namespace openclose::verification
