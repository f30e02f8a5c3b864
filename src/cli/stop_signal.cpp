#include "stop_signal.h"

#include <unistd.h>

#include <csignal>

#include "openclose/core/error.h"

namespace openclose {
namespace {

volatile std::sig_atomic_t received = 0;

bool is_watched = false;  ///< by somebody at a terminal

constexpr int stop_signals[] = {SIGINT, SIGTERM};

/// What waits for the disk goes on after a signal.
void answer_with(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(SA_RESTART);
  for (const int signal : stop_signals) sigaction(signal, &action, nullptr);
}

extern "C" void note_signal(int signal) {
  received = signal;
  // The second signal, of either kind, finds the system's own handler.
  answer_with(SIG_DFL);
  constexpr char text[] = "\nopenclose: stopping; a second Ctrl-C ends at once\n";
  if (is_watched && write(STDERR_FILENO, text, sizeof text - 1) < 0) return;
}

}  // namespace

void watch_for_stop_signals() {
  is_watched = isatty(STDERR_FILENO) == 1;
  answer_with(note_signal);
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
