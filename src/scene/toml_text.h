// Values as TOML writes them: numbers are the shortest decimals that read back exactly. They are JSON, too.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "openclose/core/vector.h"

namespace openclose {

std::string toml(double number);
std::string toml(int number);
std::string toml(bool flag);
std::string toml(std::string_view text);
std::string toml(const Vec2& vector);

template <typename T>
std::string toml(const std::vector<T>& list) {
  std::string text = "[";
  for (const T& item : list) text += (text.size() > 1 ? ", " : "") + toml(item);
  return text + ']';
}

}  // namespace openclose
