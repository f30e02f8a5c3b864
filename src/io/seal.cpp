#include "openclose/io/seal.h"

#include <fmt/format.h>

#include "openclose/core/check_sum.h"

namespace openclose {
namespace {

struct Comment {
  std::string_view begin, end;
};

Comment comment_of(Seal seal) {
  return seal == Seal::xml ? Comment{"<!-- ", " -->"} : Comment{"# ", ""};
}

}  // namespace

std::string seal_of(std::string_view text, Seal seal) {
  if (seal == Seal::none) return {};
  const Comment comment = comment_of(seal);
  return fmt::format("{}Written by openclose {:016x}; once it is edited, openclose does not replace it any more.{}\n", comment.begin, check_sum(text),
                     comment.end);
}

bool is_sealed(std::string_view file, Seal seal) {
  const std::size_t begin = file.rfind(comment_of(seal).begin);
  return seal != Seal::none && begin != std::string_view::npos && file.substr(begin) == seal_of(file.substr(0, begin), seal);
}

}  // namespace openclose
