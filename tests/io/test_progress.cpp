#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "io/files.h"
#include "openclose/io/progress.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Standard error goes to another file descriptor as long as the object lives.
class Redirected {
 public:
  explicit Redirected(int to) : kept_(dup(STDERR_FILENO)) { dup2(to, STDERR_FILENO); }
  ~Redirected() {
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

 private:
  int kept_;
};

void work(std::chrono::milliseconds time, bool quiet) {
  Progress progress("work", quiet);
  progress.update(0.1);
  progress.note("a first note");
  std::this_thread::sleep_for(time);
  progress.update(0.5);
  progress.note("a last note");
}

constexpr std::chrono::milliseconds long_work{1100}, short_work{10};
constexpr int handed_over_after_ms = 300;

/// What appears on a terminal.
std::string on_terminal(std::chrono::milliseconds time, bool quiet) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  REQUIRE(master >= 0);
  REQUIRE(grantpt(master) == 0);
  REQUIRE(unlockpt(master) == 0);
  const int terminal = open(ptsname(master), O_RDWR | O_NOCTTY);
  REQUIRE(terminal >= 0);
  {
    const Redirected redirected(terminal);
    work(time, quiet);
  }
  // The system hands over what was written in its own time.
  std::string shown;
  char buffer[4096];
  pollfd wait{master, POLLIN, 0};
  while (poll(&wait, 1, handed_over_after_ms) > 0) {
    const ssize_t count = read(master, buffer, sizeof buffer);
    if (count <= 0) break;
    shown.append(buffer, static_cast<std::size_t>(count));
  }
  close(terminal);
  close(master);
  return shown;
}

/// A bare root may have no pseudo-terminals; there the two cases below have nothing to look at.
bool no_terminal_here() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0) {
    WARN("no pseudo-terminal on this machine: the progress bar is not looked at");
    return true;
  }
  close(master);
  return false;
}

}  // namespace

TEST_CASE("long work shows its progress on a terminal and wipes it at the end", "[io][progress]") {
  if (no_terminal_here()) return;
  const std::string shown = on_terminal(long_work, false);
  CHECK_THAT(shown, ContainsSubstring("work [" + std::string(20, '#') + std::string(20, '.') + "]  50 %"));
  CHECK_THAT(shown, !ContainsSubstring("10 %"));
  // Notes stay: the first one above the bar, the last one where the bar was. A terminal begins a line with \r\n.
  CHECK_THAT(shown, Catch::Matchers::StartsWith("\r\033[Ka first note\r\n") && Catch::Matchers::EndsWith("\r\033[Ka last note\r\n"));
}

TEST_CASE("short or quiet work shows nothing", "[io][progress]") {
  if (no_terminal_here()) return;
  CHECK(on_terminal(short_work, false).empty());
  CHECK(on_terminal(long_work, true).empty());
}

TEST_CASE("progress is silent where standard error is no terminal", "[io][progress]") {
  const test::TemporaryFolder place;
  const std::string path = place.write("stderr.txt", "");
  const int file = open(path.c_str(), O_WRONLY);
  REQUIRE(file >= 0);
  {
    const Redirected redirected(file);
    work(long_work, false);
  }
  close(file);
  CHECK(test::text_of(path).empty());
}
