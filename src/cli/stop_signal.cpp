#include "stop_signal.h"

#include <unistd.h>

#include <csignal>

#include "openclose/core/error.h"

namespace openclose {
namespace {

volatile std::sig_atomic_t received = 0;

bool is_watched = false;  ///< by somebody at a terminal

extern "C" void note_signal(int signal) {
  received = signal;
  constexpr char text[] = "\nopenclose: stopping; a second Ctrl-C ends at once\n";
  if (is_watched && write(STDERR_FILENO, text, sizeof text - 1) < 0) return;
}

}  // namespace

void watch_for_stop_signals() {
  is_watched = isatty(STDERR_FILENO) == 1;
  struct sigaction action = {};
  action.sa_handler = note_signal;
  // The second signal finds the system's own handler, and what waits for the disk goes on.
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

int stop_signal() {
  return received;
}

void throw_if_stopped() {
  if (received != 0) throw Stopped();
}

int exit_status_of_stop() {
  return 128 + received;
}

}  // namespace openclose
