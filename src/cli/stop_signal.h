// SIGINT (Ctrl-C) and SIGTERM ask a command to end where it can be gone on from; the second one ends it at once, as if nobody watched.
#pragma once

namespace openclose {

void watch_for_stop_signals();

/// The signal that has come; 0: none.
int stop_signal();

/// Throws Stopped if a signal has come.
void throw_if_stopped();

/// As shells have it for a command that a signal has ended.
int exit_status_of_stop();

}  // namespace openclose
