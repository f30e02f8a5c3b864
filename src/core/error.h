// The ways a run can end badly: the input is wrong (exit code 2, nothing written), the analysis does not converge (exit code 1, state and reason
// saved), or a result cannot be written (exit code 3, what has been written stays). Anything else that is thrown is a fault of the program (exit code
// 3).
#pragma once

#include <stdexcept>
#include <string>

namespace openclose {

inline constexpr int exit_success = 0;
inline constexpr int exit_not_converged = 1;
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_broken_off = 3;

/// Where in a scene file a value stands; line 0 means that the file as a whole is meant.
struct SourceLocation {
  std::string file;
  int line = 0;
};

/// Bad input. what() is one line: "file:line: key: what is wrong; what is accepted".
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  /// \param key       dotted key as the user wrote it, e.g. "joint[2].friction_angle_deg"; may be empty
  /// \param read      what was read, with the verdict, e.g. "-3 is negative"
  /// \param accepted  what would be right, e.g. "a number of degrees in [0, 90)"
  InputError(const SourceLocation& where, const std::string& key, const std::string& read, const std::string& accepted);
};

/// A file that could be made is not written to its end. what() is one line that begins with its path.
class WriteError : public std::runtime_error {
 public:
  explicit WriteError(const std::string& path,
                      const std::string& what = "cannot be written to its end: is the disk full, or a limit on the size of files reached?")
      : std::runtime_error(path + ": " + what) {}
};

/// Thrown out of a long computation whose observer has been asked to stop; who knows something by then catches it.
class Stopped : public std::runtime_error {
 public:
  explicit Stopped(const std::string& what = "stopped before there was a state to go on from") : std::runtime_error(what) {}
};

}  // namespace openclose
