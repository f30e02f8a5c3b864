#include "openclose/core/error.h"

#include <fmt/format.h>

#include "openclose/core/one_line.h"

namespace openclose {
namespace {

std::string compose(const SourceLocation& where, const std::string& key, const std::string& read, const std::string& accepted) {
  std::string text = where.line > 0 ? fmt::format("{}:{}: ", where.file, where.line) : fmt::format("{}: ", where.file);
  if (!key.empty()) text += key + ": ";
  text += read;
  if (!accepted.empty()) text += "; accepted: " + accepted;
  return on_one_line(text);
}

}  // namespace

InputError::InputError(const SourceLocation& where, const std::string& key, const std::string& read, const std::string& accepted)
    : InputError(compose(where, key, read, accepted)) {}

}  // namespace openclose
