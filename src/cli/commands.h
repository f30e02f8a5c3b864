// The commands on a scene or on results; each returns the exit status.
#pragma once

#include "scene_command.h"

namespace openclose {

int run_command(const Options& options);
int fos_command(const Options& options);
int check_command(const Options& options);
int cut_command(const Options& options);
int draw_command(const Options& options);
int explain_command(const Options& options);

}  // namespace openclose
