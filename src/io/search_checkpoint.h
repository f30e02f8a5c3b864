// When the state of a search is written: often enough to lose little by a kill, seldom enough to cost little.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace openclose {

/// [-] Of the time of a search that its checkpoints may take: what a kill loses is then twenty times what a checkpoint costs.
inline constexpr double share_of_checkpoints = 0.05;

class SearchCheckpoint {
 public:
  /// \param write  puts a state into its file
  /// \param clock  [s] of work
  SearchCheckpoint(std::function<void(std::string state)> write, std::function<double()> clock)
      : write_(std::move(write)), clock_(std::move(clock)) {}

  /// The first state is written at once, a later one where enough time has gone by since the last.
  void keep(std::string state) {
    latest_ = std::move(state);
    if (clock_() >= next_write_) flush();
  }
  /// Writes what has not been written yet.
  void flush() {
    if (!latest_) return;
    const double begin = clock_();
    write_(std::move(*latest_));
    latest_.reset();
    const double end = clock_();
    next_write_ = end + (end - begin) / share_of_checkpoints;
  }

 private:
  std::function<void(std::string)> write_;
  std::function<double()> clock_;
  std::optional<std::string> latest_;
  double next_write_ = 0.0;
};

}  // namespace openclose
