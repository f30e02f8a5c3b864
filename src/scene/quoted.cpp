#include "openclose/scene/quoted.h"

#include <fmt/format.h>

namespace openclose {
namespace {

/// [bytes] Of a key or a text in a message; longer ones, which only a machine writes, are cut in their middle.
constexpr std::size_t longest_quoted = 240;

bool continues_letter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;  // of UTF-8
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
  return '"' + escaped(shortened(text)) + '"';
}

}  // namespace openclose
