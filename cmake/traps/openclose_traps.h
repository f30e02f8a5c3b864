// What is exempt from the traps of a build with OPENCLOSE_TRAPS (traps.cpp); for sources, not for headers that are installed.
#pragma once

#include <cfenv>

namespace openclose {

/// While one exists, operations without a result give NaN or infinity to this thread: for what is judged as a whole afterwards, such as a
/// factorisation. Nothing in a build without traps.
class NonStop {
 public:
  NonStop(const NonStop&) = delete;
  NonStop& operator=(const NonStop&) = delete;
#ifdef OPENCLOSE_TRAPS
  NonStop() {
    std::feholdexcept(&before_);
  }
  ~NonStop() {
    std::fesetenv(&before_);
  }

 private:
  std::fenv_t before_;
#else
  NonStop() {}
#endif
};

}  // namespace openclose
