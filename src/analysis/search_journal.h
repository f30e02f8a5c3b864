// What a search for the factor of safety has found out, piece of work after piece, so that one that was broken off goes on without doing any of it
// again: it runs through the same decisions, and pieces that are in the journal give their results at once.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "openclose/analysis/strength_search.h"

namespace openclose {

class SearchJournal {
 public:
  /// \param done  told after every piece that was not there before
  explicit SearchJournal(std::function<void()> done) : done_(std::move(done)) {}

  /// The result of the next piece of work.
  template <class Work>
  auto once(const Work& work) {
    using Result = decltype(work());
    if (next_ < entries_.size()) {
      Archive entry(entries_[next_++]);
      Result result;
      entry(result);
      return result;
    }
    Result result = work();
    Archive entry;
    entry(result);
    entries_.push_back(entry.take());
    next_ = entries_.size();
    if (done_) done_();
    return result;
  }

  void exchange(Archive& archive) { archive(entries_); }

 private:
  std::function<void()> done_;
  std::vector<std::string> entries_;
  std::size_t next_ = 0;
};

/// Trials that are in the journal are not made again.
class JournalledTrials : public StrengthTrials {
 public:
  JournalledTrials(StrengthTrials& trials, SearchJournal& journal) : trials_(trials), journal_(journal) {}

  TrialResult first(double srf) override {
    return journal_.once([&] { return trials_.first(srf); });
  }
  TrialResult next(double srf, OnBreak on_break) override {
    return journal_.once([&] { return trials_.next(srf, on_break); });
  }
  double smallest_multiplier() const override { return trials_.smallest_multiplier(); }
  std::optional<double> proved_failure(double near) override { return trials_.proved_failure(near); }

 private:
  StrengthTrials& trials_;
  SearchJournal& journal_;
};

}  // namespace openclose
