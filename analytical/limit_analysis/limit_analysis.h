// Factor of safety of rigid blocks by limit analysis (Livesley, Int. J. Numer. Meth. Engng 12, 1978; problem.h has the strength and the meaning of
// the certificates): the largest F for which forces in equilibrium within the strength over F exist. Sliding opens contacts at the friction angle
// (associated flow), so the factor is an upper bound of every one that a path with other dilatancy reaches.
//
// With Varied::live_loads the factor is the one that loads are multiplied by: the largest multiplier at which such forces exist.
//
//   LimitAnalysis analysis(problem);
//   analysis.at(1.3)            one linear program, warm from the last: forces or mechanism, each verified without the program
//   analysis.largest_factor()   bracket of the largest feasible factor, a handful of programs
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "openclose/limit_analysis/problem.h"

namespace openclose::limit_analysis {

struct Options {
  double width = 1e-5;                      // [-] of the bracket: failed - factor, over the smaller of 1 and the factor; see Bracket
  double first = 1.0;                       // [-] factor tried first: near the answer if it is known roughly
  double ratio = 2;                         // [-] of the factors tried next while all are feasible; later its squares
  double upper_limit = 1000;                // [-] feasible there: stands at every factor
  std::function<void()> interruption = {};  // called before and in each program; may throw
  double lower_limit = 1e-3;  // [-] infeasible there: no equilibrium at any factor. Multipliers of loads go down to 0, with the bracket of this one
};

enum class Verdict {
  feasible,    // forces hold
  infeasible,  // mechanism holds
  undecided,   // the program was not solved, or its answer does not hold: reason
};

/// [-] Over the factor: nearer to each other the forces of one factor and the mechanism of the other may both hold with their tolerances.
inline constexpr double narrowest_bracket = 10 * force_tolerance;

struct Trial {
  Verdict verdict = Verdict::undecided;
  double factor = 0;
  Forces forces;        // if feasible
  Mechanism mechanism;  // if infeasible; the fastest block has a speed of 1 m/s
  std::string reason;   // if undecided
};

/// As narrow as was asked for, but no narrower than `narrowest_bracket`. Over a multiplier of loads the width is always relative.
struct Bracket {
  enum class Verdict {
    found,
    stands_at_every_factor,
    no_equilibrium,  // at any factor
    undecided,       // wider than asked for, or without one of its ends
  };
  Verdict verdict = Verdict::undecided;
  std::string reason;   // in words, unless found
  double factor = 0;    // largest feasible F; 0: none known, or, of a multiplier of loads, 0 itself
  double failed = 0;    // smallest infeasible F; 0: none known, or, of a multiplier without equilibrium, 0 itself
  Forces forces;        // at `factor`
  Mechanism mechanism;  // at `failed`
  int programs = 0;     // linear programs solved

  bool found() const { return verdict == Verdict::found; }
};

class LimitAnalysis {
 public:
  /// \throws std::invalid_argument, see check()
  explicit LimitAnalysis(Problem problem);
  ~LimitAnalysis();
  LimitAnalysis(LimitAnalysis&&) noexcept;
  LimitAnalysis& operator=(LimitAnalysis&&) noexcept;

  const Problem& problem() const;

  /// Solves one program. Does not throw: what is not solved is undecided.
  Trial at(double factor);

  /// Other contacts between the same blocks; the programs stay warm if contact for contact only the strength differs.
  void replace_contacts(std::vector<Contact> contacts);

  Bracket largest_factor(const Options& options = {});

  int programs() const;  // solved so far

 private:
  class Program;
  class Search;
  std::unique_ptr<Program> program_;
};

/// The same as LimitAnalysis(problem).largest_factor(options).
Bracket limit_analysis(const Problem& problem, const Options& options = {});

}  // namespace openclose::limit_analysis
