#include "openclose/io/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace openclose {
namespace {

constexpr std::chrono::milliseconds patience{1000};  ///< shorter work shows no bar
constexpr std::chrono::milliseconds interval{100};   ///< between two drawings
constexpr int width = 40;                            ///< characters

}  // namespace

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)), enabled_(!quiet && isatty(STDERR_FILENO)), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::update(double fraction) {
  if (!enabled_) return;
  const auto now = Clock::now();
  if (now - start_ < patience || now - last_ < interval) return;
  last_ = now;
  drawn_ = true;
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
  const std::string bar = std::string(filled, '#') + std::string(width - filled, '.');
  fmt::print(stderr, "\r{} [{}] {:3.0f} %", label_, bar, 100.0 * fraction);
  std::fflush(stderr);
}

}  // namespace openclose
