// What this process has used so far.
#pragma once

namespace openclose {

/// [s] CPU time since the process began; of the thread that asks, where there are several.
double process_cpu_time();
/// [bytes] Largest resident memory since the program was loaded; 0 where /proc does not tell.
long peak_memory();

}  // namespace openclose
