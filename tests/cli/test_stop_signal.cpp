#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <utility>

#include "stop_signal.h"
#include "support/catch.h"

namespace {

/// What a process says of itself that asks to be told of signals and gets these.
int end_of_process_with(int first, int second) {
  const pid_t child = fork();
  if (child == 0) {
    openclose::watch_for_stop_signals();
    raise(first);
    if (openclose::stop_signal() == first) raise(second);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

}  // namespace

TEST_CASE("the second signal ends a command at once, of whichever kind both are", "[cli][stop_signal]") {
  for (const auto& [first, second] :
       {std::pair(SIGINT, SIGINT), std::pair(SIGTERM, SIGTERM), std::pair(SIGTERM, SIGINT), std::pair(SIGINT, SIGTERM)}) {
    const int status = end_of_process_with(first, second);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == second);
  }
}
