#include "openclose/draft/written_heading.h"

#include <fmt/format.h>

#include "openclose/core/check_sum.h"

namespace openclose {
namespace {

std::string heading_of(const std::string& text) {
  return fmt::format("# Written by openclose new {:016x}; as soon as it is edited, the command does not replace it any more.\n", check_sum(text));
}

}  // namespace

std::string with_heading(const std::string& text) {
  return heading_of(text) + text;
}

bool is_as_written(const std::string& file) {
  const std::size_t end = file.find('\n');
  if (end == std::string::npos) return false;
  const std::string text = file.substr(end + 1);
  return file.compare(0, end + 1, heading_of(text)) == 0;
}

}  // namespace openclose
