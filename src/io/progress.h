// A progress bar on a terminal, for work longer than a second; silent where standard error is a file or a pipe.
#pragma once

#include <chrono>
#include <string>

namespace openclose {

/// ", about 12 s left", if the rest takes as long as what was done; empty where that cannot be told yet.
/// \param elapsed   [s]
/// \param fraction  of the work that is done, 0 to 1
std::string remaining_text(double elapsed, double fraction);

class Progress {
 public:
  Progress(std::string label, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// \param fraction  of the work that is done, 0 to 1
  void update(double fraction);
  /// A line that stays above the bar, once there is one.
  void note(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  bool enabled_;
  bool drawn_ = false;
  std::string notes_;  ///< not shown yet
  Clock::time_point start_;
  Clock::time_point last_;
};

}  // namespace openclose
