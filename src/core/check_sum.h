// Check sums against disks and half copies, not against people.
#pragma once

#include <cstdint>
#include <string_view>

namespace openclose {

inline constexpr std::uint64_t empty_check_sum = 14695981039346656037ull;

/// Fowler, Noll, Vo, 1a, 64 bits: the sum of what has been summed before, followed by these bytes.
constexpr std::uint64_t check_sum(std::string_view bytes, std::uint64_t before = empty_check_sum) {
  for (const char byte : bytes) before = (before ^ static_cast<unsigned char>(byte)) * 1099511628211ull;
  return before;
}

}  // namespace openclose
