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

/// [-] Before that, what is left cannot be told from what was done.
constexpr double least_fraction = 0.02;

}  // namespace

std::string remaining_text(double elapsed, double fraction) {
  if (fraction < least_fraction || fraction >= 1.0) return "";
  const double seconds = elapsed * (1.0 - fraction) / fraction;
  if (seconds < 100.0) return fmt::format(", about {:.0f} s left", seconds);
  if (seconds < 100.0 * 60.0) return fmt::format(", about {:.0f} min left", seconds / 60.0);
  return fmt::format(", about {:.0f} h left", seconds / 3600.0);
}

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)), enabled_(!quiet && isatty(STDERR_FILENO)), start_(Clock::now()), last_(start_) {}

Progress::~Progress() {
  if (drawn_) std::fputs(("\r\033[K" + notes_).c_str(), stderr);
}

void Progress::note(const std::string& line) {
  if (enabled_) notes_ += line + "\n";
}

void Progress::update(double fraction) {
  if (!enabled_) return;
  const auto now = Clock::now();
  if (now - start_ < patience || now - last_ < interval) return;
  last_ = now;
  if (!notes_.empty()) std::fputs(("\r\033[K" + notes_).c_str(), stderr);
  notes_.clear();
  drawn_ = true;
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
  const std::string bar = std::string(filled, '#') + std::string(width - filled, '.');
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  std::fputs(fmt::format("\r{} [{}] {:3.0f} %{}\033[K", label_, bar, 100.0 * fraction, remaining_text(elapsed, fraction)).c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace openclose
