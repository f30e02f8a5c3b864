// What the harness of checkpoints forges: its input is the number of a saved state, and then edits of six bytes, two for the place and four to be
// written there.
#pragma once

#include <cstddef>

int count_of_saved_states();
std::size_t bytes_of_saved_state(int number);
