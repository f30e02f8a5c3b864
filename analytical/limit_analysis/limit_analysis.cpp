#include "openclose/limit_analysis/limit_analysis.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "openclose/limit_analysis/program.h"

namespace openclose::limit_analysis {
namespace {

constexpr int equal_ratios = 2;          // after so many each ratio is the square of the one before
constexpr int most_undecided = 3;        // programs in a row
constexpr double almost = 0.75;          // [-] of the width: between a guess that is as good as the root and the factor on its other side
constexpr double share_upwards = 0.125;  // [-] of the bracket: from a feasible guess towards the infeasible factor it came from; doubles up to a half
constexpr int most_programs = 300;       // far beyond bisection of any bracket in double precision

}  // namespace

/// Newton's iteration on the least artificial force as a function of 1/F, or of the multiplier of loads, kept inside the bracket.
class LimitAnalysis::Search {
 public:
  Search(Program& program, const Options& options)
      : program_(program), options_(options), before_(program.solved()), factor_(options.first), ratio_(options.ratio) {}

  Bracket run() {
    while (!finished()) {
      try_factor();
      factor_ = next();
    }
    bracket_.programs = program_.solved() - before_;
    return bracket_;
  }

 private:
  bool finished() {
    Bracket& b = bracket_;
    const auto ends = [&](Bracket::Verdict verdict, const std::string& reason) {
      b.verdict = verdict;
      b.reason = reason;
      return true;
    };
    if (feasible_ && infeasible_ && b.failed - b.factor <= width(b.factor)) return ends(Bracket::Verdict::found, "");
    if (b.factor >= options_.upper_limit) return ends(Bracket::Verdict::stands_at_every_factor, "stands at every factor");
    if (infeasible_ && b.failed <= lowest())
      return ends(Bracket::Verdict::no_equilibrium, varies_loads() ? "no equilibrium without live loads" : "no equilibrium at any factor");
    if (program_.solved() - before_ >= most_programs) return ends(Bracket::Verdict::undecided, "too many linear programs");
    if (undecided_ == most_undecided) return ends(Bracket::Verdict::undecided, reason_);
    return false;
  }

  void try_factor() {
    if (options_.interruption) options_.interruption();
    Trial trial = program_.at(factor_);
    undecided_ = trial.verdict == Verdict::undecided ? undecided_ + 1 : 0;
    feasible_in_a_row_ = trial.verdict == Verdict::feasible ? feasible_in_a_row_ + 1 : 0;
    if (trial.verdict == Verdict::feasible) {
      bracket_.factor = factor_;
      feasible_ = true;
      bracket_.forces = std::move(trial.forces);
    } else if (trial.verdict == Verdict::infeasible) {
      bracket_.failed = factor_;
      infeasible_ = true;
      bracket_.mechanism = std::move(trial.mechanism);
      guess_ = program_.root();
      fresh_ = true;
    } else {
      reason_ = trial.reason;
    }
  }

  double next() {
    const double low = bracket_.factor, high = bracket_.failed;
    if (undecided_ > 0) return aside();
    if (!infeasible_) {
      const double next = std::min(factor_ > 0 ? factor_ * ratio_ : options_.first, options_.upper_limit);
      if (++raised_ >= equal_ratios) ratio_ *= ratio_;
      return next;
    }
    if (fresh_) {
      fresh_ = false;
      return below(low, high);
    }
    // The guess was feasible: the root is a little above it.
    const double share = std::min(0.5, share_upwards * std::exp2(feasible_in_a_row_ - 1));
    return low + share * (high - low);
  }

  /// After an infeasible factor.
  double below(double low, double high) {
    const double near = almost * width(std::max(low, guess_)), step = high - guess_, last_step = std::exchange(last_step_, step);
    // Where the guess is as good as the root, its other side is wanted.
    if (feasible_ && guess_ < low + near / 2) return high - low > 2 * near ? low + near : (low + high) / 2;
    const double guess = step < near / 2 ? high - near : guess_;
    if (!feasible_) return std::max(guess, lowest());
    return last_step == 0 || step < last_step / 2 ? guess : (low + high) / 2;
  }

  /// Beside a factor whose program said nothing.
  double aside() const {
    const double low = bracket_.factor, high = infeasible_ ? bracket_.failed : factor_ * options_.ratio;
    return low + (high - low) * (undecided_ + 1) / (most_undecided + 1);
  }

  bool varies_loads() const { return program_.problem().varied == Varied::live_loads; }
  double lowest() const { return varies_loads() ? 0 : options_.lower_limit; }
  double width(double factor) const {
    const double size = std::max(factor, options_.lower_limit);
    return std::max(options_.width * (varies_loads() ? size : std::min(1.0, size)), narrowest_bracket * size);
  }

  Program& program_;
  const Options& options_;
  const int before_;  // programs
  Bracket bracket_;
  bool feasible_ = false, infeasible_ = false;  // a factor that is known
  double factor_, ratio_;
  int raised_ = 0;
  double guess_ = 0;      // of the root, from the smallest infeasible factor
  bool fresh_ = false;    // not tried yet
  double last_step_ = 0;  // from the infeasible factor to the guess
  int undecided_ = 0, feasible_in_a_row_ = 0;
  std::string reason_;
};

LimitAnalysis::LimitAnalysis(Problem problem) : program_(std::make_unique<Program>(std::move(problem))) {}
LimitAnalysis::~LimitAnalysis() = default;
LimitAnalysis::LimitAnalysis(LimitAnalysis&&) noexcept = default;
LimitAnalysis& LimitAnalysis::operator=(LimitAnalysis&&) noexcept = default;

const Problem& LimitAnalysis::problem() const {
  return program_->problem();
}

Trial LimitAnalysis::at(double factor) {
  return program_->at(factor);
}

void LimitAnalysis::replace_contacts(std::vector<Contact> contacts) {
  program_->replace_contacts(std::move(contacts));
}

Bracket LimitAnalysis::largest_factor(const Options& options) {
  program_->set_interruption(options.interruption);
  // What it refers to may be gone after this search.
  struct Silence {
    Program& program;
    ~Silence() { program.set_interruption({}); }
  } const silence{*program_};
  return Search(*program_, options).run();
}

int LimitAnalysis::programs() const {
  return program_->solved();
}

Bracket limit_analysis(const Problem& problem, const Options& options) {
  return LimitAnalysis(problem).largest_factor(options);
}

}  // namespace openclose::limit_analysis
