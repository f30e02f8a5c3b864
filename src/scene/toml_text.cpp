#include "openclose/scene/toml_text.h"

#include <fmt/format.h>

#include <cmath>

namespace openclose {

std::string toml(double number) {
  // TOML knows no signed zero among its integers.
  return number == 0.0 && std::signbit(number) ? "-0.0" : fmt::format("{}", number);
}

std::string toml(int number) {
  return fmt::format("{}", number);
}

std::string toml(bool flag) {
  return flag ? "true" : "false";
}

std::string toml(std::string_view text) {
  std::string literal = "\"";
  for (const char character : text) {
    if (static_cast<unsigned char>(character) < 0x20 || character == 0x7f) {
      literal += fmt::format("\\u{:04X}", static_cast<unsigned char>(character));
    } else {
      if (character == '"' || character == '\\') literal += '\\';
      literal += character;
    }
  }
  return literal + '"';
}

std::string toml(const Vec2& vector) {
  return fmt::format("[{}, {}]", toml(vector.x()), toml(vector.y()));
}

}  // namespace openclose
