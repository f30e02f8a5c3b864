// What a reader is attacked with. A harness returns for good input and for input that is refused with a DamagedState or an InputError, and ends the
// program for everything else that may happen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Ends the program where a reader breaks its promise.
inline void require_promise(bool kept, const char* promise) {
  if (kept) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}
