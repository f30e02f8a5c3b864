#include "openclose/core/error.h"
#include "support/catch.h"

using namespace openclose;

namespace {

std::string text(const SourceLocation& where, const std::string& key, const std::string& read, const std::string& accepted) {
  return InputError(where, key, read, accepted).what();
}

}  // namespace

TEST_CASE("bad input is told in one line: file, line, key, what was read, what is accepted", "[core][error]") {
  CHECK(text({"scene.toml", 12}, "joint[2].friction_angle_deg", "-3 is negative", "a number of degrees in [0, 90)") ==
        "scene.toml:12: joint[2].friction_angle_deg: -3 is negative; accepted: a number of degrees in [0, 90)");
}

TEST_CASE("what is not known is left out of the message", "[core][error]") {
  CHECK(text({"scene.toml", 0}, "joint", "none", "one for every pair") == "scene.toml: joint: none; accepted: one for every pair");
  CHECK(text({"scene.toml", 3}, "", "not TOML", "TOML") == "scene.toml:3: not TOML; accepted: TOML");
  CHECK(text({"scene.toml", 0}, "", "no such file", "") == "scene.toml: no such file");
  CHECK(std::string(InputError("plain").what()) == "plain");
}

TEST_CASE("a file that is not written to its end is told by its path", "[core][error]") {
  CHECK(std::string(WriteError("out/history.csv").what()).rfind("out/history.csv: cannot be written to its end: ", 0) == 0);
  CHECK(std::string(WriteError("out/history.csv", "is gone").what()) == "out/history.csv: is gone");
}

TEST_CASE("success, no convergence, bad input and what was broken off are told apart by the exit code", "[core][error]") {
  CHECK(exit_success == 0);
  CHECK(exit_not_converged == 1);
  CHECK(exit_bad_input == 2);
  CHECK(exit_broken_off == 3);
}
