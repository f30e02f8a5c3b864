#include "messages.h"

#include <cstdio>
#include <filesystem>

#include "openclose/core/error.h"

namespace openclose {

void print_message(const std::string& text) {
  std::fputs(("openclose: " + text + "\n").c_str(), stderr);
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) print_message("warning: " + warning);
}

void require_ending(const std::string& file, const std::string& ending, const std::string& noun) {
  if (std::filesystem::path(file).extension() != ending)
    throw InputError({file, 0}, "-o", "this is not the name of a " + noun, "a name that ends in " + ending);
}

bool has_lost_output() {
  return std::ferror(stdout) != 0;
}

int status_after_output(int status) {
  if (std::fflush(stdout) == 0 && !has_lost_output()) return status;
  print_message("standard output: cannot be written to its end: is the disk full?");
  return status == exit_success ? exit_broken_off : status;
}

}  // namespace openclose
