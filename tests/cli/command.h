// Runs the built command in a folder of its own.
#pragma once

#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "io/files.h"
#include "scene/scene_file.h"

namespace openclose::test {

struct CommandResult {
  int status = -1;  ///< exit code; -1 if the command crashed
  std::string out;
  std::vector<std::string> errors;  ///< lines of standard error
};

/// A folder with a scene file "scene.toml" (unless the text is empty), in which the command is run.
class Workplace {
 public:
  explicit Workplace(const std::string& scene = block_on_base) {
    if (!scene.empty()) folder_.write("scene.toml", scene);
  }

  /// \param before  what the shell does first, to be followed by the command
  CommandResult run(const std::string& arguments, const std::string& before = "") const {
    const std::string line =
        "cd '" + folder_.path() + "' && " + before + "'" OPENCLOSE_COMMAND "' " + arguments + " >'" + log_ / "out" + "' 2>'" + log_ / "err" + "'";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(log_ / "out"), lines_of(log_ / "err")};
  }

  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
  TemporaryFolder log_;
};

/// What a shell does to have the disk full under a file of this path, see full_disk.cpp; a sanitizer that comes second to it is content.
inline std::string full_under(const std::string& file) {
  return "FULL_DISK='" + file + "' LD_PRELOAD='" FULL_DISK_LIBRARY "' ASAN_OPTIONS=verify_asan_link_order=0 ";
}

/// The small scene on an incline that falls to the right: its block 2 m long, its base 20 m.
inline std::string block_on_incline(double slope_deg) {
  const double slope = slope_deg * std::numbers::pi / 180.0;
  const auto box = [&](double x0, double y0, double x1, double y1) {
    std::ostringstream text;
    text.precision(17);
    const auto corner = [&](double x, double y, const char* after) {
      text << '[' << x * std::cos(slope) + y * std::sin(slope) << ", " << y * std::cos(slope) - x * std::sin(slope) << ']' << after;
    };
    text << "vertices_m = [";
    corner(x0, y0, ", ");
    corner(x1, y0, ", ");
    corner(x1, y1, ", ");
    corner(x0, y1, "]");
    return text.str();
  };
  return with_line(with_line(block_on_base, 14, box(-10.0, -1.0, 10.0, 0.0)), 20, box(0.0, 0.0, 2.0, 1.0));
}

}  // namespace openclose::test
