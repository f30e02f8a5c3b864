// One answer for every combination of values of some keys, in one table.
#pragma once

#include <string>
#include <vector>

#include "openclose/io/text_files.h"
#include "openclose/study/cases.h"
#include "openclose/study/variation.h"

namespace openclose {

struct SweepOrder {
  CaseOrder cases;
  std::vector<std::string> overrides;  ///< of all cases
  std::vector<Variation> variations;
  std::string quantity;  ///< of a run; empty: usual_quantity()
};

struct Sweep {
  std::vector<TextFile> files;       ///< sweep.csv and, where a key has numbers, sweep.svg
  std::size_t cases = 0, found = 0;  ///< with an answer
  std::size_t intervals = 0;         ///< of these, whose two ends are not as near as they were asked to be
  std::size_t were_there = 0;        ///< from an earlier time
  std::vector<std::string> warnings;
};

/// Runs what has not been run yet and writes sweep.csv after each case, so that what is broken off is not lost. Throws InputError before anything is
/// written.
Sweep make_sweep(SweepOrder order, const std::function<void(double fraction)>& progress);

}  // namespace openclose
