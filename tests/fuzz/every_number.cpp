// Writes one wrong number to each place of each saved state in turn: as a whole number it lies beyond every list, as the upper half of a real one it
// is 2. Whoever reads it refuses it or goes on from it.
#include "harness.h"
#include "saved_states.h"

int main() {
  for (int number = 0; number < count_of_saved_states(); ++number) {
    const std::size_t bytes = bytes_of_saved_state(number);
    require_promise(number < 1 << 8 && bytes <= 1 << 16, "an edit can say which state and where");
    std::fprintf(stderr, "saved state %d, %zu bytes\n", number, bytes);  // the last one is the one that ended the program
    for (std::size_t at = 0; at < bytes; ++at) {
      const std::uint8_t edit[] = {
          static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(at), static_cast<std::uint8_t>(at >> 8), 0xff, 0xff, 0xff, 0x3f};
      LLVMFuzzerTestOneInput(edit, sizeof edit);
    }
  }
  return 0;
}
