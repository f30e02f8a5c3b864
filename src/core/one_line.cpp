#include "openclose/core/one_line.h"

#include <fmt/format.h>

namespace openclose {

bool is_control(char character) {
  return static_cast<unsigned char>(character) < 0x20 || character == 0x7f;
}

std::string on_one_line(std::string_view text) {
  std::string line;
  for (const char character : text) {
    if (is_control(character)) {
      line += fmt::format("\\x{:02x}", static_cast<unsigned char>(character));
    } else {
      line += character;
    }
  }
  return line;
}

}  // namespace openclose
